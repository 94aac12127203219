"""Where the four moves lead on a rectangular map of characters, one character a state in reading order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bridge_algos.mdp import IntArray

DIRECTIONS = ("left", "right", "up", "down")
OBSTACLE = "#"
NO_CELL = -1

_STEPS = {"left": (0, -1), "right": (0, 1), "up": (-1, 0), "down": (1, 0)}


def move_targets(layout: Sequence[str]) -> IntArray:
    """(S, 4) cell that each of :data:`DIRECTIONS` leads to; ``NO_CELL`` off the map, into or out of an obstacle ``#``.

    >>> move_targets(["..", "#."])
    array([[-1,  1, -1, -1],
           [ 0, -1, -1,  3],
           [-1, -1, -1, -1],
           [-1, -1,  1, -1]])
    """
    cells = np.array([list(row) for row in layout])
    targets = np.full((cells.size, len(DIRECTIONS)), NO_CELL, dtype=np.int64)
    for (row, column), character in np.ndenumerate(cells):
        for action, direction in enumerate(DIRECTIONS):
            r, c = row + _STEPS[direction][0], column + _STEPS[direction][1]
            inside = 0 <= r < cells.shape[0] and 0 <= c < cells.shape[1]
            if inside and OBSTACLE not in (character, cells[r, c]):
                targets[row * cells.shape[1] + column, action] = r * cells.shape[1] + c
    return targets


def cell_names(layout: Sequence[str]) -> tuple[str, ...]:
    """Names of the cells, ``(row,column)`` counted from the top left corner."""
    return tuple(f"({row},{column})" for row in range(len(layout)) for column in range(len(layout[row])))
