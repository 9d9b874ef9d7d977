"""What a sweep asks for: the values of its axes."""

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
