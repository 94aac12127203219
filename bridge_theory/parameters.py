"""The one table of parameters: symbol, meaning, domain and unit, and the refusal of values outside the domain."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from numbers import Integral, Rational, Real
from typing import TypeAlias

import numpy as np

from bridge_theory.arithmetic.protocol import FloatArray
from bridge_theory.errors import InputError

Exact: TypeAlias = int | Fraction
Given: TypeAlias = "Exact | float | str | Decimal | Iterable[object]"
Stored: TypeAlias = "Exact | tuple[Exact, ...]"


@dataclass(frozen=True)
class Domain:
    """An interval of integers or reals; ``opens`` says which of the two ends are excluded.

    >>> Domain(0, 1, opens=(True, True)).describe("delta")
    '0 < delta < 1'
    """

    low: Exact
    high: Exact | None = None
    opens: tuple[bool, bool] = (False, False)
    integer: bool = False

    def contains(self, value: Exact | FloatArray) -> bool:
        """Whether every value lies in the interval (and is whole, where only integers are meant)."""
        values = np.asarray(value)
        inside = values > self.low if self.opens[0] else values >= self.low
        if self.high is not None:
            inside = inside & (values < self.high if self.opens[1] else values <= self.high)
        if self.integer and values.dtype.kind == "f":
            inside = inside & (values == np.floor(values))
        whole = not (self.integer and isinstance(value, Fraction))
        return bool(np.all(inside)) and whole

    def describe(self, name: str) -> str:
        """The domain in words of mathematics, for messages and tables."""
        low_sign, high_sign = ("<" if is_open else "<=" for is_open in self.opens)
        kind = "an integer, " if self.integer else ""
        if self.high is None:
            return f"{kind}{name} {'>' if self.opens[0] else '>='} {self.low}"
        return f"{kind}{self.low} {low_sign} {name} {high_sign} {self.high}"


POSITIVE_INTEGER = Domain(1, integer=True)
COUNT = Domain(0, integer=True)
POSITIVE = Domain(0, opens=(True, False))
NONNEGATIVE = Domain(0)
PROBABILITY_OPEN = Domain(0, 1, opens=(True, True))
PROBABILITY_POSITIVE = Domain(0, 1, opens=(True, False))
UNIT_INTERVAL = Domain(0, 1)
AT_LEAST_ONE = Domain(1)
AT_LEAST_TWO = Domain(2, integer=True)
NATS = Domain(-(10**12), 10**12)
"""Utilities, log-odds and differences of log-likelihoods: any sign, and any size that is meant."""


@dataclass(frozen=True)
class Parameter:
    """One row of the table: Python name, LaTeX, meaning, domain, unit; ``array`` for one entry per cell."""

    name: str
    latex: str
    meaning: str
    domain: Domain
    unit: str = "none"
    array: bool = False

    def exact(self, value: Given) -> Stored:
        """The value as an exact number (floats are the binary number they are, strings the decimal they show)."""
        if not self.array:
            return self._checked(to_exact(self.name, value))
        if isinstance(value, str) or not isinstance(value, Iterable):
            raise InputError(f"{self.name} = {value!r} is one number; pass an array with one entry per cell")
        entries = tuple(
            self._checked(to_exact(self.name, entry)) for entry in np.ravel(np.asarray(list(value), object))
        )
        if not entries:
            raise InputError(f"{self.name} is empty; pass an array with one entry per cell")
        return entries

    def floats(self, value: object) -> FloatArray:
        """The value as float64, a scalar or an array to broadcast; every entry inside the domain."""
        if isinstance(value, str):
            value = to_exact(self.name, value)
        try:
            array = np.asarray(_nearest_float(value) if isinstance(value, Fraction | Decimal) else value, np.float64)
        except OverflowError:
            raise InputError(
                f"{self.name} is beyond float64, which holds sizes from 5e-324 to 1.8e308; ask for the enclosure"
            ) from None
        except (TypeError, ValueError):
            raise InputError(f"{self.name} = {value!r} is not numeric; expected {self._expected()}") from None
        if not (np.all(np.isfinite(array)) and self.domain.contains(array)):
            shown = value if array.ndim == 0 else "an array with entries outside the domain"
            raise InputError(f"{self.name} = {shown} is outside its domain; expected {self._expected()}")
        return np.ravel(array) if self.array else array[()]

    def _checked(self, value: Exact) -> Exact:
        if not self.domain.contains(value):
            raise InputError(f"{self.name} = {show(value)} is outside its domain; expected {self._expected()}")
        return value

    def _expected(self) -> str:
        return f"{self.domain.describe(self.name)} ({self.meaning})"


def _nearest_float(value: Fraction | Decimal) -> float:
    nearest = float(value)
    if nearest == 0 != value:
        raise OverflowError
    return nearest


_LARGEST_EXPONENT = 4000  # an exact number has as many digits, and "1e999999999" would fill the memory


def to_exact(name: str, value: object) -> Exact:
    """An exact number from what a user wrote; a float is the binary number it is, a string the decimal it shows.

    >>> to_exact("delta", "0.05"), to_exact("n", 3.0)
    (Fraction(1, 20), 3)
    """
    if isinstance(value, str | Decimal):
        exponent = re.search(r"e([-+]?\d+)", str(value).lower())
        if exponent is not None and not -_LARGEST_EXPONENT <= float(exponent[1]) <= _LARGEST_EXPONENT:
            reach = f"powers of ten from -{_LARGEST_EXPONENT} to {_LARGEST_EXPONENT}"
            raise InputError(f"{name} = {value} is out of reach; exact numbers have {reach}")
    try:
        if isinstance(value, bool | np.bool_):
            raise TypeError
        if isinstance(value, Integral):
            return int(value)
        if isinstance(value, str | Decimal | Rational | Real):
            fraction = Fraction(value) if isinstance(value, str | Decimal | Rational) else Fraction(float(value))
            return fraction.numerator if fraction.denominator == 1 else fraction
        raise TypeError
    except (TypeError, ValueError, OverflowError, ZeroDivisionError):
        raise InputError(f"{name} = {value!r} is not a finite number; write an integer, 0.05, '0.05' or 1/20") from None


_LONGEST = 10**40  # from here on the digits of a number say less than its size


def show(value: Stored) -> str:
    """A stored value for people: integers and short decimals as such, other rationals as fractions, arrays by size.

    >>> show(Fraction(1, 20)), show(Fraction(1, 3)), show((1, 2)), show(10**400), show(Fraction(2, 3 * 10**400))
    ('0.05', '1/3', '2 entries', '1e+400', 'about 6.66667e-401')
    """
    if isinstance(value, tuple):
        return f"{len(value)} entries"
    if not -_LONGEST < value < _LONGEST or float(value) == 0 != value:
        context = Context(prec=6)
        digits = context.divide(Decimal(value.numerator), Decimal(value.denominator))
        decimal = f"{context.normalize(digits):g}"
        return decimal if Fraction(decimal) == value else f"about {decimal}"
    if isinstance(value, int):
        return str(value)
    decimal = f"{float(value):.6g}"
    return decimal if Fraction(decimal) == value else _short_fraction(value)


def _short_fraction(value: Fraction) -> str:
    return str(value) if value.denominator < 10**6 else repr(float(value))


_ROWS = (
    # the problem
    Parameter("S", r"|\mathcal{S}|", "number of states", POSITIVE_INTEGER, "states"),
    Parameter("A", r"|\mathcal{A}|", "number of actions", POSITIVE_INTEGER, "actions"),
    Parameter("H", "H", "horizon: state-action pairs in a trajectory", POSITIVE_INTEGER, "steps"),
    Parameter("d", "d", "dimension of the trajectory features", POSITIVE_INTEGER, "features"),
    Parameter("B", "B", "bound on the norm of a trajectory's features", POSITIVE, "feature norm"),
    Parameter("W", "W", "bound on the norm of the preference weights", POSITIVE, "1 / feature norm"),
    # the data
    Parameter("n", "n", "offline demonstrations", POSITIVE_INTEGER, "trajectories"),
    Parameter("T", "T", "online preference queries", POSITIVE_INTEGER, "rounds"),
    Parameter("t", "t", "current online round", POSITIVE_INTEGER, "rounds"),
    Parameter("gamma_min", r"\gamma_{\min}", "smallest positive expert visitation probability", PROBABILITY_POSITIVE),
    Parameter(
        "rows",
        r"\rho_{\mathrm{rows}}",
        "state-action pairs whose rows are estimated: all S A, or those that the expert can use",
        POSITIVE_INTEGER,
        "rows",
    ),
    Parameter("unvisited", "k", "states whose action was never recorded", COUNT, "states"),
    Parameter("counts", "N", "transition uses of each state-action cell", COUNT, "transitions", array=True),
    Parameter("visits", "N", "recorded actions in each (step, state) cell", COUNT, "actions", array=True),
    Parameter(
        "occupancy_hat",
        r"\hat d^{\pi}",
        "probability of each (step, state, action) cell, estimate",
        UNIT_INTERVAL,
        array=True,
    ),
    Parameter("row_errors", "h", "squared Hellinger error of each cell's transition row", UNIT_INTERVAL, array=True),
    Parameter("singletons", "g", "demonstrations whose set of visited states no other one has", COUNT, "trajectories"),
    # probabilities of failure
    Parameter("delta", r"\delta", "failure probability", PROBABILITY_OPEN),
    Parameter("delta1", r"\delta_1", "failure probability of the policy estimate", PROBABILITY_OPEN),
    Parameter("delta2", r"\delta_2", "failure probability of the transition estimate", PROBABILITY_OPEN),
    Parameter("delta_off", r"\delta_{\mathrm{off}}", "failure probability of the offline set", PROBABILITY_OPEN),
    Parameter("delta_w", r"\delta_w", "failure probability of the preference confidence set", PROBABILITY_OPEN),
    Parameter("delta_P", r"\delta_P", "failure probability of the transition bonus", PROBABILITY_OPEN),
    Parameter("delta_F", r"\delta_F", "failure probability of the potential's supermartingale", PROBABILITY_OPEN),
    Parameter("delta_M", r"\delta_M", "failure probability of the bonus sum's supermartingale", PROBABILITY_OPEN),
    # intermediate quantities that a formula may take as given
    Parameter("R", "R", "bound on a squared Hellinger distance", UNIT_INTERVAL),
    Parameter("R1", "R_1", "bound on the policy estimate's squared Hellinger error", NONNEGATIVE),
    Parameter("R2", "R_2", "bound on the transition estimate's squared Hellinger error", NONNEGATIVE),
    Parameter("radius", "r", "Hellinger radius of the offline confidence set", NONNEGATIVE),
    Parameter(
        "mass", r"\rho^2", "estimated probability that the cloned policy meets a state without data", UNIT_INTERVAL
    ),
    Parameter(
        "class_size",
        r"|\mathcal{G}|",
        "number of densities or policies in a finite class",
        POSITIVE_INTEGER,
        "elements",
    ),
    Parameter(
        "log_covering", r"\log\mathcal{N}", "logarithm of a covering number at scale epsilon", NONNEGATIVE, "nats"
    ),
    Parameter("epsilon", r"\varepsilon", "scale of a cover", POSITIVE),
    Parameter("chi2", r"\chi^2", "chi-square divergence from the truth to the class (0 when realizable)", NONNEGATIVE),
    Parameter("C", r"C(\widehat\pi,\pi^*)", "concentrability coefficient", NONNEGATIVE),
    Parameter("kl", r"\mathrm{KL}", "bound on a Kullback-Leibler divergence", NONNEGATIVE, "nats"),
    Parameter(
        "exit_mass",
        "p",
        "estimated probability of using a state-action pair without data",
        Domain(0, 1, opens=(False, True)),
    ),
    Parameter("ratio", r"\max \widehat m/N", "largest expected visits per recorded use", NONNEGATIVE),
    # online
    Parameter("lam", r"\lambda", "regularisation of the preference estimate", POSITIVE),
    Parameter("delta_martingale", r"\delta'", "failure probability of a martingale bound", PROBABILITY_OPEN),
    Parameter("K", "K", "comparisons per round", POSITIVE_INTEGER, "comparisons"),
    Parameter("N", "N", "observed transitions out of a state-action pair", COUNT, "transitions"),
    Parameter("eta", r"\eta", "bound on the size of the function whose expectation the bonus corrects", POSITIVE),
    Parameter("occupancy", "q", "expected uses of each state-action cell by a policy", NONNEGATIVE, "uses", array=True),
    Parameter("delta_V", r"\delta_V", "failure probability of the relation between data matrices", PROBABILITY_OPEN),
    Parameter(
        "log_det_ratio", r"\log\frac{\det V_t}{(\kappa\lambda)^d}", "growth of the data matrix", NONNEGATIVE, "nats"
    ),
    Parameter("residual", "e_t", "distance of the weights from solving the estimating equation", NONNEGATIVE),
    Parameter("gamma", r"\gamma", "multiplier of the preference uncertainty", POSITIVE),
    Parameter("L", "L", "bound on the norm of every vector", NONNEGATIVE),
    Parameter("v", "v", "initial multiple of the identity in the data matrix", POSITIVE),
    Parameter("square_sum", r"\sum_t\|x_t\|^2", "sum of the squared Euclidean norms", NONNEGATIVE),
    Parameter(
        "norm_sum", r"\sum_t\|D_t\|_{V_t^{-1}}", "sum of the feature differences in the data-matrix norm", NONNEGATIVE
    ),
    Parameter(
        "width_sum", r"\sum_t\rho_t\|D_t\|_{V_t^{-1}}", "sum of the preference uncertainties played", NONNEGATIVE
    ),
    Parameter("bonus_sum", r"\sum_{i,t} b_t(\pi_t^i)", "sum of the bonuses of the policies played", NONNEGATIVE),
    Parameter("potential", r"\sum_t\|D_t\|^2_{V_t^{-1}}", "sum of the squared data-matrix norms", NONNEGATIVE),
    Parameter("bonus_square_sum", r"\sum_{i,t} b_t(\pi_t^i)^2", "sum of the squared bonuses", NONNEGATIVE),
    Parameter("true_bonus", "B_t", "expected bonus under the true dynamics", NONNEGATIVE),
    Parameter("optimism", "o", "estimated advantage over the policies played plus its uncertainty", NONNEGATIVE),
    Parameter("norm", r"\|m\|_2", "norm of the summed feature differences", NONNEGATIVE),
    Parameter("diameter", "D", "largest feature distance between two policies of the offline set", NONNEGATIVE),
    Parameter("Delta_n", r"\Delta_n", "largest total variation from the offline set to the expert", UNIT_INTERVAL),
    Parameter("S_reach", r"|S_{\mathrm{reach}}|", "state-action pairs the expert visits", POSITIVE_INTEGER, "pairs"),
    Parameter("uncovered", "u", "state-action pairs used online with too little offline data", COUNT, "pairs"),
    # certified answers
    Parameter("loss", r"-\ell_t(m)", "minus the log-likelihood of the answers at the weights", NONNEGATIVE, "nats"),
    Parameter("weight_norm", r"\|m\|_2", "norm of the weights in the middle", NONNEGATIVE, "1 / feature norm"),
    Parameter(
        "log_det_growth", r"\log\det(I+\frac{X^\top X}{4\lambda})", "price of the dimension", NONNEGATIVE, "nats"
    ),
    Parameter("evidence_loss", "-Q_t", "minus the log-evidence of the answers", NONNEGATIVE, "nats"),
    Parameter("scales", "k", "scales of the prior, fixed before the answers", POSITIVE_INTEGER, "scales"),
    Parameter("margin", "z", "log-odds of the answer given", NATS, "nats"),
    Parameter("tangent", r"\xi", "log-odds at which the quadratic touches", NONNEGATIVE, "nats"),
    Parameter("multiplier", "c", "multiplier of the likelihood constraint", NONNEGATIVE),
    Parameter(
        "slope", r"\langle\nabla\ell_t(w_0),w_0\rangle", "slope of the log-likelihood along the weights", NATS, "nats"
    ),
    Parameter(
        "dual_norm", r"\|v+c\nabla\ell_t(w_0)\|_2", "norm of what the likelihood leaves of the direction", NONNEGATIVE
    ),
    Parameter("advantage", "a", "largest utility of any candidate above the recommended one", NATS, "nats"),
    Parameter("shortfall", r"\rho", "what may be missing, as a multiple of what is gained", POSITIVE),
    Parameter("slack", "b", "log-likelihood of the weights in the middle above the threshold", NATS, "nats"),
    Parameter("gradient_norm", r"\|\nabla\ell_t\|_2", "norm of the log-likelihood's gradient", NONNEGATIVE),
    Parameter("reach", "r", "distance that a bound on the curvature covers", POSITIVE),
    Parameter("least_curvature", r"\lambda_{\min}(A_r)", "least eigenvalue of the bound on the curvature", NONNEGATIVE),
    Parameter("ridge", r"\eta_A", "multiple of the identity in the ellipsoid's matrix", NONNEGATIVE),
    Parameter("newton_norm", r"\|u\|_{A^{-1}}", "length of a Newton step in its own norm", NONNEGATIVE),
    Parameter("forecasters", "k", "forecasters in an equal mixture", POSITIVE_INTEGER, "forecasters"),
    Parameter("rollouts", "N", "rollouts of each candidate", AT_LEAST_TWO, "rollouts"),
    Parameter("sample_variance", "V", "sample variance of one number over the rollouts", NONNEGATIVE),
    Parameter("spread", "R", "length of the range in which the number surely lies", POSITIVE),
    Parameter("candidates", r"|\Pi|", "candidate policies", POSITIVE_INTEGER, "policies"),
    Parameter("delta_phi", r"\delta_\phi", "failure probability of the features", PROBABILITY_OPEN),
    Parameter(
        "error_norm", r"\|\varepsilon(\pi)+\varepsilon(\hat\pi)\|_2", "norm of the errors of two features", NONNEGATIVE
    ),
    Parameter("look", "k", "how often was looked, this time included", POSITIVE_INTEGER, "looks"),
    Parameter("ellipsoid_radius", r"\rho", "radius of the ellipsoid around the likelihood set", NONNEGATIVE),
    Parameter("feature_reach", "b", "sure bound on a feature difference in the ellipsoid's dual norm", NONNEGATIVE),
    Parameter("pairs", r"\binom K2", "pairs that are compared", POSITIVE_INTEGER, "pairs"),
    Parameter(
        "information", "D", "information that one answer gives against the nearest alternative", POSITIVE, "nats"
    ),
)

PARAMETERS: dict[str, Parameter] = {row.name: row for row in _ROWS}


def parameter(name: str) -> Parameter:
    """The row of the table called ``name``.

    Source: the paper's notation section. Errors: ``InputError`` naming the known parameters.

    >>> parameter("delta").meaning
    'failure probability'
    """
    if name not in PARAMETERS:
        raise InputError(f"{name!r} is not a parameter of any bound; the known ones are {', '.join(PARAMETERS)}")
    return PARAMETERS[name]
