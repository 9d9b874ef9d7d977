"""Quantities of pint, as values of requests and as results."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import pint
import pytest

from drillsweep import Axis, Client, InvalidRequest, Range, Sweep, quantity
from drillsweep.table import Table
from drillsweep.units import FAMILIES, from_pint, to_pint
from service import REPOSITORY, SHORT

Q = pint.UnitRegistry().Quantity
"""Quantities of another registry than the application's."""


def service_units() -> Iterator[tuple[str, str, tuple[str, ...], float]]:
    """Dimension, its first unit, symbols and exact size in the first, of every unit of the service."""
    source = (REPOSITORY / "quantity" / "src" / "entry.rs").read_text()
    dimension = first = ""
    entry = r'Family \{\s*dimension: "([^"]+)"|(?:unit|quotient)\(&\[([^]]+)\],\s*"([\d.]+)"(?:,\s*"([\d.]+)")?'
    for family, listed, size, divisor in re.findall(entry, source):
        if family:
            dimension, first = family, ""
        else:
            symbols = tuple(re.findall(r'"([^"]+)"', listed))
            first = first or symbols[0]
            yield dimension, first, symbols, float(Fraction(size) / Fraction(divisor or 1))


def test_every_unit_of_the_service_has_its_size_in_pint() -> None:
    units = list(service_units())
    assert len({dimension for dimension, *_ in units}) == len(FAMILIES) + 1, "all but the consistency"
    for dimension, first, symbols, size in units:
        if dimension == "consistency":
            with pytest.raises(ValueError, match="pint has no unit"):
                to_pint(1.0, symbols[0], first)
            continue
        family = next(family for family in FAMILIES if first in family)
        for symbol in {symbols[0], *family} & {*symbols}:
            one = to_pint(1.0, symbol, first)
            assert one.m_as(family[first]) == pytest.approx(size, rel=1e-12), symbol
        own = {symbol for _, other, listed, _ in units if other == first for symbol in listed}
        assert own >= set(family), "the service reads every symbol"


def test_units_of_the_vocabulary_have_its_sizes(client: Client) -> None:
    for name, known in client.quantities().items():
        for unit in (known.shown, known.field):
            if known.unit is not None and "s^n" not in known.unit:
                one = to_pint(1.0, unit.symbol or known.unit, known.unit)
                assert one.m_as(known.to_pint(1.0).units) == pytest.approx(unit.size, rel=1e-12), name


def test_tables_in_any_units_are_the_same_quantities(sweep: Sweep) -> None:
    point = sweep.point(1)
    views = [point.lines, point.contacts, point.loads, point.energy, point.history, sweep.table]
    for view in views:
        kept = view()
        for units in ("si", "field"):
            read = view(units=units).to_pint()
            assert list(read) == list(kept)
            for name, unit in kept.units.items():
                if name in kept and len(kept[name]) > 0:
                    # The served unit in pint's own notation; recorded samples have single precision.
                    plain = re.sub(r"(?<=[ms])([23])", r"**\1", unit)
                    np.testing.assert_allclose(read[name].m_as(plain), kept[name], rtol=2e-7, atol=0, err_msg=name)
    depth = point.orbit(node=49).attributes["measured_depth"]
    assert quantity("measured_depth").to_pint(depth).m_as("ft") == pytest.approx(depth / 0.3048)  # type: ignore[union-attr]


def test_columns_without_a_unit_of_pint_are_arrays() -> None:
    table = Table(
        {
            "state": ["failed", None],
            "mud.consistency": [0.5, 0.75],
            "mud.yield_stress": [10.0, None],
            "bias_orbit_radius_rms_49": [0.1, 0.2],
        },
        {"mud.consistency": "Pa s^n", "mud.yield_stress": "lbf/100 ft2", "bias_orbit_radius_rms_49": "1"},
    )
    read = table.to_pint()
    assert read["state"].tolist() == ["failed", ""]
    assert read["mud.consistency"].tolist() == [0.5, 0.75]
    # NIST SP 811: a pound-force per square foot is 47.88026 Pa.
    np.testing.assert_allclose(read["mud.yield_stress"].m_as("Pa"), [4.788026, np.nan], rtol=1e-7)
    assert read["bias_orbit_radius_rms_49"].dimensionless
    with pytest.raises(ValueError, match="state has no unit"):
        quantity("state").to_pint(1.0)  # type: ignore[union-attr]
    with pytest.raises(ValueError, match="pint has no unit Pa s"):
        quantity("mud.consistency").to_pint(1.0)  # type: ignore[union-attr]


def test_results_belong_to_the_registry_of_the_application() -> None:
    table = Table({"flow_rate": [0.04]}, {"flow_rate": "m3/s"})
    own: pint.UnitRegistry[Any] = pint.UnitRegistry()
    own.define("pump_stroke = 0.02 m**3")
    assert table.to_pint(own)["flow_rate"].m_as("pump_stroke/s") == pytest.approx([2.0])
    with pytest.raises(pint.UndefinedUnitError):
        table.to_pint()["flow_rate"].m_as("pump_stroke/s")
    application: Any = pint.application_registry
    former = application.get()
    application.set(own)
    try:
        assert table.to_pint()["flow_rate"].m_as("pump_stroke/s") == pytest.approx([2.0])
    finally:
        application.set(former)


def test_quantities_make_the_points_of_the_same_values_in_si(client: Client) -> None:
    def keys(set: dict[str, Any], **design: Any) -> list[str]:
        return [point.key for point in client.plan("paper-200m", set=SHORT | set, **design).points]

    gallon, pound = 231 * Fraction("0.0254") ** 3, Fraction("0.45359237")
    well = client.scenario("paper-200m")["well"]
    plain: dict[str, Axis] = {
        "flow_rate": [0.04, float(500 * gallon / 60)],
        "mud_density": Range(1200, float(12 * pound / gallon), 2),
    }
    axes: dict[str, Axis] = {
        "flow_rate": [Q(40, "liter/second"), Q(500, "gallon/minute")],
        "mud_density": Range(Q(1.2, "kg/liter"), Q(np.float64(12), "lb/gal"), 2),
    }
    in_si = keys({"well": well | {"hole_diameter": 0.2159}, "operation.rotation_speed_rpm": 90}, axes=plain)
    turning = {"well": well | {"hole_diameter": Q(8.5, "inch")}, "operation.rotation_speed_rpm": Q(1.5, "turn/s")}
    assert keys(turning, axes=axes) == in_si
    arrays = {"flow_rate": Q(np.array([40, 50]), "liter/s"), "mud_density": {"values": Q([75], "lb/ft**3")}}
    points = [{"flow_rate": Q(flow, "m^3/s"), "mud_density": "75 lb/ft3"} for flow in (0.04, 0.05)]
    assert keys({}, axes=arrays) == keys({}, points=points)


def test_units_that_the_service_lacks_are_converted() -> None:
    assert from_pint(Q(2, "mile"), "m") == (pytest.approx(3218.688), "m")
    assert from_pint(Q(1, "N*m"), "J") == (1, "J")
    assert from_pint(Q(10, "lbf/ft**2"), "Pa") == (pytest.approx(478.8026, rel=1e-7), "Pa")


def test_queries_and_limits_take_quantities(sweep: Sweep) -> None:
    point = sweep.point(1)
    metres = point.orbit(depth=57.73, time=(0.2, 0.4))
    assert point.orbit(depth=Q(189.40, "foot"), time=(Q(200, "ms"), 0.4)).columns == metres.columns
    drag = point.torque_drag(depths=Q([100, 200], "meter"), travelling_weight=Q(10, "kN"))
    assert drag.columns == point.torque_drag(depths=[100, 200], travelling_weight=1e4).columns
    column = "largest_lateral_acceleration_rms"
    diagnosis = point.diagnosis({column: Q(1.5, "standard_gravity")})
    assert diagnosis == point.diagnosis({column: "1.5 g"}) != point.diagnosis({column: None})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"axes": {"mud_density": [Q(12, "gal/min")]}},
            r"^/axes/mud_density/values/0: must have one of the units kg/m3",
        ),
        ({"axes": {"mud_density": Q(12, "lb/gal")}}, r"^/axes/mud_density: must be a Range, or a list"),
        ({"set": {"mud": {"density": Q(12, "")}}}, r"^/set/mud/density: must have one of the units kg/m3"),
        ({"set": {"mud.consistency": Q(1, "Pa*s**0.7")}}, r"^/set/mud.consistency: must have one of the units Pa s\^n"),
        # Pint takes a hertz for a radian per second, and a radian for 1.
        ({"set": {"operation.rotation_speed_rpm": Q(2, "Hz")}}, "must have one of the units rpm"),
        ({"set": {"recording.rate_hz": Q(120, "rpm")}}, "must have one of the units Hz"),
        ({"set": {"well.survey": [{"inclination_deg": Q(1, "")}]}}, r"inclination_deg: must have one of the units deg"),
        ({"points": [{"flow_rate": Q(1, "degC")}]}, r"^/points/0/flow_rate: must have one of the units m3/s"),
        ({"set": {"mud.densty": Q(1, "candela")}}, r"^/set/mud.densty: must have a unit of the service"),
    ],
)
def test_quantities_of_another_dimension_are_refused(client: Client, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        client.plan("paper-200m", **arguments)


def test_quantities_that_are_not_finite_and_unknown_fields_are_refused(client: Client, sweep: Sweep) -> None:
    with pytest.raises(ValueError, match=r"^/axes/flow_rate/values/1: must be finite"):
        client.plan("paper-200m", axes={"flow_rate": Q([1.0, np.nan], "gal/min")})
    with pytest.raises(TypeError, match=r"^depth: must have one of the units m"):
        sweep.point(1).orbit(depth=Q(3, "s"))
    with pytest.raises(InvalidRequest, match="densty"):
        client.plan("paper-200m", set={"mud.densty": Q(1, "kg/m**3")})


def test_pint_is_imported_on_request_only() -> None:
    code = (
        "import sys; from drillsweep import quantity; assert 'pint' not in sys.modules\n"
        "sys.modules['pint'] = None; quantity('flow_rate').to_pint(1.0)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stderr.endswith("ImportError: this needs pint: pip install 'drillsweep[pint]'\n"), run.stderr
