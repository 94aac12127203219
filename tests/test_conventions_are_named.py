"""Data whose shape leaves open what is meant are refused with the word to give; where it tells, nothing is asked."""

from pathlib import Path

import numpy as np
import pytest

from bridge_algos.envs.registry import make_mdp, mdp_names
from bridge_algos.evaluation import expected_return
from bridge_algos.mdp import TabularMDP
from bridge_algos.mdp_file import load_mdp, save_mdp
from bridge_theory.errors import InputError
from experiments.cli import main

SQUARE = np.random.default_rng(0).dirichlet(np.ones(3), size=(3, 3))
OBLONG = np.random.default_rng(0).dirichlet(np.ones(3), size=(3, 2))
START = [1.0, 0.0, 0.0]
PAY = np.array([0.0, 1.0, 5.0])


def test_as_many_actions_as_states_leave_the_order_of_axes_open() -> None:
    with pytest.raises(
        InputError, match=r"fits P\[s, a, s'\] and P\[a, s, s'\]; give axes='state-action' for the first"
    ):
        TabularMDP(SQUARE, START, 4, np.zeros(3))
    kept = TabularMDP(SQUARE, START, 4, np.zeros(3), axes="state-action")
    turned = TabularMDP(SQUARE, START, 4, np.zeros(3), axes="action-state")
    np.testing.assert_array_equal(kept.transitions, SQUARE)
    np.testing.assert_array_equal(turned.transitions, SQUARE.swapaxes(0, 1))
    symmetric = (SQUARE + SQUARE.swapaxes(0, 1)) / 2
    assert TabularMDP(symmetric, START, 4, np.zeros(3)).n_actions == 3


def test_the_other_order_of_axes_is_taken_by_its_name() -> None:
    pay = np.random.default_rng(1).normal(size=(3, 2, 3))
    right = TabularMDP(OBLONG, START, 4, pay)
    with pytest.raises(
        InputError, match=r"has shape \(2, 3, 3\), expected \(S, A, S\), or \(A, S, S\) with axes='action"
    ):
        TabularMDP(OBLONG.swapaxes(0, 1), START, 4, pay.swapaxes(0, 1))
    turned = TabularMDP(OBLONG.swapaxes(0, 1), START, 4, pay.swapaxes(0, 1), axes="action-state")
    np.testing.assert_array_equal(turned.transitions, right.transitions)
    np.testing.assert_array_equal(turned.reward, right.reward)


def test_a_reward_of_a_state_is_of_arriving_or_of_acting_there() -> None:
    with pytest.raises(
        InputError, match=r"give reward_on='arrival' for the first or reward_on='departure' for the second"
    ):
        TabularMDP(OBLONG, START, 4, PAY)
    arriving, acting = (TabularMDP(OBLONG, START, 4, PAY, reward_on=on) for on in ("arrival", "departure"))
    policy = np.array([0, 1, 0])
    kernel = OBLONG[np.arange(3), policy]
    laws = [np.array(START)]
    for _ in range(4):
        laws.append(laws[-1] @ kernel)
    assert expected_return(arriving, policy) == pytest.approx(sum(law @ PAY for law in laws[1:]))
    assert expected_return(acting, policy) == pytest.approx(sum(law @ PAY for law in laws[:-1]))
    assert TabularMDP(OBLONG, START, 4, np.ones(3)).reward_on == "arrival", "where both are the same nothing is asked"


def test_a_square_table_of_rewards_is_of_pairs_only_when_it_says_so() -> None:
    table = np.arange(9.0).reshape(3, 3)
    with pytest.raises(InputError, match="give reward_on='pair' for the first"):
        TabularMDP(SQUARE, START, 4, table, axes="state-action")
    np.testing.assert_array_equal(
        TabularMDP(SQUARE, START, 4, table, axes="state-action", reward_on="pair").expected_reward, table
    )


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"axes": "sas"}, "axes is 'sas', expected one of state-action, action-state"),
        ({"reward_on": "leaving"}, "reward_on is 'leaving', expected one of arrival, departure, pair, transition"),
        ({"reward_on": "pair"}, "reward_on is 'pair', which needs 2 axes, but reward has 1"),
    ],
)
def test_words_that_do_not_fit_are_refused(words: dict[str, str], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        TabularMDP(OBLONG, START, 4, PAY, **words)


@pytest.mark.parametrize("name", mdp_names())
def test_files_know_their_convention_also_older_ones(name: str, tmp_path: Path) -> None:
    mdp, path = make_mdp(name), tmp_path / "mine.npz"
    save_mdp(path, mdp)
    with np.load(path) as stored:
        arrays = dict(stored)
    assert {"axes", "reward_on"} <= set(arrays)
    for drop in ((), ("axes", "reward_on")):
        np.savez(path, **{key: array for key, array in arrays.items() if key not in drop})
        back = load_mdp(path)
        np.testing.assert_array_equal(back.transitions, mdp.transitions)
        np.testing.assert_array_equal(back.reward, mdp.reward)
        assert back.reward_on == mdp.reward_on


def test_files_of_ones_own_arrays_are_asked(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    arrays = {"transitions": SQUARE, "initial": START, "horizon": 4, "reward": PAY}
    np.savez("mine.npz", **arrays)
    assert main(["run", "mine.npz", "--rounds", "1", "--seeds", "1"]) == 2
    told = capsys.readouterr().err
    assert "give axes='state-action' for the first" in told
    assert "give reward_on='arrival' for the first" in told
    assert told.count("in an .npz file as an entry of that name") == 2
    np.savez("mine.npz", **arrays, axes="action-state", reward_on="departure")
    back = load_mdp("mine.npz")
    np.testing.assert_array_equal(back.transitions, SQUARE.swapaxes(0, 1))
    np.testing.assert_array_equal(back.reward, np.repeat(PAY[:, None], 3, axis=1))
