"""A faulty MDP, trajectory or policy is refused in a sentence that says what is wrong."""

import numpy as np
import pytest

from bridge_algos.mdp import TabularMDP, check_mdp
from bridge_algos.policies import action_probabilities
from bridge_algos.trajectories import Trajectories, load_trajectories, save_trajectories
from bridge_theory.errors import InputError

KERNEL = np.array([[[0.5, 0.5]], [[0.0, 1.0]]])
GOOD = {"transitions": KERNEL, "initial": [1.0, 0.0], "horizon": 2, "reward": [0.0, 1.0], "reward_on": "arrival"}


def changed(**changes: object) -> dict[str, object]:
    return {**GOOD, **changes}


@pytest.mark.parametrize(
    ("faulty", "sentence"),
    [
        (changed(horizon=0), "horizon is 0"),
        (changed(horizon=2.5), "horizon is 2.5"),
        (changed(transitions=KERNEL - [0.0, 0.6]), "negative probability"),
        (changed(transitions=KERNEL * 0.9), "sums to 0.9"),
        (changed(transitions=KERNEL * (1 + 3e-9)), "expected 1 within 1e-09"),
        (changed(transitions=np.full((2, 1, 2), np.nan)), "not a finite number"),
        (changed(transitions=np.zeros((2, 1, 2))), "no trajectory through it reaches the horizon"),
        (changed(transitions=KERNEL[0]), "expected (S, A, S)"),
        (changed(transitions=[[1], [2, 3]]), "ragged"),
        (changed(initial=[1.0]), "initial has shape (1,)"),
        (changed(initial=[0.7, 0.7]), "initial sums to 1.4"),
        (changed(reward=[0.0]), "reward has shape (1,)"),
        (changed(reward=[0.0, np.inf]), "not finite"),
    ],
)
def test_faults_are_named(faulty: dict[str, object], sentence: str) -> None:
    faults = check_mdp(**faulty)  # type: ignore[arg-type]
    assert any(sentence in fault for fault in faults), faults
    with pytest.raises(InputError, match=r"not valid|expected"):
        TabularMDP(**faulty)  # type: ignore[arg-type]


def test_rows_off_by_rounding_are_accepted_and_inputs_frozen() -> None:
    mdp = TabularMDP(**changed(transitions=KERNEL * (1 + 5e-10)))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="read-only"):
        mdp.transitions[0, 0, 0] = 1.0


def test_every_reward_form_has_the_same_expectation() -> None:
    arrival = TabularMDP(**GOOD)  # type: ignore[arg-type]
    pair = TabularMDP(**changed(reward=arrival.expected_reward, reward_on="pair"))  # type: ignore[arg-type]
    transition = TabularMDP(**changed(reward=np.broadcast_to([0.0, 1.0], (2, 1, 2)), reward_on=""))  # type: ignore[arg-type]
    np.testing.assert_array_equal(arrival.expected_reward, [[0.5], [1.0]])
    np.testing.assert_array_equal(pair.expected_reward, arrival.expected_reward)
    np.testing.assert_array_equal(transition.expected_reward, arrival.expected_reward)


def test_names_of_wrong_number_are_refused() -> None:
    with pytest.raises(InputError, match="state_names"):
        TabularMDP(**changed(state_names=("a",)))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("policy", "sentence"),
    [
        ([0, 2], "actions 0..2"),
        ([0], "has shape"),
        ([[0.5, 0.4], [1.0, 0.0]], "does not sum to 1"),
        ([[1.5, -0.5], [1.0, 0.0]], "negative"),
        ([0.5, 0.5], "stochastic"),
    ],
)
def test_faulty_policies_are_refused(policy: object, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        action_probabilities(policy, n_states=2, n_actions=2, horizon=3)  # type: ignore[arg-type]


def test_demonstrations_survive_the_disk_and_faults_are_named(tmp_path) -> None:
    path = tmp_path / "demos.npz"
    demos = Trajectories(np.array([[0, 1]]), np.array([[0, 0]]), np.array([[0.5, 1.0]]))
    save_trajectories(path, demos)
    back = load_trajectories(path, n_states=2, n_actions=1, horizon=2)
    np.testing.assert_array_equal(back.states, demos.states)
    np.testing.assert_array_equal(back.rewards, demos.rewards)
    for arguments, sentence in [
        ((1, 1), "states holds values 0..1"),
        ((2, 1, 5), "expected the MDP's horizon 5"),
    ]:
        with pytest.raises(InputError, match=sentence):
            load_trajectories(path, *arguments)
    with pytest.raises(InputError, match="does not exist"):
        load_trajectories(tmp_path / "none.npz", 2, 1)
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(InputError, match="not a readable"):
        load_trajectories(path, 2, 1)
    np.savez(tmp_path / "other.npz", steps=np.arange(3))
    with pytest.raises(InputError, match="lacks"):
        load_trajectories(tmp_path / "other.npz", 2, 1)
    np.savez(tmp_path / "pickled.npz", states=np.array([{}], dtype=object), actions=np.array([[0]]))
    with pytest.raises(InputError, match="not a readable"):
        load_trajectories(tmp_path / "pickled.npz", 2, 1)
