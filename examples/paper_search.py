"""A search over the choices that the paper behind the base case leaves open. Needs `drillsweep` and NumPy.

Tran et al. 2019 (Journal of Sound and Vibration 462, 114924) draw their well without printing a survey, and their text
leaves open how the pipe is bent into it and how friction acts on the twist. Three stages, each a set of sweeps:

1. Surveys, weight on bit and torque on bit are drawn; equilibria that are seated as in section 4.2 stay.
2. Each of these runs with and without mud under every reading of the text, and is compared with section 4.3.
3. Rounds of draws in ever smaller boxes around the best points.

The best are then run for 60 s, four neighbours each, and at two densities of the mud. A few points by default;
`--whole` has the numbers of the search that docs/validation.md reports.
"""

from __future__ import annotations

import argparse
import csv
import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drillsweep import Client, Point, Range, Sweep, Table

PRESET = "paper-200m"
DAMPING = {"damping.stiffness_proportional": 3e-5}  # s, of paper-200m-damped; the paper's is 0
NODE = 49
SURVEY = {
    "well.survey[0].inclination_deg": (40.0, 80.0),
    "well.survey[1].inclination_deg": (50.0, 90.0),
    "well.survey[2].inclination_deg": (60.0, 100.0),
    "well.survey[3].inclination_deg": (70.0, 105.0),
    "well.survey[4].inclination_deg": (75.0, 110.0),
    "well.survey[1].azimuth_deg": (-15.0, 15.0),
    "well.survey[2].azimuth_deg": (-30.0, 30.0),
    "well.survey[3].azimuth_deg": (-45.0, 45.0),
    "well.survey[4].azimuth_deg": (-60.0, 60.0),
}
"""Ranges of the survey [deg]."""

LOADS = {"operation.weight_on_bit": (-1.5e5, -5e4), "operation.torque_on_bit": (-7500.0, -2500.0)}
"""Ranges of the loads [N, N m]; the paper prints -1e5 and -5000."""

WELLS: dict[str, dict[str, Any]] = {
    "straight pipe": {},
    "pipe without stress on the axis": {"effects.well_bending": "off"},
    "weight as in air": {"effects.buoyancy": "off"},
    "both": {"effects.well_bending": "off", "effects.buoyancy": "off"},
}
"""Readings of the text about the string at rest."""

Ranges = Mapping[str, tuple[float, float]]

SLIDING = {"contact.static_friction": 0.216, "contact.dynamic_friction": 0.216}
"""Friction of sliding at 120 rpm, at rest too: a start from sliding, and no velocity weakening."""

MOTIONS: dict[str, dict[str, Any]] = {
    "free twist": {},
    "no friction torque": {"effects.friction_torque": "off"},
    "held twist": {"effects.torsion": "off"},
    "sliding friction": SLIDING,
    "sliding friction, held twist": {**SLIDING, "effects.torsion": "off"},
}
"""Readings of the text about friction and twist."""

SEATED_RADIUS = 0.07521 / 2  # m, section 4.3: half of the peak at 0 Hz
DRY_LINE, WET_LINE = 3.532, -2.781  # Hz, section 4.3
CONTACTS = 32  # in CONTACT_WINDOW, section 4.3
LINE_WINDOW, CONTACT_WINDOW, STEADY_WINDOW = (15.0, 25.0), (14.5, 26.0), (50.0, 60.0)  # s, its figures 15 to 18


@dataclass(frozen=True)
class Reading:
    """One reading of the text."""

    well: str
    motion: str

    @property
    def changes(self) -> dict[str, Any]:
        """The changes of the scenario that it makes."""
        return {**WELLS[self.well], **MOTIONS[self.motion]}


@dataclass(frozen=True)
class Motion:
    """Orbit of a node, measured as the paper does."""

    forward: float
    """Frequency of the strongest line of forward whirl [Hz]."""
    forward_amplitude: float
    """Its amplitude [m]."""
    backward: float
    """Frequency of the strongest line of backward whirl, negative [Hz]."""
    backward_amplitude: float
    """Its amplitude [m]."""
    offset: float
    """Distance of the orbit's mean from the hole's axis [m]."""
    size: float
    """Root mean square distance from that mean [m]."""
    contacts: int
    """Contacts with the wall."""
    gap: float
    """Smallest distance to the wall, 0 in contact [m]."""

    @property
    def strongest(self) -> float:
        """Frequency of the stronger of both lines [Hz]."""
        return self.forward if self.forward_amplitude > self.backward_amplitude else self.backward


@dataclass(frozen=True)
class Candidate:
    """A point under a reading, with its motion and its misfit."""

    reading: Reading
    parameters: dict[str, float]
    dry: Motion
    wet: Motion
    misfits: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        """Derives the misfits, each from 0 to 1."""
        misfits = {
            "dry forward": misfit(self.dry.forward - DRY_LINE, 0.15),
            "dry backward": misfit(self.dry.backward + DRY_LINE, 0.15),
            "dry contact": misfit(self.dry.gap, 2e-3),
            "wet line": misfit(self.wet.strongest - WET_LINE, 0.15),
            # Half of it for a wall out of reach, so that approaching the wall counts as progress.
            "wet contacts": (misfit(self.wet.contacts - CONTACTS, 8) + misfit(self.wet.gap, 2e-3)) / 2,
            "wet offset": misfit(self.wet.offset - SEATED_RADIUS, 3e-4),
        }
        object.__setattr__(self, "misfits", misfits)

    @property
    def cost(self) -> float:
        """Mean misfit: 0 reproduces every target, 1 none."""
        return sum(self.misfits.values()) / len(self.misfits)


def misfit(distance: float, scale: float) -> float:
    """Return 0 on target, a half at one `scale` from it, 1 far away."""
    return abs(distance) / (abs(distance) + scale)


def seat_misfit(point: Point) -> float:
    """Return how far an equilibrium is from section 4.2: tool joints and collars on the wall, node 49 on its radius."""
    statics = point.statics()
    touches = statics["normal_force"] > 0.0
    radius = float(statics["radius"][statics["node"] == NODE][0])
    joints, collars = touches[is_tool_joint(statics)], touches[statics["measured_depth"] > 89.5]
    return (misfit(radius - SEATED_RADIUS, 3e-4) + 2.0 - float(joints.mean()) - float(collars.mean())) / 3


def is_tool_joint(statics: Table) -> Any:
    """Return for each node whether its clearance is that of a tool joint."""
    return np.abs(statics["clearance"] - (0.2159 - 0.1619) / 2) < 1e-5


def motion(
    point: Point,
    node: int = NODE,
    lines: tuple[float, float] = LINE_WINDOW,
    contacts: tuple[float, float] = CONTACT_WINDOW,
) -> Motion:
    """Return the motion of a node: lines over one window, contacts over another."""
    statics = point.statics()
    clearance = float(statics["clearance"][statics["node"] == node][0])
    strongest: dict[str, Any] = {}
    for peak in point.spectrum(node=node, time=lines, window="hann", range_hz=20.0, peaks=1000).attributes["peaks"]:
        # Peaks come from the highest down; below half a hertz the orbit drifts.
        if abs(peak["frequency"]) > 0.5:
            strongest.setdefault(peak["whirl"], peak)
    none = {"frequency": 0.0, "amplitude": 0.0}
    forward, backward = (strongest.get(whirl, none) for whirl in ("forward", "backward"))
    size = point.statistics(node=node, time=lines)
    reach = float(point.statistics(node=node, time=contacts)["orbit_largest_radius"][0])
    return Motion(
        forward=forward["frequency"],
        forward_amplitude=forward["amplitude"],
        backward=backward["frequency"],
        backward_amplitude=backward["amplitude"],
        offset=float(size["orbit_offset"][0]),
        size=float(size["orbit_radius_rms"][0]),
        contacts=contact_count(point, node, clearance, contacts) if reach > clearance else 0,
        gap=max(0.0, clearance - reach),
    )


def contact_count(point: Point, node: int, clearance: float, window: tuple[float, float]) -> int:
    """Count the contacts of a node; bounces within a tenth of a second are one of those that the paper calls main."""
    orbit = point.orbit(node=node, time=window)
    outside = orbit["radius"] > clearance
    touch = orbit["time"][1:][outside[1:] & ~outside[:-1]]
    return int(np.sum(np.diff(touch, prepend=-np.inf) > 0.1))


def seated(
    client: Client, well: str, ranges: Ranges, surveys: int, doglegs: float, kept: int, seed: int
) -> list[dict[str, float]]:
    """Return the points whose equilibria are seated best, of a Sobol design over the ranges."""
    sweep = client.submit(
        PRESET,
        set={"effects.transient": "off", **WELLS[well]},
        axes={path: Range(*interval) for path, interval in ranges.items()},
        design="sobol",
        samples=surveys,
        seed=seed,
        name=f"equilibria, {well}",
    ).wait()
    buildable = (point for point in sweep.points("succeeded") if sharpest_dogleg(drawn(point)) <= doglegs)
    ranked = sorted((seat_misfit(point), point.ordinal, point) for point in buildable)
    for found, _, point in ranked[:kept]:
        print(f"{well}: point {point.ordinal} misses the seat by {found:.2f}")
    return [drawn(point) for _, _, point in ranked[:kept]]


def sharpest_dogleg(parameters: dict[str, float]) -> float:
    """Return the sharpest dogleg of a survey whose stations are 50 m apart [deg per 30 m]."""
    tangents = []
    for station in range(5):
        inclination = np.radians(parameters[f"well.survey[{station}].inclination_deg"])
        azimuth = np.radians(parameters.get(f"well.survey[{station}].azimuth_deg", 0.0))
        horizontal = np.sin(inclination)
        tangents.append((horizontal * np.cos(azimuth), horizontal * np.sin(azimuth), np.cos(inclination)))
    cosines = [np.dot(above, below) for above, below in itertools.pairwise(tangents)]
    return float(np.degrees(np.arccos(min(cosines)))) * 30.0 / 50.0


def drawn(point: Point) -> dict[str, float]:
    """Return the parameters of a point that are drawn."""
    return {path: value for path, value in point.parameters.items() if path in SURVEY or path in LOADS}


def submitted(
    client: Client, reading: Reading, points: Sequence[dict[str, float]], changes: dict[str, Any], name: str
) -> Sweep:
    """Submit points under a reading; each keeps the orbit of node 49 and the equilibrium."""
    duration = changes.get("duration", CONTACT_WINDOW[1])
    return client.submit(
        PRESET,
        set={
            "duration": duration,
            "accuracy": "draft",
            "recording.nodes": [{"node": NODE}],
            "recording.spectrum_windows": [],
            "recording.orbit_window": None,
            **DAMPING,
            **reading.changes,
            **changes,
        },
        points=points,
        outputs={"orbits": {"nodes": [{"node": NODE}], "window": {"from": CONTACT_WINDOW[0], "to": duration}}},
        name=f"{name}: {reading.well}, {reading.motion}",
    )


def compared(client: Client, asked: Iterable[tuple[Reading, Sequence[dict[str, float]]]]) -> list[Candidate]:
    """Run points under readings, with and without mud, and return those that ran in both, the best first."""
    sweeps = [
        (
            reading,
            submitted(client, reading, points, {}, "wet"),
            submitted(client, reading, points, {"mud": None}, "dry"),
        )
        for reading, points in asked
    ]
    candidates = []
    for reading, wet, dry in sweeps:
        without_mud = {point.ordinal: point for point in dry.wait().points("succeeded")}
        for point in wet.wait().points("succeeded"):
            if point.ordinal in without_mud:
                motions = (motion(run) for run in (without_mud[point.ordinal], point))
                candidates.append(Candidate(reading, drawn(point), *motions))
    return sorted(candidates, key=lambda candidate: candidate.cost)


def around(
    candidate: Candidate, ranges: Ranges, size: float, doglegs: float, count: int, rng: np.random.Generator
) -> list[dict[str, float]]:
    """Draw points in a box around a candidate, of `size` times the ranges and within them and the sharpest dogleg."""
    points: list[dict[str, float]] = []
    while len(points) < count:
        point = {}
        for path, (low, high) in ranges.items():
            value = candidate.parameters[path] + size * (high - low) * rng.uniform(-0.5, 0.5)
            point[path] = float(np.clip(value, low, high))
        if sharpest_dogleg(point) <= doglegs:
            points.append(point)
    return points


def confirm(client: Client, candidate: Candidate, neighbours: int) -> None:
    """Print runs of 60 s of a candidate and its neighbours by a newton of weight on bit, without and with mud."""
    print(f"\n{candidate.reading.well}, {candidate.reading.motion}, cost {candidate.cost:.3f}")
    print("  " + ", ".join(f"{path} {value:.6g}" for path, value in candidate.parameters.items()))
    weight = candidate.parameters.get("operation.weight_on_bit", -1e5)
    points = [{**candidate.parameters, "operation.weight_on_bit": weight + newton} for newton in range(neighbours)]
    muds: dict[str, dict[str, Any]] = {
        "without mud": {"mud": None},
        "1200 kg/m3": {},
        "1200 kg/m3, no stiffness-proportional damping": {"damping.stiffness_proportional": 0.0},
        "1800 kg/m3": {"mud.density": 1800.0},
    }
    changes = {"duration": STEADY_WINDOW[1], "accuracy": "standard"}
    sweeps = {
        mud: submitted(client, candidate.reading, points, {**changes, **change}, f"60 s, {mud}")
        for mud, change in muds.items()
    }
    for mud, sweep in sweeps.items():
        for point in sweep.wait().points("succeeded"):
            late = described(motion(point, NODE, STEADY_WINDOW, STEADY_WINDOW))
            print(f"  {mud}: {described(motion(point))}; over [50, 60) s {late}", flush=True)


def described(of: Motion) -> str:
    """Return a motion in words."""
    return (
        f"{of.backward:+.3f} Hz {1e3 * of.backward_amplitude:.2f} mm, {of.forward:+.3f} Hz "
        f"{1e3 * of.forward_amplitude:.2f} mm, offset {1e3 * of.offset:.2f} mm, {of.contacts} contacts, "
        f"{1e3 * of.gap:.2f} mm off the wall"
    )


def best_by_reading(candidates: Iterable[Candidate]) -> list[Candidate]:
    """Return the best candidate of each reading, the best first."""
    best: dict[Reading, Candidate] = {}
    for candidate in candidates:
        if candidate.reading not in best or candidate.cost < best[candidate.reading].cost:
            best[candidate.reading] = candidate
    return sorted(best.values(), key=lambda candidate: candidate.cost)


def show(title: str, candidates: Sequence[Candidate]) -> None:
    """Print the best candidate of each reading with its misfits."""
    print(f"\n{len(candidates)} candidates, {title}")
    for candidate in best_by_reading(candidates):
        print(f"{candidate.cost:.3f}  {candidate.reading.well}, {candidate.reading.motion}")
        print("       " + ", ".join(f"{name} {value:.2f}" for name, value in candidate.misfits.items()))
        print(f"       without mud {described(candidate.dry)}")
        print(f"       with mud {described(candidate.wet)}", flush=True)


def save(candidates: Sequence[Candidate], file: Path) -> None:
    """Write a row a candidate."""
    with file.open("w", newline="") as opened:
        table = csv.writer(opened)
        measures = [f"{mud}_{name}" for mud in ("dry", "wet") for name in Motion.__dataclass_fields__]
        table.writerow(["cost", "well", "motion", *candidates[0].parameters, *measures])
        for candidate in candidates:
            values = [
                getattr(run, name) for run in (candidate.dry, candidate.wet) for name in Motion.__dataclass_fields__
            ]
            row = [candidate.cost, candidate.reading.well, candidate.reading.motion]
            table.writerow([*row, *candidate.parameters.values(), *values])


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--whole", action="store_true", help="the numbers of the whole search: some 15 CPU minutes")
    parser.add_argument("--printed-loads", action="store_true", help="draw surveys only")
    parser.add_argument("--wells", nargs="+", choices=list(WELLS), default=list(WELLS)[:1], help="readings at rest")
    parser.add_argument("--motions", nargs="+", choices=list(MOTIONS), default=list(MOTIONS)[:3], help="in motion")
    parser.add_argument("--surveys", type=int, default=16, help="equilibria to draw for each reading of the well")
    parser.add_argument("--doglegs", type=float, default=float("inf"), help="sharpest dogleg of them, deg per 30 m")
    parser.add_argument("--kept", type=int, default=1, help="of them, how many run in time")
    parser.add_argument("--rounds", type=int, default=0, help="rounds of draws around the best")
    parser.add_argument("--draws", type=int, default=4, help="points of a round")
    parser.add_argument("--confirmed", type=int, default=0, help="candidates to run for 60 s")
    parser.add_argument("--neighbours", type=int, default=4, help="runs of each of these")
    parser.add_argument("--seed", type=int, default=1, help="seed of all draws")
    parser.add_argument("--output", type=Path, default=Path("paper_search.csv"), help="table of all candidates")
    chosen = parser.parse_args()
    if chosen.whole:
        chosen.wells, chosen.motions = list(WELLS), list(MOTIONS)
        chosen.surveys, chosen.kept, chosen.rounds, chosen.draws, chosen.confirmed = 512, 8, 2, 12, 2
    return chosen


def main() -> None:
    """Search, and print the best."""
    chosen = arguments()
    client = Client()
    rng = np.random.default_rng(chosen.seed)
    preset = client.run(PRESET, set={"effects.transient": "off"}, name="the preset's survey").wait().point(1).scenario
    ranges = SURVEY if chosen.printed_loads else {**SURVEY, **LOADS}
    as_shipped = {path: number(preset, path) for path in ranges}
    asked = []
    for well in chosen.wells:
        points = [as_shipped, *seated(client, well, ranges, chosen.surveys, chosen.doglegs, chosen.kept, chosen.seed)]
        asked += [(Reading(well, name), points) for name in chosen.motions]
    candidates = compared(client, asked)
    show("drawn over the whole ranges", candidates)
    for size in (0.3, 0.1)[: chosen.rounds]:
        leaders = best_by_reading(candidates)[:4]
        draws = [
            (leader.reading, around(leader, ranges, size, chosen.doglegs, chosen.draws, rng)) for leader in leaders
        ]
        candidates = sorted([*candidates, *compared(client, draws)], key=lambda candidate: candidate.cost)
        show(f"with draws within {size:g} of the ranges around the best of four readings", candidates)
    save(candidates, chosen.output)
    for candidate in best_by_reading(candidates)[: chosen.confirmed]:
        confirm(client, candidate, chosen.neighbours)


def number(scenario: dict[str, Any], path: str) -> float:
    """Return the number at a path of a scenario, such as `well.survey[0].azimuth_deg`."""
    value: Any = scenario
    for name in path.replace("[", ".").replace("]", "").split("."):
        value = value[int(name)] if isinstance(value, list) else value[name]
    return float(value)


if __name__ == "__main__":
    main()
