"""The design of a sweep: its points, made from the values of its axes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, SupportsFloat, TypedDict

from drillsweep.units import is_pint
from drillsweep.values import Value, entry, inside, to_json

Design = Literal["grid", "zip", "list", "latin_hypercube", "sobol"]
"""Ways of making points from axes."""

Scale = Literal["linear", "log"]
"""Spacing of the values of a range."""


@dataclass(frozen=True)
class Range:
    """`count` values from `start` to `stop`, both ends included and exact; the service forms them.

    Without a count it is the interval from which the designs `latin_hypercube` and `sobol` draw.
    """

    start: Value
    stop: Value
    count: int | None = None
    scale: Scale = "linear"

    def to_json(self) -> dict[str, Any]:
        """The range as the service takes it."""
        axis = {"from": self.start, "to": self.stop, "count": self.count, "scale": self.scale}
        return {name: value for name, value in axis.items() if value is not None}


class AxisValues(TypedDict):
    """Listed values, as the service takes them."""

    values: Sequence[float | str]


_Ends = TypedDict("_Ends", {"from": float | str, "to": float | str})


class AxisRange(_Ends, total=False):
    """A range, as the service takes it."""

    count: int
    scale: Scale


Axis = (
    Range | AxisValues | AxisRange | Iterable[SupportsFloat] | list[str] | list[float | str] | tuple[float | str, ...]
)
"""The values of one parameter: a range, any list or array of values, or the service's own JSON."""


def axes_to_json(axes: Mapping[str, Axis] | None) -> dict[str, Any] | None:
    """Axes by name as the service takes them.

    Raises:
        ValueError: A value is NaN or infinite.
        TypeError: An axis is no range and no list of numbers.
    """
    return None if axes is None else {name: _axis_to_json(axis, inside("/axes", name)) for name, axis in axes.items()}


def design_to_json(
    design: Design | None,
    samples: int | None,
    seed: int | None,
    skip: int | None,
    points: Iterable[Mapping[str, Value]] | None,
) -> dict[str, Any]:
    """A design as the service takes it; None stands for the service's default.

    Raises:
        ValueError: A value of a point is NaN or infinite.
        TypeError: A value of a point is no number.
    """
    listed = None if points is None else [_point_to_json(point, index) for index, point in enumerate(points)]
    if listed is not None and design is None:
        design = "list"
    return {"design": design, "samples": samples, "seed": seed, "skip": skip, "points": listed}


def _axis_to_json(axis: Axis, pointer: str) -> dict[str, Any]:
    if isinstance(axis, Range):
        ends = {"from": entry(axis.start, inside(pointer, "from")), "to": entry(axis.stop, inside(pointer, "to"))}
        return axis.to_json() | ends
    if isinstance(axis, Mapping):
        return dict(to_json(axis, pointer))
    if isinstance(axis, str | bytes) or not isinstance(axis, Iterable) or getattr(axis, "ndim", 1) == 0:
        raise TypeError(f"{pointer}: must be a Range, or a list or an array of numbers (got {axis!r})")
    listed = inside(pointer, "values")
    if is_pint(axis):
        return {"values": to_json(axis, listed)}
    return {"values": [entry(value, inside(listed, index)) for index, value in enumerate(axis)]}


def _point_to_json(point: Mapping[str, Value], index: int) -> dict[str, float | str]:
    pointer = inside("/points", index)
    return {name: entry(value, inside(pointer, name)) for name, value in point.items()}
