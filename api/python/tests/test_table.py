"""Tables by themselves."""

from drillsweep.table import Table


def test_rows_that_have_not_settled_are_known() -> None:
    regimes = ["regular", "not_settled", "irregular", "fixed", None]
    table = Table({"motion_regime": regimes, "growing_mode_hz": [None, None, None, 2.16, None]})
    assert table.unsettled.tolist() == [False, True, False, True, False]
    assert Table({"ordinal": [1, 2]}).unsettled.tolist() == [False, False]
