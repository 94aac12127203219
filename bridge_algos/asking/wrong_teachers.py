"""Teachers who do not follow the model: how often the test says so, and how often a wrong certificate comes first.

The teachers are B-Pref's (Lee et al. 2021), asked about a tabular environment. What is certified is held against the
expected utility that the teacher judges without its flaw.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import numpy as np

from bridge_algos.asking.elicitation import Elicitation
from bridge_algos.asking.tabular import POOL, Problem, build_problem
from bridge_algos.asking.utility import Utility, simulated_utility, step_features
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.occupancy import state_action_occupancies
from bridge_algos.online.oracles import Oracle, ReturnOracle
from bridge_algos.trajectories import Trajectories, sample_trajectories
from bridge_theory.errors import InputError

EMBEDDING = "state_action_counts"
"""In which the teachers' utility is linear."""


@dataclass(frozen=True, eq=False)
class WrongTeacher:
    """A teacher with a flaw.

    Args:
        oracle: answers; 1/2 and NaN count as no answer.
        embedding: what the session takes for the features.
        rewards: what the oracle is shown of the per-step utilities (n, H).
    """

    oracle: Oracle
    embedding: str = EMBEDDING
    rewards: Callable[[FloatArray], FloatArray] = np.asarray


def _coin_when_equal(within: float) -> Oracle:
    exact = ReturnOracle(rationality=1.0, equal_within=within)

    def answers(first: Trajectories, second: Trajectories, rng: np.random.Generator) -> FloatArray:
        given = exact(first, second, rng)
        return np.where(given == 0.5, rng.random(len(given)) < 0.5, given)

    return answers


def _cycle_of_grades(first: Trajectories, second: Trajectories, rng: np.random.Generator) -> FloatArray:
    """Grades are utilities in whole nats modulo 3; the next one is preferred with probability .9, equals by a coin."""
    shown = [np.zeros((1, 1)) if part.rewards is None else part.rewards for part in (first, second)]
    a, b = (np.floor(rewards.sum(axis=1)).astype(np.int64) for rewards in shown)
    chance = np.array([0.5, 0.9, 0.1])[(a - b) % 3]
    return np.asarray(rng.random(len(chance)) < chance, dtype=np.float64)


def _best_step(utilities: FloatArray) -> FloatArray:
    """All steps but the best one count nothing, and the best one as much as a whole trajectory of such steps."""
    peak = np.zeros_like(utilities)
    peak[:, 0] = utilities.max(axis=1) * utilities.shape[1]
    return peak


TEACHERS: dict[str, WrongTeacher] = {
    "follows the model": WrongTeacher(ReturnOracle(rationality=1.0)),
    "mistakes, 10 %": WrongTeacher(ReturnOracle(rationality=1.0, mistakes=0.1)),
    "mistakes, 30 %": WrongTeacher(ReturnOracle(rationality=1.0, mistakes=0.3)),
    "always mistaken": WrongTeacher(ReturnOracle(rationality=1.0, mistakes=1.0)),
    "never errs": WrongTeacher(ReturnOracle()),
    "myopia, discount 0.9": WrongTeacher(ReturnOracle(rationality=1.0, myopia=0.9)),
    "myopia, discount 0.5": WrongTeacher(ReturnOracle(rationality=1.0, myopia=0.5)),
    "equal within 1 nat, left out": WrongTeacher(ReturnOracle(rationality=1.0, equal_within=1.0)),
    "equal within 1 nat, by a coin": WrongTeacher(_coin_when_equal(1.0)),
    "embedding blind to actions": WrongTeacher(ReturnOracle(rationality=1.0), embedding="state_counts"),
    "prefers grades in a cycle": WrongTeacher(_cycle_of_grades),
    "judges the best step only": WrongTeacher(ReturnOracle(rationality=1.0), rewards=_best_step),
}
"""The flaws that are studied, by name."""


@dataclass(frozen=True)
class Verdicts:
    """What became of a number of sessions with one teacher.

    Args:
        teacher: its name.
        sessions: how many sessions had something to ask.
        refuted: sessions in which the answers were said to contradict the model.
        certified: sessions that ended with a certificate instead.
        wrong: certificates whose recommendation misses the goal by the teacher's utility.
        median_questions: until a session ended, inf where most did not.
    """

    teacher: str
    sessions: int
    refuted: int
    certified: int
    wrong: int
    median_questions: float

    @property
    def sentence(self) -> str:
        """In words, to be told beside a certificate."""
        return (
            f"A teacher with the flaw '{self.teacher}' was refuted in {self.refuted} of {self.sessions} sessions; "
            f"{self.certified} ended with a certificate before, and {self.wrong} of these were wrong."
        )


def wrong_teacher(
    name: str,
    mdp: TabularMDP,
    sessions: int,
    utility_range: float = 5.0,
    n_demonstrations: int = 1,
    until: str = "10%",
    max_questions: int = 300,
    pool: int = POOL,
) -> Verdicts:
    """Sessions, a seed each, with a teacher who does not follow the model.

    Args:
        name: one of TEACHERS.
        mdp: the environment.
        sessions: how many; those with one candidate have nothing to ask and do not count.
        utility_range, n_demonstrations, until, max_questions, pool: as of
            :class:`bridge_algos.asking.config.AskConfig`.

    Raises:
        InputError: for another name.
    """
    if name not in TEACHERS:
        raise InputError(f"the teacher must be one of {', '.join(TEACHERS)}, got {name!r}.")
    truth = simulated_utility(mdp, EMBEDDING, utility_range)
    asked = simulated_utility(mdp, TEACHERS[name].embedding, utility_range)
    ends: list[tuple[float, bool, bool, bool]] = []
    for seed in range(sessions):
        rng = np.random.default_rng(seed)
        demonstrations = sample_trajectories(mdp, truth.best.policy, n_demonstrations, rng)
        problem = build_problem(mdp, asked, n_demonstrations, rng, demonstrations, pool=pool)
        if len(problem.candidates.policies) == 1:
            continue
        session = problem.session(until, 0.05, "pool", rng)
        _answer(session, problem, TEACHERS[name], truth, max_questions, rng)
        gap = _value(mdp, truth, truth.best.policy) - _value(
            mdp, truth, problem.candidates.policies[session.recommended]
        )
        wrong = session.certified and gap > session.goal.nats + 1e-9
        ends.append((len(session.history) if session.done else inf, session.contradicted, session.certified, wrong))
    flags = np.array([row[1:] for row in ends], dtype=np.int64).reshape(-1, 3).sum(axis=0)
    median = float(np.quantile([row[0] for row in ends], 0.5, method="higher")) if ends else inf
    return Verdicts(name, len(ends), int(flags[0]), int(flags[1]), int(flags[2]), median)


def _answer(
    session: Elicitation, problem: Problem, teacher: WrongTeacher, truth: Utility, most: int, rng: np.random.Generator
) -> None:
    """Answer until the session is done, or ``most`` questions were asked."""
    utilities = step_features(EMBEDDING, problem.mdp) @ truth.weights
    pool = problem.pool
    shown = Trajectories(pool.states, pool.actions, teacher.rewards(utilities[pool.states, pool.actions]))
    while not session.done and len(session.history) < most:
        question = session.ask()
        first, second = (shown[slice(item, item + 1)] for item in (question.first, question.second))
        given = float(teacher.oracle(first, second, rng)[0])
        session.tell(question, int(given) if given in (0.0, 1.0) else None)


def _value(mdp: TabularMDP, truth: Utility, policy: IntArray) -> float:
    """Expected utility of a deterministic policy."""
    visits = state_action_occupancies(mdp.dynamics, np.eye(mdp.n_actions)[policy]).sum(axis=0)
    return float((visits * (step_features(EMBEDDING, mdp) @ truth.weights)).sum())
