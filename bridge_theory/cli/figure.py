"""Figures of bounds; Matplotlib is imported when one is drawn."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bridge_theory.arithmetic.protocol import FloatArray
from bridge_theory.errors import InputError

# the colour-blind safe palette of Okabe and Ito
_COLOURS = {"stated": "#D55E00", "repaired": "#0072B2", "sharp": "#009E73", "trivial": "#000000"}
_STYLES = ("-", "--", ":", "-.")


@dataclass(frozen=True)
class Curve:
    """One line of a figure; ``status`` is ``stated``, ``repaired``, ``sharp`` or ``trivial``."""

    label: str
    status: str
    x: FloatArray
    y: FloatArray


def draw(
    path: Path, curves: Sequence[Curve], *, x_label: str, y_label: str, title: str, log_x: bool, log_y: bool
) -> None:
    """Write one figure with a line per curve, coloured by status.

    Errors: ``InputError`` if the file's ending is not one Matplotlib can write.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    if path.suffix.lstrip(".") not in figure.canvas.get_supported_filetypes():
        raise InputError(f"cannot write a figure to {path}; use a name that ends in .png, .pdf or .svg")
    axes = figure.add_subplot()
    drawn: dict[str, int] = {}
    for curve in curves:
        style = _STYLES[drawn.get(curve.status, 0) % len(_STYLES)] if curve.status != "trivial" else (0, (1, 1))
        drawn[curve.status] = drawn.get(curve.status, 0) + 1
        axes.plot(curve.x, curve.y, linestyle=style, color=_COLOURS[curve.status], label=curve.label, linewidth=1.8)
    axes.set_xscale("log" if log_x else "linear")
    axes.set_yscale("log" if log_y else "linear")
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    figure.suptitle(textwrap.fill(title, 90), fontsize=10)
    axes.grid(visible=True, which="major", alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(fontsize=8, frameon=False, loc="outside lower center", ncols=2)
    figure.savefig(path, dpi=150)
