"""What the client makes of requests and answers, apart from any service."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillsweep import Client, NotFound, Range, Sweep
from drillsweep.client import _event_fields


def test_event_streams_are_read_as_the_standard_says() -> None:
    # The first and third examples of WHATWG HTML section 9.2.6.
    stocks = ["data: YHOO", "data: +2", "data: 10", ""]
    assert list(_event_fields(iter(stocks))) == [{"data": "YHOO\n+2\n10"}]
    stream = [
        ": test stream",
        "",
        "data: first event",
        "id: 1",
        "",
        "data:second event",
        "id",
        "",
        "data:  third event",
    ]
    events = [*stream, ""]
    assert [event["data"] for event in _event_fields(iter(events))] == ["first event", "second event", " third event"]
    assert list(_event_fields(iter(["data: incomplete"]))) == [], "an event ends with an empty line"


def test_an_interval_is_a_range_without_a_count() -> None:
    assert Range(1.0, 2.0, 3).to_json() == {"from": 1.0, "to": 2.0, "count": 3, "scale": "linear"}
    assert Range(1.0, 2.0, scale="log").to_json() == {"from": 1.0, "to": 2.0, "scale": "log"}


def test_downloads_are_whole_or_absent(client: Client, sweep: Sweep, tmp_path: Path) -> None:
    file = client.download(f"{sweep.path}/table", tmp_path / "table.csv", {"format": "csv"})
    assert len(file.read_text().splitlines()) == 5
    with pytest.raises(NotFound):
        client.download("/v1/sweeps/none/table", tmp_path / "none.csv", {"format": "csv"})
    assert list(tmp_path.iterdir()) == [file]
