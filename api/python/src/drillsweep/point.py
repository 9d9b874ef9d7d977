"""One point of a sweep and its results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat

from drillsweep.report import Reported
from drillsweep.table import Table
from drillsweep.values import Limits, in_query, limits_text

if TYPE_CHECKING:
    from drillsweep.client import Client

PointState = Literal["queued", "running", "succeeded", "failed", "cancelled"]
"""States of a point."""

FailureClass = Literal["physical", "infrastructure", "crash", "timeout", "cancelled", "outdated"]
"""Kinds of failure that end a point."""

Decimation = Literal["stride", "minmax"]
"""Choices of the rows that stay of a longer history."""

SpectrumWindow = Literal["rectangular", "hann"]
"""Weights of the samples before a Fourier transform."""

TimeWindow = tuple[SupportsFloat | None, SupportsFloat | None]
"""Start (included) and end (not included) of a window [s]; None is open."""


@dataclass(frozen=True)
class PointError:
    """Reason for a point without a result."""

    kind: str
    """The class of failure: physical, infrastructure, crash, timeout, cancelled or outdated."""
    reason: str
    """Explanation in words."""
    time: float | None = None
    """Simulated time at which it happened [s]."""
    node: int | None = None
    """Node at which it happened, 1 at the top."""


class Point(Reported):
    """One point of a sweep: its state and its result."""

    def __init__(self, client: Client, data: Mapping[str, Any]) -> None:
        """A point as the service returned it, in a list or in full."""
        self._client = client
        self._data = dict(data)
        self._statics: Table | None = None

    @property
    def ordinal(self) -> int:
        """Number in its sweep, from 1."""
        return int(self._data["ordinal"])

    @property
    def state(self) -> str:
        """One of `queued`, `running`, `succeeded`, `failed`, `cancelled`."""
        return str(self._data["state"])

    @property
    def parameters(self) -> dict[str, float]:
        """The swept parameters, by axis."""
        return dict(self._data["parameters"])

    @property
    def progress(self) -> float:
        """Simulated time over duration, 0 to 1."""
        return float(self._data["progress"])

    @property
    def attempts(self) -> int:
        """Number of attempts: how often a worker has started it."""
        return int(self._data["attempts"])

    @property
    def error(self) -> PointError | None:
        """Reason of its failure; None unless it failed."""
        error = self._data.get("error")
        if error is None:
            return None
        return PointError(error["class"], error["reason"], error.get("time"), error.get("node"))

    @property
    def key(self) -> str:
        """Content hash of scenario and physics version: equal keys, equal results."""
        return str(self._detail("key"))

    @property
    def scenario(self) -> dict[str, Any]:
        """The scenario as simulated: preset, changes and axes applied."""
        return dict(self._detail("scenario"))

    @property
    def summary(self) -> dict[str, Any] | None:
        """The scalar results, as in the sweep's table; None without a result."""
        return self._detail("summary")  # type: ignore[no-any-return]

    @property
    def provenance(self) -> dict[str, Any] | None:
        """Code, machine and cost of its computation; None without a result."""
        return self._detail("provenance")  # type: ignore[no-any-return]

    @property
    def tables(self) -> list[str]:
        """Names of the tables that the run produced."""
        return list(self._detail("tables"))

    @property
    def path(self) -> str:
        """Its path on the server."""
        return str(self._data["links"]["self"])

    def refresh(self) -> Point:
        """Updates its state from the server."""
        self._data = self._client.get_json(self.path)
        return self

    def profile(self) -> Table:
        """Geometry, hydraulics and forces of every element at the equilibrium, from the top down.

        Among the columns: `measured_depth_top`, `eccentricity`, `friction_coefficient` (C_f), `apparent_viscosity`,
        `regime`, `annulus_pressure`, `bore_pressure`, `effective_tension`, `torque`.
        """
        return self.view("profile")

    def statics(self) -> Table:
        """The static equilibrium, node by node."""
        if self._statics is None:
            self._statics = self.view("statics")
        return self._statics

    def history(
        self,
        *,
        node: int | None = None,
        depth: SupportsFloat | None = None,
        nearest: bool = False,
        time: TimeWindow = (None, None),
        max_points: int | None = None,
        decimation: Decimation | None = None,
        units: str | None = None,
    ) -> Table:
        """The recorded motion of one node, or of all: `time`, and `u_N`, `v_N`, ..., `torque_N` for node N.

        Args:
            node: A recorded node, 1 at the top; with neither this nor `depth` all of them.
            depth: Measured depth [m] of a recorded node, to within half an element.
            nearest: Take the recorded node nearest to `depth`, however far.
            time: Window [s].
            max_points: Largest number of rows.
            decimation: Choice of the rows of a longer history: `stride` (the default), every k-th; `minmax`, those with
                the extremes of each column.
            units: Units of the columns: `"si"`, `"field"`, or `"field,u:mm"`; None means the kept units.
        """
        query = {"max_points": max_points, "decimation": decimation, "units": units}
        return self.view("history", **_node_window(node, depth, nearest, time), **query)

    def statistics(
        self,
        *,
        node: int | None = None,
        depth: SupportsFloat | None = None,
        nearest: bool = False,
        time: TimeWindow = (None, None),
        units: str | None = None,
    ) -> Table:
        """Sizes of orbits over a window: a row for one node, or for each recorded one.

        Columns: `orbit_radius_rms`, `orbit_mean_radius`, `orbit_radius_deviation`, `orbit_largest_radius`,
        `orbit_smallest_radius`, `orbit_offset`, `peak_to_peak_u`, `peak_to_peak_v`; in `units` as of `history`.
        """
        return self.view("statistics", **_node_window(node, depth, nearest, time), units=units)

    def orbit(
        self,
        *,
        node: int | None = None,
        depth: SupportsFloat | None = None,
        nearest: bool = False,
        time: TimeWindow = (None, None),
        max_points: int | None = None,
        units: str | None = None,
    ) -> Table:
        """The path of a recorded node across the hole: `time`, `u`, `v`, `radius`.

        Args:
            node: A recorded node, 1 at the top; either this or `depth`.
            depth: Measured depth [m] of a recorded node, to within half an element.
            nearest: Take the recorded node nearest to `depth`, however far.
            time: Window [s].
            max_points: Largest number of rows; the extremes stay.
            units: Units of the columns: `"si"`, `"field"`, or `"field,u:mm"`; None means the kept units.
        """
        return self.view("orbit", **_node_window(node, depth, nearest, time), max_points=max_points, units=units)

    def spectrum(
        self,
        *,
        node: int | None = None,
        depth: SupportsFloat | None = None,
        nearest: bool = False,
        time: TimeWindow = (None, None),
        window: SpectrumWindow | None = None,
        range_hz: SupportsFloat | None = None,
        peaks: int | None = None,
        units: str | None = None,
    ) -> Table:
        """The full spectrum of a node's orbit: `frequency` (positive is forward whirl), `amplitude`, `peak_to_peak`.

        The highest lines are in `attributes["peaks"]`, their frequency and amplitude interpolated between the bins. The
        run's steps resolve vibrations up to `attributes["resolved_hz"]` [Hz]; `is_resolved` of a line compares with it.

        Args:
            node: A recorded node, 1 at the top; either this or `depth`.
            depth: Measured depth [m] of a recorded node, to within half an element.
            nearest: Take the recorded node nearest to `depth`, however far.
            time: Window [s].
            window: Weighting of the samples, `hann` or `rectangular`.
            range_hz: Frequencies from minus to plus this [Hz].
            peaks: Largest number of peaks in the list, the highest first.
            units: Units of the columns: `"si"`, `"field"`, or `"field,u:mm"`; None means the kept units.
        """
        query = {"window": window, "range_hz": range_hz, "peaks": peaks, "units": units}
        return self.view("spectrum", **_node_window(node, depth, nearest, time), **query)

    def spectrogram(
        self,
        *,
        node: int | None = None,
        depth: SupportsFloat | None = None,
        nearest: bool = False,
        time: TimeWindow = (None, None),
        window_s: SupportsFloat | None = None,
        step_s: SupportsFloat | None = None,
        window: SpectrumWindow | None = None,
        range_hz: SupportsFloat | None = None,
        units: str | None = None,
    ) -> Table:
        """The full spectrum of a node's orbit over time: `time`, `frequency` (positive is forward whirl), `amplitude`.

        Window after window, whose middle is `time`; `attributes["windows"]` is their number.

        Args:
            node: A recorded node, 1 at the top; either this or `depth`.
            depth: Measured depth [m] of a recorded node, to within half an element.
            nearest: Take the recorded node nearest to `depth`, however far.
            time: Window [s] of the whole spectrogram.
            window_s: Length of each window [s].
            step_s: From the beginning of a window to that of the next [s].
            window: Weighting of the samples in each window, `hann` or `rectangular`.
            range_hz: Frequencies from minus to plus this [Hz].
            units: Units of the columns: `"si"`, `"field"`, or `"field,u:mm"`; None means the kept units.
        """
        query = {"window_s": window_s, "step_s": step_s, "window": window, "range_hz": range_hz, "units": units}
        return self.view("spectrogram", **_node_window(node, depth, nearest, time), **query)

    def snapshots(
        self,
        *,
        node: int | None = None,
        time: TimeWindow = (None, None),
        max_frames: int | None = None,
        fields: Sequence[str] | None = None,
        units: str | None = None,
    ) -> Table:
        """Snapshots of the whole string, if the scenario requests them (`recording.snapshots`).

        A row a node, from the top, snapshot after snapshot: `time`, `node`, `u`, `v`, `normal_force`, and of axial
        motion and torsion, if the run solves for them, `w`, `theta_z`, `rotation_speed`, `torque`. A column as an array
        of snapshots by nodes: `table["u"].reshape(-1, table.attributes["nodes"])`.

        Args:
            node: Only this node, 1 at the top.
            time: Window [s].
            max_frames: Largest number of snapshots; every k-th stays.
            fields: Only these columns.
            units: Units of the columns: `"si"`, `"field"`, or `"field,u:mm"`; None means the kept units.
        """
        names = ",".join(fields) if fields is not None else None
        query = {"node": node, "max_frames": max_frames, "fields": names, "units": units}
        return self.view("snapshots", **{"from": time[0], "to": time[1]}, **query)

    def lines(self, *, units: str | None = None) -> Table:
        """Strongest spectral lines of the recorded nodes; `diagnosis` names their causes."""
        return self.view("lines", units=units)

    def contacts(self, *, units: str | None = None) -> Table:
        """Contacts of every node with the hole over the run."""
        return self.view("contacts", units=units)

    def loads(self, *, units: str | None = None) -> Table:
        """Loads of every node over the window of the statistics: accelerations, whirl, stick-slip, stresses."""
        return self.view("loads", units=units)

    def energy(self, *, units: str | None = None) -> Table:
        """The energy ledger over the run."""
        return self.view("energy", units=units)

    def course(self, *, units: str | None = None) -> Table:
        """Motion over the whole of a run that ends once it has settled, at 20 Hz at most."""
        return self.view("course", units=units)

    def diagnosis(self, limits: Limits | None = None, *, units: str | None = None) -> dict[str, Any]:
        """Class of the motion by limits, and causes of the spectral lines.

        Args:
            limits: Changes of the service's limits, by column, as numbers in the column's unit or
                with a unit; None removes one.
            units: Units of evidence, limits, depths and amplitudes, as of `history`; the answer names them in `units`.
        """
        return self._client.get_json(f"{self.path}/diagnosis", {"limits": limits_text(limits), "units": units})

    def cost(self, *, units: str | None = None) -> dict[str, Any]:
        """Cost of accuracy, if the scenario has a `cost_study`; depths and values in `units` as of `diagnosis`."""
        return self._client.get_json(f"{self.path}/cost", {"units": units})

    def plan(self) -> dict[str, Any]:
        """Plan of its scenario: every effect with the reason for it, mesh, steps and processor times."""
        return self._client.get_json(f"{self.path}/plan")

    def modes(self, *, to_hz: SupportsFloat | None = None, units: str | None = None) -> dict[str, Any]:
        """The modes of vibration about the equilibrium up to a frequency [Hz] (20 unless given, at most 50).

        Depths are in `units` as of `diagnosis`.
        """
        return self._client.get_json(f"{self.path}/modes", {"to_hz": to_hz, "units": units})

    def mode_shapes(
        self,
        *,
        from_hz: SupportsFloat | None = None,
        to_hz: SupportsFloat | None = None,
        component: str | None = None,
        kind: str | None = None,
        from_depth: SupportsFloat | None = None,
        to_depth: SupportsFloat | None = None,
        units: str | None = None,
    ) -> Table:
        """Shapes of the modes of a band of frequencies along the string: a row for each mode and node.

        Columns: `mode`, `frequency`, `mode_growth`, `mode_kind`, `mode_component`, `node`, `measured_depth`,
        `lateral_shape`, `axial_shape`, `torsional_shape`, the last three relative to the largest motion of the string.

        Args:
            from_hz: Lowest frequency [Hz]; 0 unless given.
            to_hz: Highest frequency [Hz]; 20 unless given, at most 50.
            component: Name of the component with most of the kinetic energy.
            kind: Main motion: forward, backward, lateral, torsional or axial.
            from_depth: Measured depth [m] from which the largest kinetic energy lies.
            to_depth: Measured depth [m] to which it lies.
            units: Units of the columns, as in `torque_drag`.
        """
        depths = {
            name: None if depth is None else in_query("depth", depth)
            for name, depth in (("from_depth", from_depth), ("to_depth", to_depth))
        }
        band = {"from_hz": from_hz, "to_hz": to_hz}
        return self.view("mode_shapes", **band, component=component, kind=kind, **depths, units=units)

    def hydraulics(self) -> dict[str, Any]:
        """Pressures of the mud's circuit: losses by part, equivalent circulating density by node, standpipe pressure.

        Lists of parts and depths are in the order of `columns`: eccentric and concentric annulus, each at rest and
        turning, and API RP 13D. In SI units.
        """
        return self._client.get_json(f"{self.path}/hydraulics")

    def torque_drag(
        self,
        *,
        modes: Sequence[str] | None = None,
        depths: Iterable[SupportsFloat] | None = None,
        friction: Sequence[float] | None = None,
        travelling_weight: SupportsFloat | None = None,
        axial_speed: SupportsFloat | None = None,
        stiff: bool = False,
        units: str | None = None,
    ) -> Table:
        """Hook load and surface torque of a soft string over the depth of the bit, with margins: a row a case.

        Columns: `drag_mode`, `friction_factor`, `bit_depth`, `hook_load`, `surface_torque`, `largest_yield_ratio`,
        `overpull_margin`, `largest_make_up_ratio`, `largest_buckling_ratio`, and depths of the last four.

        Args:
            modes: Some of `pick_up`, `slack_off`, `rotate` (these three unless given), `drill`, `slide` and `ream`.
            depths: Depths of the bit [m]; 40 to that of the scenario unless given.
            friction: Friction factors of the whole hole; the dynamic friction of each hole section unless given.
            travelling_weight: Weight of top drive and travelling block [N].
            axial_speed: Axial speed of the mode `ream` [m/s], downhole positive.
            stiff: Takes the equilibria of the finite elements in place of the soft string: 0.1 s a case, 60 at most.
            units: Units of the columns: `"si"`, `"field"`, or `"field,hook_load:kN"`; None means the kept units.
        """
        in_metres = None if depths is None else [in_query("depth", depth) for depth in depths]
        lists = {"modes": modes, "depths": in_metres, "friction": friction}
        query = {name: ",".join(map(str, values)) for name, values in lists.items() if values is not None}
        settings = {
            "travelling_weight": travelling_weight,
            "axial_speed": axial_speed,
            "stiff": stiff or None,
            "units": units,
        }
        return self.view("torque_drag", **query, **settings)

    def forced_response(
        self,
        *,
        speeds: Iterable[float] | None = None,
        depth: SupportsFloat | None = None,
        force: SupportsFloat | None = None,
        per_revolution: float | None = None,
        units: str | None = None,
    ) -> Table:
        """Linear forced response over the speed of rotation: a row for each component and speed.

        Columns: `component`, `rotation_speed_rpm`, `excitation_frequency`, `forced_displacement`,
        `forced_acceleration`, `forced_side_force`, `forced_bending_moment`, `forced_bending_stress`, and depths.
        Peaks are critical speeds.

        Args:
            speeds: Speeds of rotation [rpm]; 40 to 240 in steps of 1 unless given.
            depth: Measured depth [m] of a lateral force that turns with the string; None means the unbalance.
            force: Its amplitude [N]; 1000 unless given.
            per_revolution: Its cycles in a revolution, such as the number of blades; 1 unless given.
            units: Units of the columns, as in `torque_drag`.
        """
        listed = None if speeds is None else ",".join(map(str, speeds))
        in_metres = None if depth is None else in_query("depth", depth)
        query = {"speeds": listed, "depth": in_metres, "force": force, "per_revolution": per_revolution, "units": units}
        return self.view("forced_response", **query)

    def stability_map(
        self,
        *,
        speeds: Iterable[float] | None = None,
        weights: Iterable[float] | None = None,
        axial_top: str | None = None,
        units: str | None = None,
    ) -> Table:
        """Growth of motions of bit and string, from the linear equations: a row for each rotation speed and weight.

        Columns: `rotation_speed_rpm`, `stability_weight`, `stability_torque`, `rate_of_penetration`, `growing_motions`,
        `stability_growth_rate`, `stability_frequency`, `stability_complete`. The bit needs a law other than `constant`.

        Args:
            speeds: Speeds of rotation [rpm]; 60 to 200 in steps of 2 unless given.
            weights: Weights on bit [N], positive; that of the scenario unless given. At most 10,000 points.
            axial_top: `advance` (the top descends at the rate of penetration; the default) or `hook_load`.
            units: Units of the columns, as in `torque_drag`.
        """
        lists = {
            name: None if values is None else ",".join(map(str, values))
            for name, values in (("speeds", speeds), ("weights", weights))
        }
        return self.view("stability_map", **lists, axial_top=axial_top, units=units)

    def fit_friction(
        self,
        points: Iterable[Mapping[str, Any]],
        *,
        travelling_weight: float = 0.0,
        axial_speed: float | None = None,
        hook_load_deviation: float = 1e4,
        torque_deviation: float = 1e3,
    ) -> dict[str, Any]:
        """Friction factors of hole sections that fit measured hook loads and torques, with residuals.

        Args:
            points: Measured points, each with `bit_depth` [m], `mode` (as in `torque_drag`), and `hook_load` [N],
                `torque` [N m] or both.
            travelling_weight: Weight of top drive and travelling block [N], part of the hook loads.
            axial_speed: Axial speed of points of the mode `ream` [m/s], downhole positive.
            hook_load_deviation: Standard deviation of a measured hook load [N].
            torque_deviation: Standard deviation of a measured torque [N m].
        """
        body = {
            "points": [dict(point) for point in points],
            "travelling_weight": travelling_weight,
            "axial_speed": axial_speed,
            "hook_load_deviation": hook_load_deviation,
            "torque_deviation": torque_deviation,
        }
        return self._client.post_json(f"{self.path}/friction", body)

    def view(self, name: str, **query: Any) -> Table:
        """Any table of the point; `query` holds parameters of the HTTP API, such as `units="field"`."""
        return Table.from_json(self._client.get_json(f"{self.path}/{name}", query))

    def save(self, name: str, file: str | Path, **query: Any) -> Path:
        """Writes a table to a file, in the format of its ending: .csv, .json, .parquet, .npz; pictures: .svg, .png."""
        return self._client.save(f"{self.path}/{name}", file, query)

    def _detail(self, name: str) -> Any:
        if "scenario" not in self._data:
            self.refresh()
        return self._data.get(name)

    def __repr__(self) -> str:
        """Number, state and parameters."""
        parameters = "".join(f", {name}={value:g}" for name, value in self.parameters.items())
        return f"Point({self.ordinal}, {self.state}{parameters})"


def _node_window(node: int | None, depth: SupportsFloat | None, nearest: bool, time: TimeWindow) -> dict[str, Any]:
    return {"node": node, "depth": depth, "nearest": nearest or None, "from": time[0], "to": time[1]}
