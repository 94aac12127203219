"""A matplotlib figure as interactive plots: the same artists, for plotly.js to draw.

Every panel becomes one plot, so that panels can stand below each other on a phone; the curves that share a label form
one group, which one entry of the common legend shows and hides. An artist that is not understood is refused, never left
out: the caller then shows the picture itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from bridge_theory.errors import InputError
from experiments.report.mathtext import markup

Spec = dict[str, Any]
_DASHES = {"-": "solid", "--": "dash", ":": "dot", "-.": "dashdot"}
_MARKERS = {
    "o": "circle", ".": "circle", "s": "square", "^": "triangle-up", "v": "triangle-down", "D": "diamond",
    "d": "diamond", "x": "x-thin", "+": "cross-thin", "*": "star", "P": "cross", "X": "x", "_": "line-ew",
}  # fmt: skip


def panels(picture: Any) -> list[Spec]:
    """The panels of a figure, each with its ``title`` as HTML and ``data`` and ``layout`` of plotly.js.

    Raises:
        InputError: when the figure shows something that has no interactive counterpart here.
    """
    picture.draw_without_rendering()  # limits and tick labels are settled by drawing
    return [_panel(axes) for axes in picture.axes if axes.get_label() != "<colorbar>"]


def _panel(axes: Any) -> Spec:
    from matplotlib.collections import LineCollection, PathCollection, PolyCollection, QuadMesh
    from matplotlib.container import BarContainer, ErrorbarContainer
    from matplotlib.image import AxesImage
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle
    from matplotlib.text import Text

    data: list[Spec] = []
    notes: list[Spec] = []
    done: set[int] = set()
    for container in axes.containers:
        if isinstance(container, ErrorbarContainer):
            data += _error_bars(container)
        elif isinstance(container, BarContainer):
            data.append(_bars(container))
        else:
            raise InputError(f"a figure with a {type(container).__name__} has no interactive form")
        done |= {id(artist) for artist in container.get_children()}
    frame = {id(axes.patch), *map(id, axes.spines.values()), *map(id, (axes.xaxis, axes.yaxis))}
    frame |= {id(axes.title), id(axes._left_title), id(axes._right_title)}
    for artist in axes.get_children():
        if id(artist) in done | frame or not artist.get_visible() or artist is axes.get_legend():
            continue
        if isinstance(artist, LineCollection | PolyCollection) and not artist.get_paths():
            continue  # a band of a single run, for example, is empty
        if isinstance(artist, Line2D):
            data.append(_line(axes, artist))
        elif isinstance(artist, PathCollection):
            data.append(_points(artist))
        elif isinstance(artist, QuadMesh | AxesImage):
            data.append(_cells(axes, artist))
        elif isinstance(artist, LineCollection):
            data.append(_segments(artist))
        elif isinstance(artist, PolyCollection):
            data.append(_band(artist, data))
        elif isinstance(artist, Rectangle):
            data.append(_rectangle(axes, artist))
        elif isinstance(artist, Text):
            notes += [_note(axes, artist)] if artist.get_text() else []
        else:
            raise InputError(f"a figure with a {type(artist).__name__} has no interactive form")
    return {"title": markup(_inherited(axes, _title, "colspan")), "data": data, "layout": _layout(axes, data, notes)}


def _layout(axes: Any, data: list[Spec], notes: list[Spec]) -> Spec:
    for name, axis in (("x", axes.xaxis), ("y", axes.yaxis)):
        if axis.get_scale() not in ("linear", "log"):
            _straighten(data, notes, name, axis)
    same = {tuple(trace["x"]) for trace in data if trace["type"] == "scatter" and trace.get("hoverinfo") != "skip"}
    grid = any(trace["type"] == "heatmap" for trace in data)
    return {
        "xaxis": _axis(axes.xaxis, axes.get_xlim(), _inherited(axes, type(axes).get_xlabel, "colspan"), grid),
        "yaxis": _axis(axes.yaxis, axes.get_ylim(), _inherited(axes, type(axes).get_ylabel, "rowspan"), grid),
        "annotations": notes,
        "hovermode": "x unified" if len(same) == 1 else "closest",
        "barmode": "overlay",
    }


def _axis(axis: Any, limits: tuple[float, float], label: str, grid: bool) -> Spec:
    from matplotlib.ticker import FixedFormatter, FuncFormatter

    straight = axis.get_scale() not in ("linear", "log")
    place = axis.get_transform().transform if straight or axis.get_scale() == "log" else np.asarray
    spec: Spec = {
        "title": {"text": markup(label)},
        "type": "log" if axis.get_scale() == "log" else "linear",
        "range": place(np.asarray(limits)).tolist(),
        "showgrid": not grid,
    }
    formatter = axis.get_major_formatter()
    if isinstance(formatter, FixedFormatter | FuncFormatter) or grid or straight:
        low, high = sorted(limits)
        ticks = [t for t in axis.get_major_ticks() if low <= t.get_loc() <= high]
        spec |= {
            "tickvals": [float(place(np.array([t.get_loc()]))[0] if straight else t.get_loc()) for t in ticks],
            "ticktext": [markup(t.label1.get_text()) for t in ticks],
        }
    return spec


def _inherited(axes: Any, read: Callable[[Any], str], along: str) -> str:
    """A text that a grid of panels shows once a column or row; apart from each other, each panel needs it."""
    own, place = read(axes), axes.get_subplotspec()
    if own or place is None:
        return own
    beside = [other for other in axes.figure.axes if (spec := other.get_subplotspec()) is not None
              and getattr(spec, along) == getattr(place, along)]  # fmt: skip
    return next(filter(None, map(read, beside)), "")


def _title(axes: Any) -> str:
    return next(filter(None, map(axes.get_title, ("center", "left", "right"))), "")


def _straighten(data: list[Spec], notes: list[Spec], name: str, axis: Any) -> None:
    """A scale that plotly.js does not have becomes a linear one of moved values; hovering shows the true ones."""

    def moved(values: list[float | None]) -> list[float | None]:
        return _numbers(axis.get_transform().transform(np.array(values, float)))

    for trace in data:
        if trace["type"] != "scatter" or f"error_{name}" in trace:
            raise InputError(f"a figure with such curves on a {axis.get_scale()!r} axis has no interactive form")
        if "hovertemplate" in trace and name == "y":
            trace["text"] = [f"{value:.4g}" if value is not None else "" for value in trace["y"]]
            trace["hovertemplate"] = trace["hovertemplate"].replace("%{y:.4g}", "%{text}")
        trace[name] = moved(trace[name])
    for note in notes:
        if note[f"{name}ref"] == name:
            note[name] = moved([note[name]])[0]


def _line(axes: Any, line: Any) -> Spec:
    x, y = np.asarray(line.get_xdata(orig=False), float), np.asarray(line.get_ydata(orig=False), float)
    across, up = line.get_transform().contains_branch_seperately(axes.transData)
    if not across:
        x, y = np.array(axes.get_xlim()), np.full(2, y[0])
    elif not up:
        x, y = np.full(2, x[0]), np.array(axes.get_ylim())
    trace = _trace(x, y, line.get_label(), _colour(line.get_color(), line.get_alpha()))
    dash = line.get_linestyle()
    marker = _MARKERS.get(str(line.get_marker()))
    drawn = dash not in ("None", " ", "", None)
    trace["mode"] = "+".join(["lines"] * drawn + ["markers"] * (marker is not None)) or "lines"
    if drawn:
        shape = {"steps-post": "hv", "steps-pre": "vh", "steps-mid": "hvh"}.get(line.get_drawstyle(), "linear")
        trace["line"] |= {"width": 1.25 * line.get_linewidth(), "dash": _dash(line), "shape": shape}
    if marker is not None:
        trace["marker"] = {
            "symbol": marker,
            "size": 1.4 * line.get_markersize() * (0.5 if line.get_marker() == "." else 1),
            "color": _colour(line.get_markerfacecolor(), line.get_alpha()),
            "line": {"color": _colour(line.get_markeredgecolor(), line.get_alpha()), "width": 1},
        }
    if not (across and up):
        trace["hoverinfo"] = "skip"
    return trace


def _dash(line: Any) -> str:
    from matplotlib import rcParams

    style = line.get_linestyle()
    _, pattern = line._unscaled_dash_pattern  # every pattern of one's own is called "--" by get_linestyle
    if style != "--" or list(pattern) == rcParams["lines.dashed_pattern"]:
        return _DASHES.get(style, "solid")
    return ",".join(f"{1.25 * line.get_linewidth() * length:g}px" for length in pattern)


def _trace(x: Any, y: Any, label: object, colour: str) -> Spec:
    """A curve; without a label of its own it is not in the legend."""
    named = isinstance(label, str) and label != "" and not label.startswith("_")
    name = markup(str(label)) if named else ""
    value = "%{y:.4g}"
    return {
        "type": "scatter",
        "x": _numbers(x),
        "y": _numbers(y),
        "name": name,
        "meta": {"group": name},
        "line": {"color": colour},
        "hovertemplate": f"{value}<extra>{name}</extra>",
    }


def _error_bars(container: Any) -> list[Spec]:
    """A curve with its bars; bars without points, or at some points only, are a curve of their own."""
    line, _, bars = container
    if line is None:
        return [_segments(collection) for collection in bars]
    trace = _line(line.axes, line)
    label = container.get_label()
    trace |= {
        key: value for key, value in _trace([], [], label, "").items() if key in ("name", "meta", "hovertemplate")
    }
    traces = [trace]
    directions = [name for name, has in (("x", container.has_xerr), ("y", container.has_yerr)) if has]
    for direction, collection in zip(directions, bars, strict=True):
        column = 0 if direction == "x" else 1
        ends = np.array([segment[:, column] for segment in collection.get_segments()])
        middle = np.asarray(line.get_data()[column], float)
        if len(ends) != len(middle):
            traces.append(_segments(collection) | {"meta": trace["meta"], "hoverinfo": "skip"})
            continue
        trace[f"error_{direction}"] = {
            "type": "data",
            "symmetric": False,
            "array": _numbers(ends[:, 1] - middle),
            "arrayminus": _numbers(middle - ends[:, 0]),
            "color": _colour(collection.get_color()[0]),
            "thickness": 1.2,
            "width": 3,
        }
    return traces


def _bars(container: Any) -> Spec:
    boxes = [bar.get_bbox() for bar in container.patches]
    label = container.get_label()
    across = container.orientation == "horizontal"
    trace = _trace([box.x0 + box.width / 2 for box in boxes], [box.y1 for box in boxes], label, "")
    lengths = [box.width if across else box.height for box in boxes]
    return {
        **{key: trace[key] for key in ("name", "meta", "hovertemplate")},
        "type": "bar",
        "orientation": "h" if across else "v",
        "x": lengths if across else trace["x"],
        "y": [box.y0 + box.height / 2 for box in boxes] if across else lengths,
        "base": [box.x0 if across else box.y0 for box in boxes],
        "width": [box.height if across else box.width for box in boxes],
        "marker": {"color": [_colour(bar.get_facecolor()) for bar in container.patches]},
    }


def _points(collection: Any) -> Spec:
    x, y = np.asarray(collection.get_offsets(), float).T
    colours = [_colour(c) for c in collection.get_facecolor()] or [_colour(c) for c in collection.get_edgecolor()]
    trace = _trace(x, y, collection.get_label(), colours[0])
    sizes = 1.4 * np.sqrt(np.asarray(collection.get_sizes(), float))
    trace |= {"mode": "markers", "marker": {
        "color": colours if len(colours) > 1 else colours[0], "size": sizes.tolist() if len(sizes) > 1 else sizes[0],
    }}  # fmt: skip
    return trace


def _segments(collection: Any) -> Spec:
    ends = [np.vstack([segment, [np.nan, np.nan]]) for segment in collection.get_segments()]
    x, y = np.vstack(ends).T
    return _trace(x, y, collection.get_label(), _colour(collection.get_color()[0])) | {"mode": "lines"}


def _band(collection: Any, data: list[Spec]) -> Spec:
    """A filled region; one that was drawn right after a curve of its colour belongs to that curve."""
    colour = _colour(collection.get_facecolor()[0][:3])
    pieces = [np.vstack([path.vertices, [np.nan, np.nan]]) for path in collection.get_paths()]
    x, y = np.vstack(pieces).T
    trace = _trace(x, y, collection.get_label(), "rgba(0,0,0,0)")
    trace |= {"mode": "lines", "fill": "toself", "fillcolor": _colour(collection.get_facecolor()[0])}
    trace |= {"hoverinfo": "skip", "line": {"width": 0}}
    del trace["hovertemplate"]
    owner = data[-1] if data else None
    if not trace["name"] and owner is not None and owner.get("line", {}).get("color") == colour:
        trace["meta"] = owner["meta"]
        _tell_interval(owner, x, y)
    return trace


def _tell_interval(curve: Spec, x: Any, y: Any) -> None:
    """Let hovering over a curve show its band too."""
    inside = [y[np.isclose(x, at, rtol=1e-12, atol=0)] for at in curve["x"] if at is not None]
    if len(inside) == len(curve["x"]) and all(len(values) >= 2 for values in inside):
        curve["customdata"] = [[float(v.min()), float(v.max())] for v in inside]
        curve["hovertemplate"] = (
            f"%{{y:.4g}} (%{{customdata[0]:.4g}} to %{{customdata[1]:.4g}})<extra>{curve['name']}</extra>"
        )


def _rectangle(axes: Any, patch: Any) -> Spec:
    box = patch.get_bbox()
    across, up = patch.get_transform().contains_branch_seperately(axes.transData)
    x0, x1 = (box.x0, box.x1) if across else axes.get_xlim()
    y0, y1 = (box.y0, box.y1) if up else axes.get_ylim()
    trace = _trace([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], patch.get_label(), "rgba(0,0,0,0)")
    trace |= {"mode": "lines", "fill": "toself", "fillcolor": _colour(patch.get_facecolor()), "hoverinfo": "skip"}
    edge = _colour(patch.get_edgecolor())
    trace["line"] = {"color": edge, "width": patch.get_linewidth()}
    return trace


def _cells(axes: Any, mesh: Any) -> Spec:
    from matplotlib.collections import QuadMesh

    values: Any = np.ma.filled(np.ma.asarray(mesh.get_array(), dtype=float), np.nan)
    x: Any
    y: Any
    kind: type = type(mesh)  # kept apart from mesh, whose stubs say too little
    if issubclass(kind, QuadMesh):
        corners = mesh.get_coordinates()
        values = values.reshape(corners.shape[0] - 1, corners.shape[1] - 1)
        x, y = corners[0, :, 0], corners[:, 0, 1]
    else:
        left, right, bottom, top = mesh.get_extent()
        if mesh.origin == "upper":
            bottom, top = top, bottom
        x = np.linspace(left, right, values.shape[1] + 1)
        y = np.linspace(bottom, top, values.shape[0] + 1)
    if values.ndim != 2:
        raise InputError("a figure with cells that are coloured by hand has no interactive form")
    bar = mesh.colorbar
    spec: Spec = {
        "type": "heatmap",
        "x": x.tolist(),
        "y": y.tolist(),
        "z": [_numbers(row) for row in np.ma.filled(mesh.norm(values).astype(float), np.nan)],
        "customdata": [_numbers(row) for row in values],
        "zmin": 0,
        "zmax": 1,
        "colorscale": [[float(p), _colour(mesh.cmap(p))] for p in np.linspace(0, 1, 33)],
        "showscale": bar is not None,
        "meta": {"group": ""},
        "hovertemplate": "%{customdata:.4g}<extra></extra>",
    }
    if bar is not None:
        spec["meta"]["colour"] = markup(bar.ax.get_ylabel() or bar.ax.get_xlabel())
        axis = bar.ax.yaxis if bar.orientation == "vertical" else bar.ax.xaxis
        ticks = [t for t in axis.get_major_ticks() if mesh.norm.vmin <= t.get_loc() <= mesh.norm.vmax]
        spec["colorbar"] = {
            "tickvals": [float(mesh.norm(t.get_loc())) for t in ticks],
            "ticktext": [markup(t.label1.get_text() or t.label2.get_text()) for t in ticks],
            "thickness": 14,
        }
    return spec


def _note(axes: Any, text: Any) -> Spec:
    x, y = text.get_position()
    across, up = text.get_transform().contains_branch_seperately(axes.transData)
    if hasattr(text, "xy"):
        if text.xycoords != "data" or text.anncoords not in ("data", "offset points"):
            raise InputError(f"a figure with a note in {text.xycoords!r} coordinates has no interactive form")
        shift = (x, y) if text.anncoords == "offset points" else (0, 0)
        x, y = text.xy if text.anncoords == "offset points" else (x, y)
        across = up = True
    else:
        shift = (0, 0)
    x = np.log10(x) if across and axes.get_xscale() == "log" else x
    y = np.log10(y) if up and axes.get_yscale() == "log" else y
    return {
        "text": markup(text.get_text()).replace("\n", "<br>"),
        "x": float(x),
        "y": float(y),
        "xref": "x" if across else "x domain",
        "yref": "y" if up else "y domain",
        "xshift": shift[0],
        "yshift": shift[1],
        "xanchor": text.get_ha(),
        "yanchor": {"center": "middle", "baseline": "bottom", "center_baseline": "middle"}.get(
            text.get_va(), text.get_va()
        ),
        "showarrow": False,
        "textangle": -text.get_rotation(),
        "font": {"color": _colour(text.get_color(), text.get_alpha()), "size": max(11, 1.35 * text.get_fontsize())},
    }


def _colour(colour: Any, alpha: float | None = None) -> str:
    from matplotlib.colors import to_rgba

    red, green, blue, opacity = to_rgba(colour, alpha)
    return f"rgba({round(255 * red)},{round(255 * green)},{round(255 * blue)},{opacity:.3g})"


def _numbers(values: Any) -> list[float | None]:
    """Numbers for JSON, which knows neither nan nor infinity."""
    return [float(v) if np.isfinite(v) else None for v in np.asarray(values, float)]
