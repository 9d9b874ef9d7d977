"""A real server with two workers, and one sweep on it that most tests look at."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from drillsweep import Axis, Client, Sweep
from service import SHORT, Service


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    data = tmp_path_factory.mktemp("data")
    # With a short lease, workers hear of a cancellation within a second.
    options = ["--workers", "2", "--lease-seconds", "3", "--listen", "127.0.0.1:0"]
    service = Service("up", *options, "--data", str(data))
    yield service.server
    service.stop()


@pytest.fixture(scope="session")
def client(server: str) -> Iterator[Client]:
    with Client(server) as client:
        yield client


@pytest.fixture(scope="session")
def sweep(client: Client) -> Sweep:
    """Four points, complete."""
    axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1200, 1800]}
    return client.submit("paper-200m", set=SHORT, axes=axes, name="short").wait(timeout=120.0)
