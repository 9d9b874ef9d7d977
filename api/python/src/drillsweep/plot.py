"""Pictures of results with matplotlib: `pip install 'drillsweep[plot]'`.

Every function draws into `axes`, or into new ones, and returns them; a history has panels of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, SupportsFloat

from drillsweep.optional import require
from drillsweep.point import Point, SpectrumWindow, TimeWindow
from drillsweep.quantity import Unit, quantity
from drillsweep.values import Limits

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from drillsweep.sweep import Sweep

PALETTE = ("#0072b2", "#d55e00", "#009e73", "#b5568c", "#b57b00", "#56b4e9")
"""Colours of lines, those of the web page: for colour-blind readers too (after Okabe and Ito)."""
DASHES = ("-", "--", ":", "-.", (0, (8, 4)), (0, (8, 4, 1, 4)))
"""Dashes that go with them, so that lines differ by more than colour."""


def orbit(
    point: Point,
    *,
    node: int | None = None,
    depth: SupportsFloat | None = None,
    nearest: bool = False,
    time: TimeWindow = (None, None),
    axes: Axes | None = None,
) -> Axes:
    """The orbit of a node as seen looking downhole, the low side down, with the circle that the wall leaves to it.

    The circle's radius is the node's clearance: a node on it touches the wall. Forward whirl, with the rotation of
    the string, goes clockwise. In a vertical hole, which has no low side, the frame's first axis points down.
    """
    np = require("numpy", "plot")
    table = point.orbit(node=node, depth=depth, nearest=nearest, time=time)
    number = int(table.attributes["node"])
    statics = point.statics()
    row = statics.columns["node"].index(number)
    clearance = float(statics.columns["clearance"][row])
    low_side = float(statics.columns["low_side_angle"][row])
    # Along the low side, and a quarter turn on from it in the sense of rotation (from e1 towards e2).
    down = table["u"] * np.cos(low_side) + table["v"] * np.sin(low_side)
    across = table["v"] * np.cos(low_side) - table["u"] * np.sin(low_side)
    axes = axes or _new_axes()
    # Clockwise on the picture: from the bottom to the left.
    shown = _shown("radius")
    axes.plot(-shown.of(across), -shown.of(down), linewidth=0.6, color=PALETTE[0])
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    radius = shown.of(clearance)
    axes.plot(radius * np.cos(angle), radius * np.sin(angle), color="black", linewidth=1.0)
    axes.set_aspect("equal")
    axes.set_xlabel(f"across the hole [{shown.symbol}]")
    axes.set_ylabel(f"from the low side up [{shown.symbol}]")
    axes.set_title(f"Orbit of node {number} at {table.attributes['measured_depth']:.2f} m")
    return axes


def history(
    point: Point,
    *,
    node: int | None = None,
    depth: SupportsFloat | None = None,
    nearest: bool = False,
    time: TimeWindow = (None, None),
) -> list[Axes]:
    """The motion of the recorded nodes, or of one, over time, and below it the rotation at the bit; one axes a panel.

    u and v are in the first panel. If the string twists, rotation speed and torque follow: those of the requested node,
    or else of the bit, from the history or the snapshots. If neither has the bit, they are those of the lowest recorded
    node, and the title names it.
    """
    table = point.history(node=node, depth=depth, nearest=nearest, time=time)
    is_one = node is not None or depth is not None or nearest
    lowest = max((int(name.rsplit("_", 1)[1]) for name in table if name.startswith("rotation_speed_")), default=None)
    bit = int(point.statics()["node"][-1])
    bit_depth = float(point.statics()["measured_depth"][-1])
    rotation, title = table, "Rotation at the bit"
    columns = {name: f"{name}_{lowest}" for name in ("rotation_speed", "torque") if lowest is not None}
    if is_one:
        title = f"Rotation of node {lowest}"
    elif lowest != bit and "snapshots" in point.tables:
        rotation = point.snapshots(node=bit, time=time)
        columns = {name: name for name in ("rotation_speed", "torque") if name in rotation}
    elif lowest != bit:
        title = f"Rotation of node {lowest}: at the bit, at {bit_depth:.1f} m, it was not recorded"
    panels = require("matplotlib.pyplot", "plot").subplots(
        1 + len(columns), squeeze=False, layout="constrained", figsize=(8.0, 3.0 + 2.2 * len(columns))
    )[1]
    axes: list[Axes] = list(panels[:, 0])
    shown = _shown("radius")
    lateral = [name for name in table if name.startswith(("u_", "v_")) and "rate" not in name]
    for order, name in enumerate(lateral):
        axes[0].plot(table["time"], shown.of(table[name]), linewidth=0.6, label=_name(name), **_style(order))
    axes[0].set_ylabel(f"displacement [{shown.symbol}]")
    axes[0].legend(fontsize="small")
    for order, (panel, (name, column)) in enumerate(zip(axes[1:], columns.items(), strict=True)):
        panel.plot(rotation["time"], _shown(name).of(rotation[column]), linewidth=0.8, color=PALETTE[order])
        panel.set_ylabel(_title(name))
    if len(axes) > 1:
        axes[1].set_title(title)
    axes[-1].set_xlabel(_title("time"))
    return axes


def spectrum(
    point: Point,
    *,
    node: int | None = None,
    depth: SupportsFloat | None = None,
    nearest: bool = False,
    time: TimeWindow = (None, None),
    window: SpectrumWindow | None = None,
    range_hz: SupportsFloat | None = None,
    peaks: int = 5,
    axes: Axes | None = None,
) -> Axes:
    """The full spectrum of a node's orbit, its highest lines labelled; backward whirl is left of zero.

    The line at zero, the mean position, is left out: it would dwarf the others. Frequencies that the run's steps do not
    resolve are shaded, and lines there have no label.
    """
    np = require("numpy", "plot")
    table = point.spectrum(
        node=node, depth=depth, nearest=nearest, time=time, window=window, range_hz=range_hz, peaks=peaks + 1
    )
    # As wide as the line that any window makes of a mean.
    is_mean = np.abs(table["frequency"]) < 2.5 * table.attributes["resolution"]
    shown = _shown("amplitude")
    amplitude = np.where(is_mean, np.nan, shown.of(table["amplitude"]))
    axes = axes or _new_axes()
    axes.plot(table["frequency"], amplitude, linewidth=0.8, color=PALETTE[0])
    resolved = table.attributes.get("resolved_hz")
    last = np.max(np.abs(table["frequency"]))
    if resolved is not None and resolved < last:
        label = f"not resolved by the steps (beyond ±{resolved:.3g} Hz)"
        axes.axvspan(resolved, last, color=PALETTE[1], alpha=0.15, linewidth=0, label=label)
        axes.axvspan(-last, -resolved, color=PALETTE[1], alpha=0.15, linewidth=0)
        axes.legend(fontsize="small")
    lines = [peak for peak in table.attributes["peaks"] if peak["whirl"] != "offset" and peak.get("is_resolved", True)]
    for line in lines[:peaks]:
        side = "right" if line["frequency"] < 0.0 else "left"
        place: dict[str, Any] = {"textcoords": "offset points", "xytext": (0, 3), "ha": side, "fontsize": "small"}
        # A line between two bins is higher than the curve; its name stands on the curve.
        near = np.abs(table["frequency"] - line["frequency"]) <= table.attributes["resolution"]
        axes.annotate(f"{line['frequency']:+.2f} Hz", (line["frequency"], np.max(amplitude[near])), **place)
    axes.axvline(0.0, color="black", linewidth=0.5)
    axes.set_xlabel("frequency [Hz], backward - and forward + whirl")
    axes.set_ylabel(_title("amplitude"))
    axes.set_title(f"Full spectrum of node {table.attributes['node']} at {table.attributes['measured_depth']:.2f} m")
    return axes


def profile(
    points: Point | Iterable[Point],
    column: str = "friction_coefficient",
    *,
    axes: Axes | None = None,
) -> Axes:
    """A column of the profile over measured depth, downwards, C_f unless given; one line a point."""
    axes = axes or _new_axes()
    lines = [points] if isinstance(points, Point) else list(points)
    shown = _shown(column)
    np = require("numpy", "plot")
    for number, point in enumerate(lines):
        table = point.profile()
        # Values belong to elements: steps over the elements' ends.
        depth = np.stack([table["measured_depth_top"], table["measured_depth_bottom"]], axis=1).ravel()
        values = shown.of(table[column]).repeat(2)
        axes.plot(values, depth, linewidth=0.9, label=_label(point.parameters), **_style(number))
    axes.invert_yaxis()
    axes.set_xlabel(_title(column))
    axes.set_ylabel(_title("measured_depth"))
    if len(axes.lines) > 1:
        axes.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return axes


def window(
    sweep: Sweep,
    x: str | None = None,
    y: str | None = None,
    *,
    limits: Limits | None = None,
    axes: Axes | None = None,
) -> Axes:
    """The operating window: the class of each point over two parameters, in the colours of the web page.

    The parameters are the first two that vary, unless given; over a single one the points are in a row. Points whose
    class is uncertain are hollow.
    """
    np = require("numpy", "plot")
    table = sweep.window(limits)
    others = {"ordinal", "class", "class_uncertain", "sentence"}
    varied = [name for name in table if name not in others and len(set(table.columns[name])) > 1]
    across, up = ([x] if x else []) + [name for name in varied if name != y], ([y] if y else []) + varied
    x = across[0] if across else "ordinal"
    y = next((name for name in up if name != x), None)
    xs = np.asarray(_shown(x).of(np.asarray(table.columns[x], dtype=float)))
    ys = np.zeros_like(xs) if y is None else np.asarray(_shown(y).of(np.asarray(table.columns[y], dtype=float)))
    known = quantity("class")
    axes = axes or _new_axes()
    for word, colour in (known.words if known else {}).items():
        for is_uncertain in (False, True):
            rows = [
                row
                for row, (name, reason) in enumerate(
                    zip(table.columns["class"], table.columns["class_uncertain"], strict=True)
                )
                if name == word and bool(reason) == is_uncertain
            ]
            if rows:
                label = f"{word.replace('_', ' ')}{', uncertain' if is_uncertain else ''}: {len(rows)}"
                style: dict[str, Any] = {
                    "facecolors": "none" if is_uncertain else colour,
                    "edgecolors": colour,
                    "linewidths": 1.5,
                }
                axes.scatter(xs[rows], ys[rows], s=60.0, label=label, **style)
    axes.set_xlabel(_title(x))
    if y is None:
        axes.set_yticks([])
    else:
        axes.set_ylabel(_title(y))
    axes.legend(fontsize="small")
    return axes


def _shown(column: str) -> Unit:
    known = quantity(column)
    return known.shown if known else Unit("", 1.0)


def _name(column: str) -> str:
    """Name of a column on the page, such as `u, node 49` or `lateral vibration at 57.7 m`."""
    known = quantity(column)
    if known is None:
        return column.replace("_", " ")
    place = None if "." in column else re.fullmatch(rf"{known.name}_(?:(\d+)|(\d+(?:_\d+)?)m)", column)
    if place is None:
        return known.label
    node, depth = place.groups()
    return f"{known.label}, node {node}" if node else f"{known.label} at {depth.replace('_', '.')} m"


def _title(column: str) -> str:
    """The same with its unit in brackets, for an axis."""
    symbol = _symbol(_shown(column))
    return f"{_name(column)} [{symbol}]" if symbol else _name(column)


def _symbol(unit: Unit) -> str:
    """A unit as the page writes it, such as `kg/m³`; empty for ratios."""
    raised = re.sub(r"(?<=[A-Za-z])[23]", lambda power: {"2": "\u00b2", "3": "\u00b3"}[power[0]], unit.symbol)
    return "" if raised == "1" else "\u00b0" if raised == "deg" else raised.replace(" ", "\u00b7")


def _style(order: int) -> dict[str, Any]:
    """Colour and dashes of one of several lines."""
    return {"color": PALETTE[order % len(PALETTE)], "linestyle": DASHES[order % len(DASHES)]}


def _label(parameters: dict[str, float]) -> str:
    """A point by its parameters, in the units shown."""
    return ", ".join(
        f"{_name(name)} {_shown(name).of(value):g} {_symbol(_shown(name))}".rstrip()
        for name, value in parameters.items()
    )


def _new_axes() -> Any:
    pyplot = require("matplotlib.pyplot", "plot")
    return pyplot.subplots(layout="constrained")[1]
