"""Counterexamples of the ledger as refutations for Coq's kernel, generated from the JSON that the evaluators replay.

``Claims.v`` states what the paper claims over all models; each generated source proves the negation of one claim by
one stored instance. What evaluates to roots of rationals that are not rational is compared by the tactic ``interval``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache

from proofs_checks.counterexample import Counterexample, load
from proofs_checks.evaluators.offline_models import ESTIMATED, EXPERT, OTHER, TRUE, concentrability, law
from proofs_checks.exact.laws import occupancies
from proofs_checks.kernel.tables import PREAMBLE, finite, model, number, row_table

_MODELS = {TRUE: "truth", ESTIMATED: "estimate", EXPERT: "expert", OTHER: "other"}
_KERNELS = "(fun s a => table_law (truth s a)) (fun s a => table_law (estimate s a))"
_SPECIALISE = f"  specialize (claim states actions (table_law start) {_KERNELS}"
_INTERVAL = "From Interval Require Import Tactic."
_EXACT = "  rewrite ?Rinv_1, ?Rmult_1_r, ?sqrt_1 in claim. lra."
_NUMERICAL = "  revert claim. apply Rlt_not_le. interval with (i_prec 160)."


def generated(*, numerical: bool) -> dict[str, str]:
    """The sources of the refutations by file name without ``.v``; numerical ones need the tactic ``interval``."""
    return {file: text for file, text in _all().items() if numerical or _INTERVAL not in text}


def example_of(file: str) -> str:
    """The name of the counterexample that a generated source refutes by."""
    return file.removeprefix("Refuted_").replace("_", "-")


@cache
def _all() -> dict[str, str]:
    return {f"Refuted_{name.replace('-', '_')}": source(load(name)) for name in _SCRIPTS}


def source(example: Counterexample) -> str:
    """The source that refutes a claim by one instance; Coq accepts it if the instance violates the claim."""
    claim, definitions, script = _SCRIPTS[example.name](example)
    is_numerical = any("interval" in line for line in script)
    head = [f"(* Generated from counterexamples/{example.name}.json: {example.label} {example.part} *)"]
    return "\n".join(
        [
            *head,
            *([_INTERVAL] if is_numerical else []),
            *definitions,
            "",
            f"Theorem refuted : ~ {claim}.",
            "Proof.",
            "  intro claim.",
            *script,
            "Qed.",
            "",
        ]
    )


Script = tuple[str, list[str], list[str]]


def _closing(example: Counterexample) -> list[str]:
    exact = isinstance(example.left.value, Fraction) and isinstance(example.right.value, Fraction)
    return ["  write_out claim.", _EXACT if exact else _NUMERICAL]


def _definitions(example: Counterexample) -> list[str]:
    data = example.data
    return model(data, {key: name for key, name in _MODELS.items() if key in {**data["kernels"], **data["policies"]}})


def _error(policy: str, horizon: object) -> str:
    return _rewrite(f"trajectory_error_is start truth estimate _ (certain {policy}) {horizon} (certain_is {policy})")


def _rewrite(equation: str) -> str:
    return f"  rewrite ({equation}) in claim."


def _rows(policy: str, lemma: str = "expected_sum_is", surds: str = "row_surds") -> str:
    return _rewrite(
        f"{lemma} start truth _ (certain {policy}) _ ({surds} truth estimate) _ (certain_is {policy}) "
        f"({surds}_is truth estimate)"
    )


def _step_1(example: Counterexample) -> Script:
    horizon = example.data["horizon"]
    script = [f"{_SPECIALISE} expert {horizon}%nat).", _error("expert", horizon), _rows("expert")]
    return "step_1", _definitions(example), [*script, *_closing(example)]


def _step_2(example: Counterexample) -> Script:
    step = int(example.data["step"]) - 1
    script = [
        f"{_SPECIALISE} expert other {example.data['horizon']}%nat {step}%nat _ ltac:(lia)",
        f"    {_ratio(example, 'certain', 'certain_is')}).",
        _rows("other", "expected_is"),
        _rows("expert", "expected_is"),
    ]
    return "step_2", _definitions(example), [*script, *_closing(example)]


def _step_3(example: Counterexample) -> Script:
    horizon = example.data["horizon"]
    script = [f"{_SPECIALISE} expert {horizon}%nat ltac:(lia)).", _rows("expert"), _error("expert", horizon)]
    return "step_3", _definitions(example), [*script, *_closing(example)]


def _product_formula(example: Counterexample) -> Script:
    horizon = int(example.data["horizon"])
    script = [f"{_SPECIALISE} expert {horizon}%nat).", _error("expert", horizon), "  cbn [seq product] in claim."]
    script += [_rows("expert", "expected_is", "overlap_surds")] * horizon
    return "product_formula", _definitions(example), [*script, *_closing(example)]


def _technical_lemma(example: Counterexample) -> Script:
    horizon = example.data["horizon"]
    script = [
        f"{_SPECIALISE} expert other {horizon}%nat _",
        f"    {_ratio(example, 'certain', 'certain_is')}).",
        _error("other", horizon),
        _error("expert", horizon),
    ]
    return "technical_lemma", _definitions(example), [*script, *_closing(example)]


def _full_support(example: Counterexample) -> Script:
    horizon = example.data["horizon"]
    policies = "(chosen expert) (chosen other)"
    support = f"full_support_is start truth _ _ {policies} {horizon} (chosen_is expert) (chosen_is other)"
    script = [
        f"{_SPECIALISE} (table_policy expert) (table_policy other) {horizon}%nat _",
        f"    ({support} ltac:(vm_compute; reflexivity))",
        f"    {_ratio(example, 'chosen', 'chosen_is')}).",
        *(
            _rewrite(f"trajectory_error_is start truth estimate _ (chosen {who}) {horizon} (chosen_is {who})")
            for who in ("other", "expert")
        ),
    ]
    return "technical_lemma_with_full_support", _definitions(example), [*script, *_closing(example)]


def _ratio(example: Counterexample, choice: str, equal: str) -> str:
    ratio, horizon = number(concentrability(example.data)), example.data["horizon"]
    return (
        f"(concentrability_is start truth _ _ ({choice} expert) ({choice} other) {horizon} {ratio}%Q ({equal} expert) "
        f"({equal} other)\n      ltac:(vm_compute; reflexivity))"
    )


def _root_two(example: Counterexample) -> Script:
    horizon = example.data["horizon"]
    choices = {name: f"(fun _ s => {name} s)" for name in ("expert", "other")}
    both = f"{_chosen(choices['expert'])} {_chosen(choices['other'])}"
    laws = f"{_stationary('expert')} {_stationary('other')}"
    equal = f"(chosen_is {choices['expert']}) (chosen_is {choices['other']})"
    script = [
        f"{_SPECIALISE} (fun s => table_law (expert s)) (fun s => table_law (other s)) {horizon}%nat).",
        _rewrite(f"policy_error_is start estimate {laws} {both} {horizon} {equal}"),
        _rewrite(f"policy_error_is start truth {laws} {both} {horizon} {equal}"),
        _rewrite(
            f"trajectory_error_is start truth estimate {_stationary('expert')} {_chosen(choices['expert'])} {horizon} "
            f"(chosen_is {choices['expert']})"
        ),
    ]
    return "root_two", _definitions(example), [*script, *_closing(example)]


def _stationary(name: str) -> str:
    return f"(stationary (fun s => table_law ({name} s)))"


def _chosen(choice: str) -> str:
    return f"(chosen {choice})"


def _feature_difference(example: Counterexample) -> Script:
    data = example.data
    names = {ESTIMATED: "estimate", "\\widehat\\pi": "clone", "\\pi_1": "first", "\\pi_2": "second"}
    horizon, bound = int(data["horizon"]), number(data["B"])
    rarest = min(
        p for d in occupancies(law(data, ESTIMATED, "\\widehat\\pi", arrival=False), horizon) for p in d.values()
    )
    values = [
        f"  | (s{s}, a{a}) :: _ => {number(value)}" for key, value in data["features"].items() for s, a in [key.split()]
    ]
    feature = [
        "Definition feature (h : list (state * action)) : Q :=",
        "  (match h with",
        *values,
        "  | _ => 0",
        "  end)%Q.",
    ]
    radius = (
        f"offline_radius (size states) (size actions) {horizon} {int(data['n'])} (Q2R {number(data['delta'])}) "
        f"(Q2R {number(rarest)})"
    )
    numbers = (
        "unfold offline_radius, alpha_offline, beta_offline; rewrite many; "
        "change (size states) with 2%nat; change (size actions) with 2%nat; cbn [INR]; unfold Q2R; cbn [Qnum Qden]"
    )
    script = [
        f"  assert (many : INR {int(data['n'])} = {int(data['n'])}) by (rewrite INR_IZR_INZ; f_equal).",
        f"  assert (small : {radius} < 1) by ({numbers}; interval with (i_prec 80)).",
        "  assert (near : forall h : states -> actions, h = first \\/ h = second -> hellinger (trajectories "
        f"{horizon})",
        "    (trajectory_law (markov (table_law start) (fun s a => table_law (estimate s a))) (deterministic clone))",
        "    (trajectory_law (markov (table_law start) (fun s a => table_law (estimate s a))) (deterministic h))",
        f"    <= {radius}).",
        "  { intros h which. unfold hellinger.",
        f"    rewrite (policy_distance_is start estimate _ _ (certain clone) (certain h) {horizon} (certain_is clone) "
        "(certain_is h)).",
        "    destruct which as [-> | ->]; match goal with |- context [value ?l] => let c := eval vm_compute in l in",
        "      assert (same : l = c) by (vm_compute; reflexivity); rewrite same end;",
        "      cbv [value sum fst snd];",
        f"      {numbers}; interval with (i_prec 80). }}",
        "  specialize (claim states actions (table_law start) (fun s a => table_law (estimate s a)) clone first second",
        f"    {horizon}%nat {int(data['n'])}%nat (Q2R {number(data['delta'])}) (Q2R {number(rarest)}) (Q2R {bound}) "
        "(fun h => Q2R (feature h))).",
        "  cbv zeta in claim.",
        "  assert (reached : (Q2R (mean_q (next start estimate) (certain first) "
        f"{horizon} feature) - Q2R (mean_q (next start estimate) (certain second) {horizon} feature)) ^ 2",
        f"    <= 32 * Q2R {bound} ^ 2 / INR {int(data['n'])}).",
        f"  {{ rewrite <- (mean_is _ _ _ _ (next_is start estimate) (certain_is first) {horizon} feature (fun h => Q2R "
        "(feature h))) by reflexivity.",
        f"    rewrite <- (mean_is _ _ _ _ (next_is start estimate) (certain_is second) {horizon} feature (fun h => Q2R "
        "(feature h))) by reflexivity.",
        "    apply claim.",
        "    - unfold Q2R; cbn [Qnum Qden]; lra.",
        "    - unfold Q2R; cbn [Qnum Qden]; lra.",
        f"    - apply (visited_is start estimate _ (certain clone) {horizon} {number(rarest)}%Q (certain_is clone)). "
        "vm_compute; reflexivity.",
        "    - intros [|[[] []] h]; unfold Q2R; cbn [feature Qnum Qden]; lra.",
        "    - exact small.",
        "    - apply near; auto.",
        "    - apply near; auto. }",
        "  revert reached. apply Rlt_not_le.",
        "  repeat match goal with |- context [mean_q ?e ?c ?h ?f] => let q := eval vm_compute in (mean_q e c h f) in",
        "    replace (mean_q e c h f) with q by (vm_compute; reflexivity) end.",
        "  rewrite many; unfold Q2R; cbn [Qnum Qden]; interval with (i_prec 80).",
    ]
    return "feature_difference", ["Require Import Bridge.Formulas.", *model(data, names), *feature], script


def _numbers(claim: str, names: str, premises: str, *closing: str) -> Callable[[Counterexample], Script]:
    """The script for a claim about numbers, at the instance's entries ``names``."""

    def script(example: Counterexample) -> Script:
        values = " ".join(_real(example.data[name]) for name in names.split())
        specialised = f"  specialize (claim {values} {premises})."
        return claim, [PREAMBLE], [specialised, *(f"  {line}" for line in closing)]

    return script


def _real(value: object) -> str:
    exact = Fraction(str(value))
    return f"({exact.numerator} / {exact.denominator})"


def _two_laws(example: Counterexample) -> Script:
    laws = example.data["laws"]
    size = len(laws["P"])
    definitions = [
        PREAMBLE,
        finite("state", "s", size),
        row_table("first", "s", laws["P"]),
        row_table("second", "s", laws["Q"]),
    ]
    script = [
        "  specialize (claim states (table_law first) (table_law second)).",
        "  rewrite (hellinger2_is (elements states) _ _ (entry first) (entry second)) in claim by reflexivity.",
        "  write_out claim.",
        "  cbv -[Rle Rplus Rmult Rminus Ropp Rinv Rdiv Rabs pow IZR sqrt] in claim.",
        "  revert claim. apply Rlt_not_le. interval with (i_prec 80).",
    ]
    return "tv_below_hellinger", definitions, script


def _grid(example: Counterexample) -> Script:
    epsilon = Fraction(example.data["epsilon"])
    points = int(example.left.value) - 1  # type: ignore[arg-type]
    script = [
        f"  specialize (claim {_real(epsilon)} ltac:(lra)).",
        f"  rewrite (ceiling_is _ {points}) in claim by (split; interval with (i_prec 80)).",
        "  lra.",
    ]
    return "grid_size", ["Require Import Bridge.Arithmetic.", PREAMBLE], script


def _whole_numbers(example: Counterexample) -> Script:
    data = example.data
    values = f"{data['S']}%nat {data['A']}%nat {_real(data['delta'])}"
    script = [
        f"  specialize (claim {values} ltac:(lia) ltac:(lia) ltac:(lra)).",
        "  cbn [INR pow] in claim. lra.",
    ]
    return "union_step", [PREAMBLE], script


def _utilities(example: Counterexample) -> Script:
    values = " ".join(_real(value) for key in ("true", "estimated") for value in example.data[key])
    return "decomposition", [PREAMBLE], [f"  specialize (claim {values}). lra."]


def _known_model(example: Counterexample) -> Script:
    data = example.data
    values = " ".join(_real(data[name]) for name in ("B", "W", "lambda", "delta"))
    n, rounds = int(data["n"]), int(data["T"])
    sizes = "change (size one) with 1%nat; change (size Sums.two) with 2%nat"
    lemma = (
        f"Lemma rounds : INR (Z.to_nat {rounds}) = {rounds}.\n"
        "Proof. rewrite INR_IZR_INZ, Z2Nat.id by lia. reflexivity. Qed."
    )
    script = [
        f"  revert claim. apply (two_policies {values} {n} (Z.to_nat {rounds})); try lra; try lia.",
        f"  - unfold offline_radius_known, policy_error_corollary; {sizes}; cbn [INR]. interval with (i_prec 80).",
        "  - intros t [low high]. unfold gamma_known, beta_t, alpha_dT, kappa, cosh. rewrite rounds.",
        "    apply le_INR in low, high. rewrite rounds in high. cbn [INR] in *.",
        "    generalize dependent (INR t). intros x.",
        "    intros. apply Rge_le, Rminus_ge, Rle_ge. interval with (i_prec 60, i_bisect x, i_depth 20).",
        "  - unfold regret_known_stated, feature_difference_sum, beta_t, alpha_dT, kappa, cosh. rewrite rounds.",
        f"    {sizes}; cbn [INR]. interval with (i_prec 80).",
    ]
    required = "Require Import Reals List Lra Lia Bool.\nRequire Import Bridge.Sums Bridge.Formulas Bridge.KnownModel."
    return "known_model_theorem", [required, "Open Scope R_scope.", lemma], script


_FAILS = "revert claim. apply Rlt_not_le."
_RANGES = "ltac:(lra) ltac:(lra) ltac:(lra)"

_SCRIPTS: Mapping[str, Callable[[Counterexample], Script]] = {
    "offline-step-1": _step_1,
    "offline-step-2": _step_2,
    "offline-step-3": _step_3,
    "offline-product-formula": _product_formula,
    "offline-support-gap": _technical_lemma,
    "offline-third-term": _technical_lemma,
    "offline-history-expert": _full_support,
    "offline-root-two": _root_two,
    "offline-feature-difference": _feature_difference,
    "online-linear-regret": _known_model,
    "offline-tv-below-hellinger": _two_laws,
    "offline-union-step": _whole_numbers,
    "offline-grid-size": _grid,
    "online-log-potential": _numbers(
        "log_potential", "D kappa_lambda", "ltac:(lra)", _FAILS, "interval with (i_prec 80)."
    ),
    "online-dimension": _numbers(
        "falls_with_dimension", "d_small d_large x", "ltac:(lra) ltac:(lra)", _FAILS, "interval with (i_prec 80)."
    ),
    "online-three-squares": _numbers(
        "three_squares",
        "now_1 now_2 before_1 before_2",
        "",
        "unfold Rmax, Rabs in claim.",
        "repeat match type of claim with context [Rcase_abs ?x] => destruct (Rcase_abs x) end;",
        "  destruct (Rle_dec _ _); lra.",
    ),
    "online-decomposition-sign": _utilities,
    "online-curvature-of-differences": _numbers(
        "curvature_of_differences",
        "phi_1 phi_2 w B W",
        _RANGES,
        _FAILS,
        "unfold sigmoid, Bridge.Formulas.kappa, cosh. interval with (i_prec 80).",
    ),
}


if __name__ == "__main__":
    sys.stdout.write(_all()[f"Refuted_{sys.argv[1].replace('-', '_')}"])
