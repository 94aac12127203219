"""What the studies' narrow figures share."""

from __future__ import annotations

from typing import Any


def legend_below(picture: Any, columns: int) -> None:
    """One legend for all panels, in as many columns as a narrow figure can carry."""
    curves = {
        label: line for axes in picture.axes for line, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    picture.legend(curves.values(), curves, loc="outside lower center", ncols=columns, fontsize=8, frameon=False)
