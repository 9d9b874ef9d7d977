"""The vocabulary of quantities."""

import pytest

from drillsweep import Client, Sweep, quantity


def test_names_lead_to_their_quantity() -> None:
    for name, of in [
        ("flow_rate", "flow_rate"),
        ("u_49", "u"),
        ("theta_z_rate_282", "theta_z_rate"),
        ("spread_orbit_radius_rms_49", "orbit_radius_rms"),
        ("bias_line_frequency_hz_49_w1", "line_frequency_hz"),
        ("line_amplitude_12_5m_above_bit_w1", "line_amplitude"),
        ("string.sections[1].tool_joint.length", "string.sections.tool_joint.length"),
    ]:
        found = quantity(name)
        assert found is not None
        assert found.name == of
    assert quantity("nothing_of_the_kind") is None
    assert quantity("mud.nothing") is None


def test_values_read_in_units_of_the_oil_field() -> None:
    # An 8.5 in hole; NIST SP 811 has the factors.
    for name, value, symbol, read in [
        ("well.hole_diameter", 0.2159, "in", 8.5),
        ("flow_rate", 0.04, "gpm", 634.01),
        ("mud_density", 1200.0, "ppg", 10.0145),
        ("operation.weight_on_bit", -1e5, "klbf", -22.4809),
        ("torque_top", 1e4, "ft lbf", 7375.62),
        ("bore_pressure", 1e7, "psi", 1450.38),
        ("measured_depth", 200.0, "ft", 656.168),
    ]:
        found = quantity(name)
        assert found is not None
        assert found.field.symbol == symbol
        assert found.field.of(value) == pytest.approx(read, rel=1e-5)


def test_classes_have_their_order_and_colours() -> None:
    found = quantity("class")
    assert found is not None
    assert list(found.words)[:3] == ["failed", "buckled", "stick_slip"]
    assert found.words["quiet"] == "#009e73"


def test_units_are_those_that_tables_are_served_with(sweep: Sweep) -> None:
    point = sweep.point(1)
    tables = [sweep.table(), point.profile(), point.statics(), point.history(), point.contacts(), point.energy()]
    for table in tables:
        for name in table:
            found = quantity(name)
            assert found is not None, name
            assert found.unit == table.units.get(name), name


def test_the_service_has_the_same_vocabulary(client: Client) -> None:
    served = client.quantities()
    assert set(served) > {"u", "flow_rate", "string.sections.length"}
    for name, found in served.items():
        assert quantity(name) == found
