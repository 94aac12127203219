"""The likelihood set is valid for every asker and every stopping rule: exact on finite games."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

from proofs_checks.answers.checks.games import GAME, Counts, Game, answered, states, tables, worst_chance
from proofs_checks.context import Context
from proofs_checks.exact.every import QUICK
from proofs_checks.outcome import Outcome, Tally

DELTA = Fraction(1, 10)


def _chances(game: Game, truth: int) -> tuple[Fraction, ...]:
    return tuple(game.chance(truth, x) for x in range(len(game.questions)))


def martingale(*, chosen_after: bool = False, context: Context = QUICK) -> Outcome:
    """The evidence over the true likelihood keeps its mean at every counts, for every question and every truth."""
    game, tally = GAME, Tally()
    evidence = game.best if chosen_after else game.mixture
    for counts in states(game, context.pick(quick=5, full=7)):
        for truth in range(len(game.weights)):
            now = evidence(counts) / game.likelihood(truth, counts)
            for x, p in enumerate(_chances(game, truth)):
                after = [answered(counts, x, answer) for answer in (1, 0)]
                mean = sum(
                    chance * evidence(c) / game.likelihood(truth, c)
                    for chance, c in zip((p, 1 - p), after, strict=True)
                )
                tally.expect(mean == now, f"from {now} the mean becomes {mean} after {counts}, question {x}")
    return tally.outcome("every one-step mean equals the value before")


def ever_outside(*, chosen_after: bool = False, context: Context = QUICK) -> Outcome:
    """The true weights ever leave the set with probability at most delta, for the worst asker and any stopping."""
    game, tally = GAME, Tally()
    evidence = cache(game.best if chosen_after else game.mixture)
    worst = Fraction(0)
    for truth in range(len(game.weights)):

        def outside(counts: Counts, truth: int = truth) -> bool:
            return game.likelihood(truth, counts) < DELTA * evidence(counts)

        found = worst_chance(_chances(game, truth), context.pick(quick=8, full=14), outside)
        worst = max(worst, found)
        tally.expect(found <= DELTA, f"weights {truth} leave with probability {float(found):.4f} > {DELTA}")
    return tally.outcome(f"the worst asker attains {float(worst / DELTA):.2f} of delta")


def bold_forecasts(*, mass: Fraction = Fraction(1)) -> Outcome:
    """Forecasts of total mass 1 fail at most with delta, and bold ones attain it: a coin, delta = 1/4, four tosses."""
    grid = [Fraction(i, 4) * mass for i in range(5)]
    delta, coin = Fraction(1, 4), Fraction(1, 2)

    @cache
    def value(ratio: Fraction, left: int) -> Fraction:
        if ratio >= 1 / delta:
            return Fraction(1)
        if left == 0:
            return Fraction(0)
        return max(
            coin * value(ratio * q / coin, left - 1) + (1 - coin) * value(ratio * (mass - q) / (1 - coin), left - 1)
            for q in grid
        )

    worst, tally = value(Fraction(1), 4), Tally()
    tally.expect(worst <= delta, f"some forecasts fail with probability {worst} > {delta}")
    tally.expect(worst >= delta, f"the boldest forecasts fail with probability {worst} only")
    return tally.outcome(f"the worst of all forecasts on a grid fails with probability {worst} = delta")


def false_certificates(*, chosen_after: bool = False, context: Context = QUICK) -> Outcome:
    """Any asker, any stopping, any recommendation: a gap certified too small happens with probability at most delta.

    Gaps are at most log 2; utilities are logarithms of rationals, so that gaps are compared exactly.
    """
    game, tally, limit = GAME, Tally(), Fraction(2)
    evidence = cache(game.best if chosen_after else game.mixture)
    worst = Fraction(0)
    for truth in range(len(game.weights)):
        losses = _ratios(game)

        def wrong(counts: Counts, truth: int = truth, losses: list[list[Fraction]] = losses) -> bool:
            inside = [k for k in range(len(game.weights)) if game.likelihood(k, counts) >= DELTA * evidence(counts)]
            if not inside:  # the answers contradict the model: no certificate
                return False
            return any(max(losses[k][i] for k in inside) <= limit < losses[truth][i] for i in range(len(game.policies)))

        found = worst_chance(_chances(game, truth), context.pick(quick=7, full=11), wrong)
        worst = max(worst, found)
        tally.expect(found <= DELTA, f"under weights {truth} a false certificate has probability {float(found):.4f}")
    return tally.outcome(f"the worst asker gets {float(worst / DELTA):.2f} of delta")


def _ratios(game: Game) -> list[list[Fraction]]:
    """For all weights and policies the exponential of the gap to the best policy."""
    values = [[game.odds(k, policy) for policy in game.policies] for k in range(len(game.weights))]
    return [[max(row) / value for value in row] for row in values]


def refutations(*, against: int | None = None, context: Context = QUICK) -> Outcome:
    """The mixture of tables and evidence over the best weights refutes a true model with probability at most delta."""
    game, tally, worst = GAME, Tally(), Fraction(0)

    @cache
    def refuted(counts: Counts) -> bool:
        inside = game.best(counts) if against is None else game.likelihood(against, counts)
        return (tables(counts) + game.mixture(counts)) / 2 * DELTA >= inside

    for truth in range(len(game.weights)):
        found = worst_chance(_chances(game, truth), context.pick(quick=8, full=12), refuted)
        worst = max(worst, found)
        tally.expect(found <= DELTA, f"weights {truth} are refuted with probability {float(found):.4f}")
    return tally.outcome(f"the worst asker gets {float(worst / DELTA):.2f} of delta")


def gibbs(*, sign: int = 1) -> Outcome:
    """x log x - x + 1 >= 0: its value and slope vanish at 1 and its second derivative is 1/x; so KL(q || p) >= 0."""
    import sympy

    from proofs_checks.outcome import together
    from proofs_checks.smt import prove, reals
    from proofs_checks.symbolic import identity

    x = sympy.Symbol("x", positive=True)
    f = sign * (x * sympy.log(x) - x + 1)
    (y,) = reals("y")
    return together(
        identity("value at 1", f.subs(x, 1), sympy.Integer(0)),
        identity("slope at 1", sympy.diff(f, x).subs(x, 1), sympy.Integer(0)),
        identity("second derivative", sympy.diff(f, x, 2), 1 / x),
        prove("1/x is positive", [y > 0], 1 / y > 0),
    )
