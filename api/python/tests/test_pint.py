"""Results as quantities of pint."""

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

from drillsweep import Client, Sweep, quantity
from drillsweep.table import Table
from drillsweep.units import FAMILIES, to_pint
from service import REPOSITORY


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


def test_pint_is_imported_on_request_only() -> None:
    code = (
        "import sys; from drillsweep import quantity; assert 'pint' not in sys.modules\n"
        "sys.modules['pint'] = None; quantity('flow_rate').to_pint(1.0)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stderr.endswith("ImportError: this needs pint: pip install 'drillsweep[pint]'\n"), run.stderr
