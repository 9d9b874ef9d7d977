"""Results of a point against what numpy makes of them."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import polars
import pytest
from matplotlib.axes import Axes

from drillsweep import Client, InvalidRequest, Point, Sweep, plot
from service import REPOSITORY, SHORT


def test_orbit_and_summary_follow_from_the_recorded_motion(sweep: Sweep) -> None:
    point = sweep.point(1)
    history = point.history(node=49, time=(0.1, 0.5))
    orbit = point.orbit(node=49, time=(0.1, 0.5))
    assert orbit.rows == 400, "a half-open window at 1 kHz"
    np.testing.assert_array_equal(orbit["u"], history["u_49"])
    np.testing.assert_array_equal(orbit["radius"], np.hypot(history["u_49"], history["v_49"]))
    motion = orbit["u"] + 1j * orbit["v"]
    size = np.sqrt(np.mean(np.abs(motion - motion.mean()) ** 2))
    assert point.summary is not None
    # Samples are kept in single precision.
    assert point.summary["orbit_radius_rms_49"] == pytest.approx(size, rel=1e-3)
    assert orbit.units == {"time": "s", "u": "m", "v": "m", "radius": "m"}


def test_statistics_of_the_orbit_window_are_those_of_the_summary(sweep: Sweep) -> None:
    point = sweep.point(1)
    statistics = point.statistics(time=(0.1, 0.5))
    assert statistics.attributes["samples"] == 400
    assert point.summary is not None
    for row, node in enumerate(statistics["node"]):
        for name in ("orbit_radius_rms", "orbit_mean_radius", "orbit_radius_deviation", "orbit_offset"):
            # Samples are kept in single precision.
            assert statistics[name][row] == pytest.approx(point.summary[f"{name}_{node}"], rel=1e-3), name
    assert point.statistics(node=49, time=(0.1, 0.5))["orbit_radius_rms"] == statistics["orbit_radius_rms"][1]


def test_a_thinned_history_keeps_its_extremes(sweep: Sweep) -> None:
    whole = sweep.point(1).history(node=49)["u_49"]
    thinned = sweep.point(1).history(node=49, max_points=100, decimation="minmax")
    assert thinned.rows <= 100
    assert (thinned["u_49"].min(), thinned["u_49"].max()) == (whole.min(), whole.max())


def test_a_point_has_its_torque_and_drag(sweep: Sweep) -> None:
    table = sweep.point(1).torque_drag(
        modes=["rotate", "ream"], depths=[100.0, 200.0], friction=[0.2], axial_speed=-0.1
    )
    assert list(table["bit_depth"]) == [100.0, 200.0, 100.0, 200.0]
    turning, reaming = table["surface_torque"][1], table["surface_torque"][3]
    assert 0.0 < reaming < turning
    assert table["hook_load"][3] > table["hook_load"][1]


def test_a_point_has_its_forced_response(sweep: Sweep) -> None:
    point = sweep.point(1)
    table = point.forced_response(speeds=[60.0, 120.0], depth=190.0, force=2000.0, per_revolution=3.0)
    assert list(table["rotation_speed_rpm"][:2]) == [60.0, 120.0]
    assert list(table["excitation_frequency"][:2]) == pytest.approx([3.0, 6.0])
    # The equations are linear.
    half = point.forced_response(speeds=[60.0, 120.0], depth=190.0, force=1000.0, per_revolution=3.0)
    assert list(table["forced_displacement"]) == pytest.approx(list(2.0 * half["forced_displacement"]))
    with pytest.raises(InvalidRequest, match="depth"):
        point.forced_response(force=1.0)


def test_a_point_has_the_shapes_of_its_modes(sweep: Sweep) -> None:
    point = sweep.point(1)
    twist = point.mode_shapes(to_hz=6.0, kind="torsional")
    # In its lowest mode a string that is held at its top and free at its bit twists in one sense.
    assert list(twist["mode"][:2]) == [1, 1]
    assert twist["torsional_shape"][0] == 0.0
    assert all(twist["torsional_shape"][1:] > 0.0)
    names = set(point.mode_shapes(to_hz=6.0, units="field")["mode_component"])
    assert names
    with pytest.raises(InvalidRequest, match="no component"):
        point.mode_shapes(component="motor")


def test_a_bit_of_constant_torque_has_no_stability_map(sweep: Sweep) -> None:
    with pytest.raises(InvalidRequest, match="constant torque"):
        sweep.point(1).stability_map(speeds=[60.0, 120.0])


def test_friction_is_fitted_to_measured_hook_loads(sweep: Sweep) -> None:
    point = sweep.point(1)
    table = point.torque_drag(modes=["pick_up", "slack_off"], depths=[120.0, 200.0], friction=[0.27])
    measured = [
        {"bit_depth": depth, "mode": mode, "hook_load": load}
        for depth, mode, load in zip(table["bit_depth"], table["drag_mode"], table["hook_load"], strict=True)
    ]
    fit = point.fit_friction(measured)
    assert [factor["friction"] for factor in fit["friction"]] == pytest.approx([0.27], abs=1e-6)
    with pytest.raises(InvalidRequest, match="/points/0"):
        point.fit_friction([{"bit_depth": 1e4, "mode": "rotate", "torque": 1.0}])


def test_a_point_has_its_hydraulics(sweep: Sweep) -> None:
    circuit = sweep.point(1).hydraulics()
    rest = next(column for column in circuit["columns"] if column["losses"] == "concentric" and not column["rotates"])
    deepest = circuit["depths"][-1]
    lost = rest["surface_loss"] + rest["bore_loss"] + rest["tool_loss"] + rest["bit_loss"] + rest["annulus_loss"]
    assert rest["standpipe_pressure"] == pytest.approx(lost, rel=1e-12)
    column = circuit["columns"].index(rest)
    excess = deepest["equivalent_circulating_densities"][column] - circuit["mud_density"]
    gravity = 9.81
    assert excess * gravity * deepest["true_vertical_depth"] == pytest.approx(rest["annulus_loss"], rel=1e-9)


def test_a_point_has_its_plan_and_its_modes(sweep: Sweep) -> None:
    point = sweep.point(1)
    effects = {effect["effect"]: effect for effect in point.plan()["effects"]}
    assert effects["friction"]["active"]
    assert effects["friction"]["reason"]
    modes = point.modes(to_hz=5.0)
    assert modes["completeness"] == "counted"
    assert [mode["frequency_hz"] for mode in modes["modes"]] == sorted(mode["frequency_hz"] for mode in modes["modes"])
    in_feet = point.modes(to_hz=5.0, units="field")
    assert in_feet["units"]["measured_depth"] == "ft"
    feet = [mode["measured_depth"] for mode in in_feet["modes"]]
    assert [0.3048 * depth for depth in feet] == pytest.approx([mode["measured_depth"] for mode in modes["modes"]])


def test_full_spectrum_is_the_transform_of_the_orbit(sweep: Sweep) -> None:
    point = sweep.point(1)
    orbit = point.orbit(node=49, time=(0.1, 0.5))
    spectrum = point.spectrum(node=49, time=(0.1, 0.5), window="rectangular", range_hz=20)
    motion = orbit["u"] + 1j * orbit["v"]
    frequency = np.fft.fftfreq(motion.size, 1e-3)
    amplitude = np.abs(np.fft.fft(motion)) / motion.size
    for f, a in zip(spectrum["frequency"], spectrum["amplitude"], strict=True):
        if abs(f) > 1e-9:
            assert a == pytest.approx(amplitude[np.argmin(np.abs(frequency - f))], rel=1e-6), f
    for peak in spectrum.attributes["peaks"]:
        if abs(peak["frequency"]) > spectrum.attributes["resolution"]:
            assert peak["whirl"] == ("forward" if peak["frequency"] > 0.0 else "backward")


def test_snapshots_equal_the_histories_of_every_node(client: Client) -> None:
    changes = SHORT | {"recording.snapshots": {"rate_hz": 50, "window": {"from": 0.1, "to": 0.5}}}
    sweep = client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]}).wait(timeout=120.0)
    point = sweep.point(1)
    assert "snapshots" in point.tables
    snapshots = point.snapshots()
    nodes = snapshots.attributes["nodes"]
    assert (nodes, snapshots.attributes["snapshots"], snapshots.rows) == (297, 20, 20 * 297)
    history = point.history(node=49, time=(0.1, 0.5))
    for name in ("u", "v", "w", "theta_z", "rotation_speed", "torque"):
        np.testing.assert_array_equal(snapshots[name].reshape(-1, nodes)[:, 48], history[f"{name}_49"][::20], name)
    np.testing.assert_allclose(snapshots["time"][::nodes], history["time"][::20], rtol=1e-12)
    # A node that the wall pushes is in it.
    clearance = np.tile(point.statics()["clearance"], 20)
    pushed = snapshots["normal_force"] > 0
    assert pushed.any()
    assert np.all(np.hypot(snapshots["u"], snapshots["v"])[pushed] > clearance[pushed] * (1 - 1e-6))
    thinned = point.snapshots(time=(0.2, None), max_frames=5, fields=["node", "normal_force"])
    assert list(thinned) == ["node", "normal_force"]
    np.testing.assert_array_equal(
        thinned["normal_force"].reshape(-1, nodes), snapshots["normal_force"].reshape(-1, nodes)[5::3]
    )


def test_a_spectrogram_is_the_spectra_of_its_windows(sweep: Sweep) -> None:
    point = sweep.point(1)
    table = point.spectrogram(node=49, window_s=0.1, step_s=0.05, window="rectangular", range_hz=95)
    amplitude = table["amplitude"].reshape(table.attributes["windows"], -1)
    assert amplitude.shape == (9, 19)
    for index in range(9):
        start = 0.05 * index
        spectrum = point.spectrum(node=49, time=(start, start + 0.1), window="rectangular", range_hz=95)
        np.testing.assert_allclose(amplitude[index], spectrum["amplitude"], rtol=1e-9, atol=1e-15)


def test_tables_have_the_requested_units(sweep: Sweep) -> None:
    point = sweep.point(1)
    kept, field = point.orbit(node=49), point.orbit(node=49, units="field,v:mm")
    assert [field.units[name] for name in ("time", "u", "v", "measured_depth")] == ["s", "in", "mm", "ft"]
    np.testing.assert_allclose(0.0254 * field["u"], kept["u"], rtol=1e-12)
    np.testing.assert_allclose(1e-3 * field["v"], kept["v"], rtol=1e-12)
    table = sweep.table(units="field,mud_density:g/cm3")
    np.testing.assert_allclose(1e3 * table["mud_density"], sweep.table()["mud_density"], rtol=1e-15)
    window = sweep.window(limits={"largest_side_force": "5 klbf"}, units="field")
    assert window.attributes["limits"]["largest_side_force"] == 5.0


def test_loads_lines_and_diagnosis_agree_with_the_row(sweep: Sweep) -> None:
    point = sweep.point(2)
    loads, row = point.loads(), point.summary
    assert row is not None
    assert loads["lateral_acceleration_rms"].max() == row["largest_lateral_acceleration_rms"]
    assert loads["rotation_speed_min"][-1] == row["bit_speed_min"]
    worst = loads["equivalent_stress_peak"].argmax()
    assert loads["measured_depth"][worst] == row["largest_equivalent_stress_depth"]
    lines = point.lines()
    diagnosis = point.diagnosis(limits={"bit_stick_slip_severity": None, "largest_side_force": 1.0})
    assert [line["frequency_hz"] for line in diagnosis["lines"]] == list(lines["frequency"])
    assert "bit_stick_slip_severity" not in diagnosis["limits"]
    assert "over_limit" in {finding["class"] for finding in diagnosis["findings"]}
    window = sweep.window(limits={"largest_side_force": 1.0})
    index = list(window["ordinal"]).index(2)
    default = point.diagnosis(limits={"largest_side_force": 1.0})
    assert window["class"][index] == default["class"]
    assert window["sentence"][index] == default["sentence"]


def test_tables_come_as_arrays(sweep: Sweep) -> None:
    point = sweep.point(2)
    profile = point.profile()
    assert profile["friction_coefficient"].dtype == np.float64
    assert profile["element"].dtype == np.int64
    assert set(profile["regime"]) <= {"laminar", "transitional", "turbulent"}
    assert profile.to_polars().shape == (profile.rows, len(profile))
    contacts = point.contacts()
    touched = contacts["contact_count"] > 0
    assert touched.any()
    assert np.all(contacts["largest_radius"][touched] > contacts["clearance"][touched])
    energy = point.energy()
    # What came in, less what was dissipated, is there, but for the residual.
    there = energy["kinetic"] + energy["stored"]
    works = ("unbalance", "rotation", "flow_and_torque", "bit", "excitation", "drive")
    received = sum(energy[f"work_{work}"] for work in works)
    kinds = ("structure", "fluid", "friction", "contact")
    dissipated = sum(energy[f"dissipated_{kind}"] for kind in kinds)
    np.testing.assert_allclose(there - there[0] - received + dissipated, energy["residual"], rtol=1e-9, atol=1e-6)
    assert len(point.tables) >= 5
    assert point.provenance is not None
    assert point.provenance["steps"] > 0


def test_files_equal_the_arrays(sweep: Sweep, tmp_path: Path) -> None:
    point = sweep.point(1)
    frame = polars.read_parquet(point.save("orbit", tmp_path / "orbit.parquet", node=49))
    np.testing.assert_array_equal(frame["u"].to_numpy(), point.orbit(node=49)["u"])
    arrays = np.load(point.save("orbit", tmp_path / "orbit.npz", node=49))
    np.testing.assert_array_equal(arrays["u"], point.orbit(node=49)["u"])
    assert "<svg" in point.save("orbit", tmp_path / "orbit.svg", node=49).read_text()
    with pytest.raises(InvalidRequest, match="format"):
        point.save("orbit", tmp_path / "orbit.xlsx", node=49)


def test_orbit_is_drawn_low_side_down_in_the_holes_circle(sweep: Sweep) -> None:
    point = sweep.point(1)
    axes = plot.orbit(point, node=49)
    orbit, circle = axes.lines
    statics = point.statics()
    row = list(statics["node"]).index(49)
    x, y = circle.get_data()
    np.testing.assert_allclose(np.hypot(x, y), 1e3 * statics["clearance"][row])
    # The string lies on the low side of this inclined hole, at rest and in motion.
    x, y = np.asarray(orbit.get_xdata()), np.asarray(orbit.get_ydata())
    assert y.mean() < 0.0
    assert abs(x.mean()) < abs(y.mean())
    np.testing.assert_allclose(np.hypot(x, y), 1e3 * point.orbit(node=49)["radius"])


def test_rotation_at_the_bit_is_drawn_from_history_or_snapshots(client: Client, sweep: Sweep) -> None:
    changes = SHORT | {"recording.nodes": [{"node": 296}, {"node": 297}]}
    recorded = client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]})
    # Of chosen nodes alone the history is kept without the bit.
    chosen = SHORT | {"recording.outputs": {"orbits": {"nodes": [{"node": 282}]}}}
    changes = chosen | {"recording.snapshots": {"rate_hz": 50}}
    snapped = client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]})
    # At a flow rate at which no whole result is stored already.
    without = client.submit("paper-200m", set=chosen, axes={"flow_rate": [0.012]})
    point = recorded.wait(timeout=120.0).point(1)
    lateral, speed, torque = plot.history(point)
    assert len(lateral.lines) == 4
    table = point.history()
    # 120 rpm are imposed at the top.
    rates = 120.0 * np.pi / 30.0 + np.asarray(table["theta_z_rate_297"])
    assert np.ptp(rates) > 0.1
    np.testing.assert_allclose(drawn(speed), rates, atol=1e-5)
    assert (speed.get_title(), speed.get_ylabel()) == ("Rotation at the bit", "rotation speed [rad/s]")
    assert legend_of(lateral) == ["u, node 296", "v, node 296", "u, node 297", "v, node 297"]
    assert [line.get_color() for line in lateral.lines] == list(plot.PALETTE[:4])
    # From that of the equilibrium on by the twist between the ends of the lowest element, of 0.5 m, on G I_p.
    shear_modulus, polar = 2.03e11 / 2.6, np.pi / 32 * (0.159**4 - 0.071**4)
    twist = np.asarray(table["theta_z_297"]) - np.asarray(table["theta_z_296"])
    expected = 1e-3 * (point.profile()["torque"][-1] + shear_modulus * polar * (twist - twist[0]) / 0.5)
    assert np.ptp(expected) > 0.05
    assert torque.get_ylabel() == "torque [kN·m]"
    np.testing.assert_allclose(drawn(torque), expected, atol=0.01)

    point = snapped.wait(timeout=120.0).point(1)
    _, speed_of_snapshots, torque_of_snapshots = plot.history(point)
    assert speed_of_snapshots.get_title() == "Rotation at the bit"
    np.testing.assert_allclose(drawn(speed_of_snapshots), drawn(speed)[::20], rtol=1e-9)
    np.testing.assert_allclose(drawn(torque_of_snapshots), drawn(torque)[::20], rtol=1e-9)

    point = without.wait(timeout=120.0).point(1)
    _, speed_of_lowest, _ = plot.history(point)
    assert speed_of_lowest.get_title() == "Rotation of node 282: at the bit, at 200.0 m, it was not recorded"
    assert "Rotation at the bit, at 200.0 m MD, was not recorded" in svg(point)
    # It is recorded whichever nodes are.
    point = sweep.point(1)
    _, speed_beside, _ = plot.history(point)
    assert speed_beside.get_title() == "Rotation at the bit"
    np.testing.assert_array_equal(drawn(speed_beside), drawn(speed))
    assert plot.history(point, node=49)[1].get_title() == "Rotation of node 49"
    for has_it in (sweep, snapped, recorded):
        assert "rotation speed at the bit, 200.0 m MD" in svg(has_it.point(1))


def legend_of(axes: Axes) -> list[str]:
    """The names in its legend."""
    legend = axes.get_legend()
    assert legend is not None
    return [text.get_text() for text in legend.get_texts()]


def drawn(axes: Axes) -> np.ndarray[Any, Any]:
    """The values of the only line."""
    (line,) = axes.lines
    return np.asarray(line.get_ydata())


def svg(point: Point) -> str:
    """The picture of its history by the service."""
    with tempfile.TemporaryDirectory() as directory:
        return point.save("history", Path(directory) / "history.svg").read_text()


def test_frequencies_that_the_step_does_not_resolve_are_marked(sweep: Sweep) -> None:
    point = sweep.point(1)
    attributes = point.spectrum(node=49, range_hz=200, peaks=40).attributes
    resolved = attributes["resolved_hz"]
    assert 0.0 < resolved < 200.0
    marks = [(abs(peak["frequency"]) <= resolved, peak["is_resolved"]) for peak in attributes["peaks"]]
    assert (False, False) in marks
    assert all(expected == got for expected, got in marks)
    assert plot.spectrum(point, node=49, range_hz=0.9 * resolved).get_legend() is None
    axes = plot.spectrum(point, node=49, range_hz=200, peaks=40)
    legend = axes.get_legend()
    assert legend is not None
    assert legend.get_texts()[0].get_text() == f"not resolved by the steps (beyond ±{resolved:.3g} Hz)"
    assert all(abs(float(text.get_text().removesuffix(" Hz"))) <= resolved + 0.005 for text in axes.texts)


def test_spectrum_and_profile_are_drawn(sweep: Sweep) -> None:
    axes = plot.spectrum(sweep.point(1), node=49, range_hz=20, peaks=3)
    assert len(axes.texts) == 3
    axes = plot.profile(sweep.points())
    assert len(axes.lines) == 4
    assert axes.get_xlabel() == "friction coefficient C_f"
    assert legend_of(axes)[0] == "flow rate 0.01 m³/s, mud density 1200 kg/m³"
    bottom, top = axes.get_ylim()
    assert bottom > top, "depth goes down"


def test_lines_have_the_colours_of_the_page() -> None:
    page = (REPOSITORY / "server" / "web" / "draw" / "plots.js").read_text(encoding="utf-8")
    colours = re.findall(r"light: \[(.*)\]", page)[0]
    assert tuple(re.findall("#[0-9a-f]{6}", colours)) == plot.PALETTE
