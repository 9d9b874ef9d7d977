"""Tokens: what is refused without, and with one that does not allow it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from drillsweep import Client, Forbidden, Unauthorized
from service import SHORT, Service, make_token


@pytest.fixture
def guarded(tmp_path: Path) -> Iterator[tuple[str, dict[str, str]]]:
    """A server that wants tokens, and one of each scope."""
    tokens = {scope: make_token(tmp_path, scope) for scope in ("read", "submit")}
    service = Service("serve", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    yield service.server, tokens
    service.stop()


def test_a_token_allows_its_scope(guarded: tuple[str, dict[str, str]], monkeypatch: pytest.MonkeyPatch) -> None:
    server, tokens = guarded
    with Client(server) as stranger, pytest.raises(Unauthorized):
        stranger.queue()
    with Client(server, token="not one of its tokens, but long enough") as stranger, pytest.raises(Unauthorized):
        stranger.queue()
    with Client(server, token=tokens["read"]) as reader:
        assert list(reader.sweeps()) == []
        with pytest.raises(Forbidden):
            reader.run("paper-200m", set=SHORT)
    monkeypatch.setenv("DRILLSWEEP_TOKEN", tokens["submit"])
    with Client(server) as anne:
        assert anne.run("paper-200m", set=SHORT).owner == "anne"
