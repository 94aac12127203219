"""StarMDP and Gridworld are the paper's; where text and published runs differ is written down and does not drift."""

import json
from importlib.resources import files

import numpy as np
import pytest

from bridge_algos.envs import gridworld, star_mdp
from bridge_theory.errors import InputError

PUBLISHED = json.loads(files("bridge_algos.envs").joinpath("published_mdps.json").read_text(encoding="utf-8"))
MOVES = {"left": (0, -1), "right": (0, 1), "up": (-1, 0), "down": (1, 0)}


@pytest.mark.parametrize(("make", "name"), [(star_mdp, "StarMDP"), (gridworld, "Gridworld")])
def test_published_variant_is_the_data_file(make, name):
    mdp, record = make("published"), PUBLISHED[name]
    assert np.array_equal(mdp.transitions, record["transitions"])
    assert np.array_equal(mdp.reward, record["reward_on_arrival"])
    assert (mdp.horizon, mdp.action_names) == (record["horizon"], tuple(record["actions"]))
    assert np.array_equal(mdp.initial, np.eye(mdp.n_states)[0])
    assert "published runs" in PUBLISHED["source"]


def test_published_is_the_default():
    assert np.array_equal(star_mdp().transitions, star_mdp("published").transitions)
    assert np.array_equal(gridworld().reward, gridworld("published").reward)


def test_the_two_star_variants_differ_in_the_twelve_impossible_pairs_only():
    text, published = star_mdp("text"), star_mdp("published")
    assert (text.horizon, text.action_names) == (published.horizon, published.action_names) == (8, text.action_names)
    assert np.array_equal(text.reward, published.reward)
    assert np.array_equal(text.initial, published.initial)
    arrows = {(0, 0), (1, 0), (1, 1), (1, 2), (1, 3), (2, 1), (3, 2), (4, 3)}
    left_out = {0: [None, 1, 2, 3], 2: [4, None, 4, 3], 3: [2, 1, None, 4], 4: [2, 1, 3, None]}
    for s in range(5):
        for a in range(4):
            if (s, a) in arrows:
                assert np.array_equal(text.transitions[s, a], published.transitions[s, a])
                continue
            assert np.array_equal(text.transitions[s, a], np.eye(5)[s])
            expected = np.full(5, 0.1)
            expected[[s, left_out[s][a]]] = 0.7, 0.0
            assert published.transitions[s, a] == pytest.approx(expected, abs=1e-15)


def test_star_arrows_are_those_of_the_figure():
    text = star_mdp("text")
    heads = {(0, "right"): 1, (1, "right"): 2, (1, "left"): 0, (1, "up"): 4, (1, "down"): 3}
    heads |= {(2, "left"): 1, (3, "up"): 1, (4, "down"): 1}
    for (s, action), head in heads.items():
        row = text.transitions[s, text.action_names.index(action)]
        others = [i for i in range(5) if i not in (s, head)]
        assert row[head] == 0.7
        assert row[s] == 0
        assert row[others] == pytest.approx(0.1)
    assert text.reward.tolist() == [0, 0, 6, -1, 10]


def _open_cells(cell: int, obstacle: int) -> dict[str, int]:
    row, column = divmod(cell, 4)
    cells = {}
    for action, (dr, dc) in MOVES.items():
        r, c = row + dr, column + dc
        if 0 <= r < 4 and 0 <= c < 4 and obstacle not in (cell, 4 * r + c):
            cells[action] = 4 * r + c
    return cells


def test_published_gridworld_slips_to_any_of_five_actions_and_blocked_moves_stay():
    """An independent description of the published kernel, which leaves no entry of it unexplained."""
    mdp = gridworld("published")
    for s in range(16):
        for a, chosen in enumerate(mdp.action_names):
            expected = np.zeros(16)
            for executed in mdp.action_names:
                probability = 0.8 * (executed == chosen) + 0.2 / 5
                expected[_open_cells(s, obstacle=6).get(executed, s)] += probability
            assert mdp.transitions[s, a] == pytest.approx(expected, abs=1e-12)


def test_text_gridworld_slips_to_three_directions_and_spreads_blocked_mass_equally():
    mdp = gridworld("text")
    for s in range(16):
        cells = _open_cells(s, obstacle=9)
        for a, chosen in enumerate(mdp.action_names):
            expected = np.zeros(16)
            if chosen == "stay" or s == 9:
                expected[s] = 1
            else:
                law = {d: 0.8 if d == chosen else 0.2 / 3 for d in MOVES}
                spread = sum(p for d, p in law.items() if d not in cells) / len(cells)
                for d, target in cells.items():
                    expected[target] = law[d] + spread
            assert mdp.transitions[s, a] == pytest.approx(expected, abs=1e-12)


def test_text_gridworld_by_hand():
    """Numbers worked out on paper: a corner, a cell beside the obstacle, the open cell."""
    mdp = gridworld("text")
    left, right, up, _, _ = range(5)
    assert mdp.transitions[0, right, [1, 4]] == pytest.approx([0.8 + 1 / 15, 2 / 15])
    assert mdp.transitions[8, right, [4, 12]] == pytest.approx([0.5, 0.5])
    assert mdp.transitions[5, up, [1, 4, 6]] == pytest.approx([0.8 + 1 / 45, 4 / 45, 4 / 45])
    assert mdp.transitions[10, left, [6, 11, 14]] == pytest.approx([1 / 3, 1 / 3, 1 / 3])


def test_gridworld_variants_differ_as_documented():
    text, published = gridworld("text"), gridworld("published")
    assert (text.horizon, text.action_names) == (published.horizon, published.action_names)
    assert text.horizon == 10
    assert {s: r for s, r in enumerate(text.reward) if r} == {2: -1, 3: -1, 6: -1, 7: -1, 9: 20, 15: 10}
    assert np.array_equal(text.reward.reshape(4, 4).T.ravel(), published.reward)
    differs = np.abs(text.transitions - published.transitions).max(axis=2) > 1e-9
    assert np.argwhere(~differs).tolist() == [[6, text.action_names.index("stay")]]
    assert text.transitions[:, 4].diagonal().tolist() == [1.0] * 16
    assert published.transitions[9, 4, 9] == pytest.approx(0.84)


@pytest.mark.parametrize(("variant", "prize"), [("text", 9), ("published", 6)])
def test_the_prize_of_gridworld_is_unreachable(variant, prize):
    transitions = gridworld(variant).transitions
    others = [s for s in range(16) if s != prize]
    assert not transitions[others, :, prize].any()


@pytest.mark.parametrize("variant", ["text", "published"])
def test_layout_and_names_describe_the_rewards(variant):
    mdp = gridworld(variant)
    value = {"S": 0, ".": 0, "-": -1, "#": 20, "G": 10}
    assert [value[c] for row in mdp.layout for c in row] == mdp.reward.tolist()
    assert mdp.state_names[6] == "(1,2)"


@pytest.mark.parametrize("make", [star_mdp, gridworld])
def test_unknown_variant_is_refused(make):
    with pytest.raises(InputError, match="variant is 'paper', expected one of 'text', 'published'"):
        make("paper")
