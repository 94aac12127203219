"""One state of an episode as an image: grids as maps, other MDPs as states on a circle.

Matplotlib draws it on its Agg canvas, without pyplot, so that no window system and no global state is touched.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bridge_algos.envs.grid import OBSTACLE
from bridge_algos.envs.render_text import caption
from bridge_algos.mdp import FloatArray, TabularMDP

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, PAPER, MUTED = "#1f2933", "#ffffff", "#7b8794"
AGENT, GAIN, LOSS = "#0072b2", "#009e73", "#d55e00"  # Okabe and Ito: told apart by the colour-blind
CELL_COLOURS = {OBSTACLE: "#52606d", "S": "#e4e7eb", "G": "#bfe3d8", "H": "#cbd2d9", "C": "#f3c6a5"}
CELL_WORDS = {"S": "start", "G": "goal", "H": "hole", "C": "cliff"}
MOST_NAMED_STATES = 24
HEADER_INCHES = 0.62


def draw(mdp: TabularMDP, state: int, action: int | None, reward: float, step: int) -> NDArray[np.uint8]:
    """The image as an array (height, width, 3) of uint8."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    size = _grid_size(mdp) if mdp.layout else (5.6, 5.9)
    figure = Figure(figsize=size, dpi=100, facecolor=PAPER)
    canvas: Any = FigureCanvasAgg(figure)
    header = HEADER_INCHES / size[1]
    title, _, happened = caption(mdp, action, reward, step).partition(": ")
    below = happened or f"start in {mdp.state_names[state]}"
    figure.text(0.5, 1 - 0.35 * header, title, ha="center", va="center", fontsize=12, color=INK, weight="bold")
    figure.text(0.5, 1 - 0.85 * header, below, ha="center", va="center", fontsize=10.5, color=MUTED)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96 - header))
    axes.set_axis_off()
    axes.set_aspect("equal")
    (_draw_grid if mdp.layout else _draw_circle)(axes, mdp, state)
    canvas.draw()
    return np.ascontiguousarray(np.asarray(canvas.buffer_rgba())[..., :3])


def arrival_rewards(mdp: TabularMDP) -> FloatArray:
    """(S,) reward of arriving in a state, nan where it depends on where from; staying in absorbing states is left out.

    >>> from bridge_algos.envs.families import chain
    >>> arrival_rewards(chain(3))
    array([ 2., 0., nan])
    """
    if mdp.reward.ndim == 1:
        return mdp.reward
    pay = np.broadcast_to(mdp.reward if mdp.reward.ndim == 3 else mdp.reward[..., None], mdp.transitions.shape)
    states = np.arange(mdp.n_states)
    possible = mdp.transitions > 0
    absorbing = (mdp.transitions[states, :, states] == 1).all(axis=1)
    possible[absorbing] = False
    lowest = np.where(possible, pay, np.inf).min(axis=(0, 1))
    highest = np.where(possible, pay, -np.inf).max(axis=(0, 1))
    return np.where(lowest == highest, lowest, np.nan)


def _grid_size(mdp: TabularMDP) -> tuple[float, float]:
    n_rows, n_columns = len(mdp.layout), len(mdp.layout[0])
    cell = float(np.clip(7.0 / max(n_rows, n_columns), 0.62, 1.15))
    return max(cell * n_columns, 4.2) + 0.2, cell * n_rows + HEADER_INCHES + 0.2


def _draw_grid(axes: Axes, mdp: TabularMDP, state: int) -> None:
    from matplotlib.patches import Circle, Rectangle

    n_rows, n_columns = len(mdp.layout), len(mdp.layout[0])
    pays = arrival_rewards(mdp)
    strongest, usual = np.nanmax(np.abs(pays), initial=0.0), _usual_pay(pays)
    axes.set_xlim(-0.03, n_columns + 0.03)
    axes.set_ylim(n_rows + 0.03, -0.03)
    for cell, character in enumerate("".join(mdp.layout)):
        row, column = divmod(cell, n_columns)
        notable = np.isfinite(pays[cell]) and pays[cell] not in (0, usual)
        is_wall, is_here = character == OBSTACLE, cell == state
        face = _tint(pays[cell], strongest) if notable and not is_wall else CELL_COLOURS.get(character, PAPER)
        axes.add_patch(Rectangle((column, row), 1, 1, facecolor=face, edgecolor="#9aa5b1", linewidth=1.0))
        if is_here:
            axes.add_patch(Circle((column + 0.5, row + 0.5), 0.3, facecolor=AGENT, edgecolor=PAPER, linewidth=2))
        ink = PAPER if is_wall else INK
        _write(axes, (column + 0.06, row + 0.06), mdp.state_names[cell], 6.5, ink, ha="left", va="top", alpha=0.7)
        _write(axes, (column + 0.94, row + 0.94), CELL_WORDS.get(character, ""), 7, ink, ha="right", va="bottom")
        if notable:
            _write(axes, (column + 0.5, row + 0.5), f"{pays[cell]:+.3g}", 13, PAPER if is_here else ink)


def _draw_circle(axes: Axes, mdp: TabularMDP, state: int) -> None:
    from matplotlib.patches import Circle

    n = mdp.n_states
    angles = np.pi - 2 * np.pi * np.arange(n) / n
    centres = np.column_stack([np.cos(angles), np.sin(angles)])
    radius = float(np.clip(2.2 / n, 0.012, 0.2))
    pays = arrival_rewards(mdp)
    strongest = np.nanmax(np.abs(pays), initial=0.0)
    axes.set_xlim(-1.4, 1.4)
    axes.set_ylim(-1.45, 1.35)
    if n > MOST_NAMED_STATES:
        for centre, pay in zip(centres, pays, strict=True):
            axes.add_patch(Circle(centre, radius, facecolor=_tint(pay, strongest), edgecolor=MUTED))
        axes.add_patch(Circle(centres[state], 0.05, facecolor=AGENT, edgecolor=PAPER, linewidth=1.5, zorder=5))
        _write(axes, (0, 0), f"state {mdp.state_names[state]}\nof {n}", 14, INK)
        return
    _draw_likely_moves(axes, mdp, state, centres, radius)
    for index, centre in enumerate(centres):
        face = AGENT if index == state else _tint(pays[index], strongest)
        axes.add_patch(Circle(centre, radius, facecolor=face, edgecolor=INK, linewidth=1.2, zorder=3))
        ink = PAPER if index == state else INK
        _write(axes, centre, mdp.state_names[index], 12 if radius > 0.12 else 8, ink, zorder=4)
        if np.isfinite(pays[index]) and pays[index] != 0:
            _write(axes, centre * (1.06 + 1.3 * radius), f"{pays[index]:+.3g}", 10, INK)


def _draw_likely_moves(axes: Axes, mdp: TabularMDP, state: int, centres: FloatArray, radius: float) -> None:
    """An arrow from the current state to the most likely successor of each action, and the actions that lead there."""
    from matplotlib.patches import FancyArrowPatch

    likely = mdp.transitions[state].argmax(axis=1)
    for target in np.unique(likely):
        names = ", ".join(mdp.action_names[action] for action in np.flatnonzero(likely == target))
        if target == state:
            _write(axes, (0, -1.37), f"{names}: most likely stays in {mdp.state_names[state]}", 9, MUTED)
            continue
        way = centres[target] - centres[state]
        margin = 1.15 * radius * way / np.linalg.norm(way)
        tail, head = centres[state] + margin, centres[target] - margin
        axes.add_patch(FancyArrowPatch(tail, head, arrowstyle="-|>", mutation_scale=13, color=MUTED, linewidth=1.3))
        backing = {"facecolor": PAPER, "edgecolor": "none", "pad": 1.5}
        _write(axes, 0.45 * tail + 0.55 * head, names, 10, INK, bbox=backing)


def _write(axes: Axes, point: Sequence[float] | FloatArray, text: str, size: float, colour: str, **style: Any) -> None:
    axes.text(point[0], point[1], text, fontsize=size, color=colour, **({"ha": "center", "va": "center"} | style))


def _usual_pay(pays: FloatArray) -> float:
    """The pay of most cells, such as -1 a step: written into each of them it would hide the pays that matter."""
    values, counts = np.unique(pays[np.isfinite(pays)], return_counts=True)
    return float(values[counts.argmax()]) if len(values) else 0.0


def _tint(pay: float, strongest: float) -> str | tuple[float, ...]:
    """White for nothing, towards green for gains and orange for losses."""
    from matplotlib.colors import to_rgb

    if not np.isfinite(pay) or pay == 0:
        return PAPER
    strength = 0.2 + 0.45 * abs(pay) / strongest
    colour = np.array(to_rgb(GAIN if pay > 0 else LOSS))
    return tuple(1 - strength * (1 - colour))
