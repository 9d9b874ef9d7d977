"""The request of a sweep or a run, as the service takes it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, TypedDict

from drillsweep.design import Axis, axes_to_json
from drillsweep.values import texts, to_json

Cache = Literal["reuse", "refresh", "only"]
"""Uses of results that are stored already."""

AccuracyPreset = Literal["draft", "standard", "reference"]
"""Named accuracies."""


class StatisticsTarget(TypedDict):
    """A bound on the relative error of statistics."""

    statistics: float


class TrajectoryTarget(TypedDict):
    """A bound on the relative error of histories."""

    trajectory: float


class _Method(TypedDict):
    integrator: Literal["esdirk4", "generalized_alpha", "rk4"]
    step: float


class TimeStepping(_Method, total=False):
    """An integrator and its step [s], in full."""

    contact_sweeps: int
    spectral_radius: float | None
    tolerance: float | None


Accuracy = AccuracyPreset | StatisticsTarget | TrajectoryTarget | TimeStepping
"""The resolution of time: a preset, a bound on the error, or integrator and step."""


class NumberedNode(TypedDict):
    """A node by its number, 1 at the top."""

    node: int


class NodeAtDepth(TypedDict):
    """The node nearest to a measured depth [m]."""

    depth: float


OrbitWindow = TypedDict("OrbitWindow", {"from": float, "to": float})
"""A half-open window of time [s]."""


class OrbitOutputs(TypedDict, total=False):
    """The part of the histories that is stored."""

    nodes: Sequence[NumberedNode | NodeAtDepth] | None
    window: OrbitWindow | None
    decimation: int


class Orbits(TypedDict):
    """Histories stored in part."""

    orbits: OrbitOutputs


Outputs = Literal["summary", "spectra", "full"] | Orbits
"""Stored outputs of each point."""


def request_to_json(
    preset: str | None,
    scenario: Mapping[str, Any] | None,
    changes: Mapping[str, Any] | None,
    accuracy: Accuracy | None,
    axes: Mapping[str, Axis] | None,
    tags: Iterable[str] | None,
    **fields: Any,
) -> dict[str, Any]:
    """The body of a request; fields that are None are left out.

    Raises:
        ValueError: A number is NaN or infinite, or the accuracy is given twice.
        TypeError: A value cannot be that of its field.
    """
    if accuracy is not None:
        if "accuracy" in (changes or {}):
            raise ValueError("/set/accuracy: the argument `accuracy` gives it too")
        changes = {**(changes or {}), "accuracy": accuracy}
    body = {
        "preset": preset,
        "scenario": scenario,
        "set": changes,
        "axes": axes_to_json(axes),
        "tags": None if tags is None else texts(tags, "/tags"),
        **fields,
    }
    return dict(to_json({field: value for field, value in body.items() if value is not None}))
