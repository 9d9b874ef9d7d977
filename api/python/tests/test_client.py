"""What the client makes of requests and answers, apart from any service."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest

from drillsweep import Client, NotFound, Range, Sweep


def test_a_stream_goes_on_after_its_last_event_and_comments_are_no_events() -> None:
    asked = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request.headers.get("last-event-id"))
        if len(asked) == 3:
            return httpx.Response(204)
        stream = f': alive\n\nid: {len(asked)}\nevent: point\ndata: {{"number": {len(asked)}}}\n\n: alive\n\n'
        return httpx.Response(200, headers={"content-type": "text/event-stream"}, text=stream)

    with Client("http://service") as client:
        client._http = httpx.Client(base_url="http://service", transport=httpx.MockTransport(answer))
        assert list(client.events("/v1/events")) == [("point", {"number": 1}), ("point", {"number": 2})]
    assert asked == [None, "1", "2"]


def test_an_interval_is_a_range_without_a_count() -> None:
    assert Range(1.0, 2.0, 3).to_json() == {"from": 1.0, "to": 2.0, "count": 3, "scale": "linear"}
    assert Range(1.0, 2.0, scale="log").to_json() == {"from": 1.0, "to": 2.0, "scale": "log"}


def test_downloads_are_whole_or_absent(client: Client, sweep: Sweep, tmp_path: Path) -> None:
    file = client.download(f"{sweep.path}/table", tmp_path / "table.csv", {"format": "csv"})
    assert len(file.read_text().splitlines()) == 5
    with pytest.raises(NotFound):
        client.download("/v1/sweeps/none/table", tmp_path / "none.csv", {"format": "csv"})
    assert list(tmp_path.iterdir()) == [file]
