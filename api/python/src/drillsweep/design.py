"""What a sweep asks for: its points, made from the values of its axes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, SupportsFloat


@dataclass(frozen=True)
class Range:
    """`count` values from `start` to `stop`, both ends included and exact; the service forms them.

    Without a count it is the interval from which the designs `latin_hypercube` and `sobol` draw.
    """

    start: float
    stop: float
    count: int | None = None
    scale: Literal["linear", "log"] = "linear"

    def to_json(self) -> dict[str, Any]:
        """The range as the service takes it."""
        axis = {"from": self.start, "to": self.stop, "count": self.count, "scale": self.scale}
        return {name: value for name, value in axis.items() if value is not None}


Axis = Range | Mapping[str, Any] | Iterable[SupportsFloat]
"""The values of one parameter: a range, any list or array of numbers, or the service's own JSON."""


def axis_to_json(axis: Axis) -> dict[str, Any]:
    """An axis as the service takes it."""
    if isinstance(axis, Range):
        return axis.to_json()
    if isinstance(axis, Mapping):
        return dict(axis)
    return {"values": [float(value) for value in axis]}


def axes_to_json(axes: Mapping[str, Axis] | None) -> dict[str, Any] | None:
    """Axes by name as the service takes them."""
    return None if axes is None else {name: axis_to_json(axis) for name, axis in axes.items()}


def design_to_json(
    design: str | None,
    samples: int | None,
    seed: int | None,
    points: Iterable[Mapping[str, SupportsFloat]] | None,
) -> dict[str, Any]:
    """How points are made, as the service takes it; what is None says nothing."""
    listed = None if points is None else [{name: float(value) for name, value in point.items()} for point in points]
    if listed is not None and design is None:
        design = "list"
    return {"design": design, "samples": samples, "seed": seed, "points": listed}
