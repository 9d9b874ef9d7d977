"""Results of section 4 of the paper behind the base case, measured in runs of a service, as tables in Markdown.

The equilibrium; three nodes with and without mud, in four runs each whose weight on bit differs by a newton; and the
sweep of section 4.4. docs/validation.md compares the numbers with those of Tran et al. 2019 (Journal of Sound and
Vibration 462, 114924). Needs `drillsweep` and NumPy. `--quick` leaves out neighbours and sweep.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence

import numpy as np
from paper_search import (
    CONTACT_WINDOW,
    DAMPING,
    LINE_WINDOW,
    NODE,
    PRESET,
    STEADY_WINDOW,
    Motion,
    is_tool_joint,
    motion,
)

from drillsweep import Client, Point

NODES = (10, NODE, 282)
DENSITIES = (1200.0, 1500.0, 1800.0, 2100.0)  # kg/m3
FLOW_RATES = (0.01, 0.04, 0.06)  # m3/s
ORBIT_WINDOW = (40.0, 60.0)  # s, figure 19
MEASURES = ("offset mm", "size mm", "off the wall mm", "contacts", "backward line Hz (mm)", "forward line Hz (mm)")
"""Columns of an orbit: distance of its mean from the hole's axis, size about it, gap to the wall, contacts, lines."""


def equilibrium(point: Point) -> Iterable[Sequence[object]]:
    """Yield the results of section 4.2: contacts of the string, its position, and the mud's coefficients."""
    statics, profile = point.statics(), point.profile()
    touches = statics["normal_force"] > 0.0
    for name, part in (("tool joints", is_tool_joint(statics)), ("collars", statics["measured_depth"] > 89.5)):
        yield f"nodes of {name} on the wall", f"{np.sum(touches & part)} of {np.sum(part)}"
    here = statics["node"] == NODE
    yield f"depth of node {NODE} m", f"{statics['measured_depth'][here][0]:.2f}"
    yield f"radius of node {NODE} mm", f"{1e3 * statics['radius'][here][0]:.2f}"
    yield "largest u, v mm", ", ".join(f"{1e3 * np.abs(statics[name]).max():.1f}" for name in ("u", "v"))
    for name, label in (("friction_coefficient", "C_f"), ("apparent_viscosity", "nu_f m2/s")):
        yield label, f"{profile[name].min():.3g} to {profile[name].max():.3g}"


def orbit(point: Point, node: int, window: tuple[float, float]) -> Motion:
    """Return the motion of a node over a window, contacts over one of 23 revolutions if it is the paper's first."""
    return motion(point, node, window, CONTACT_WINDOW if window == LINE_WINDOW else window)


def span(values: Sequence[float], digits: int, factor: float = 1.0) -> str:
    """Return the range of values, or the one that they all are."""
    return " to ".join(dict.fromkeys(f"{factor * end:.{digits}f}" for end in (min(values), max(values))))


def measured(motions: Sequence[Motion]) -> Sequence[str]:
    """Return the cells of runs that differ by their start only: MEASURES, in ranges over the runs."""
    return (
        *(span([getattr(of, name) for of in motions], 2, 1e3) for name in ("offset", "size", "gap")),
        span([of.contacts for of in motions], 0),
        *(
            f"{span([getattr(of, whirl) for of in motions], 3)} "
            f"({span([getattr(of, whirl + '_amplitude') for of in motions], 2, 1e3)})"
            for whirl in ("backward", "forward")
        ),
    )


def influence(point: Point) -> Sequence[object]:
    """Return the row of a point in the sweep of section 4.4."""
    friction, damping = (point.profile()[name] for name in ("friction_coefficient", "rotation_damping"))
    return (
        *(f"{point.parameters[name]:g}" for name in ("flow_rate", "mud_density")),
        *(f"{of.min():.3g} to {of.max():.3g}" for of in (friction, damping)),
        *measured([orbit(point, NODE, ORBIT_WINDOW)]),
    )


def show(title: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Print a table in Markdown."""
    print(f"{title}\n\n| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(str(cell) for cell in row)} |")
    print(flush=True)


def main() -> None:
    """Run, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="one run with mud and one without")
    parser.add_argument("--accuracy", default="standard", help="accuracy of all runs")
    parser.add_argument("--preset", default=PRESET, help="scenario with mud")
    chosen = parser.parse_args()
    client = Client()
    weights = [-1e5 + newton for newton in range(1 if chosen.quick else 4)]
    axes = {"operation.weight_on_bit": weights}
    changes = {"duration": STEADY_WINDOW[1], "accuracy": chosen.accuracy, **DAMPING}
    wet = client.submit(chosen.preset, set=changes, axes=axes, name="section 4.3, with mud")
    dry = client.submit(chosen.preset, set={**changes, "mud": None}, axes=axes, name="section 4.3, without mud")

    show("Equilibrium", ("result", "value"), equilibrium(wet.wait().point(1)))
    for title, sweep in (("Without mud", dry), ("With mud", wet)):
        points = list(sweep.wait().points("succeeded"))
        rows = [
            (node, f"[{window[0]:g}, {window[1]:g})", *measured([orbit(point, node, window) for point in points]))
            for node in NODES
            for window in (LINE_WINDOW, STEADY_WINDOW)
        ]
        show(title, ("node", "window s", *MEASURES), rows)
    if chosen.quick:
        return
    sweep = client.submit(
        chosen.preset, set=changes, axes={"flow_rate": FLOW_RATES, "mud_density": DENSITIES}, name="section 4.4"
    )
    head = ("flow rate m3/s", "mud density kg/m3", "C_f", "k N s/m2", *MEASURES)
    show("Node 49 over [40, 60) s", head, map(influence, sweep.wait().points("succeeded")))


if __name__ == "__main__":
    main()
