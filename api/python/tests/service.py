"""The drillsweep binary as processes that can be stopped and killed."""

from __future__ import annotations

import json
import os
import re
import subprocess
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).parents[3]

SHORT: dict[str, Any] = {
    "duration": 0.5,
    "accuracy": "draft",
    "recording.spectrum_windows": [],
    "recording.orbit_window": {"from": 0.1, "to": 0.5},
}
"""Changes that make the paper's case a matter of tenths of a second."""


def binary() -> str:
    """The drillsweep binary: that of DRILLSWEEP_BINARY, or else what cargo built last for tests."""
    target = Path(os.environ.get("CARGO_TARGET_DIR") or REPOSITORY / "target")
    path = Path(os.environ.get("DRILLSWEEP_BINARY") or target / "debug" / "drillsweep")
    assert path.exists(), f"{path} is missing: cargo build"
    return str(path)


class Service:
    """`drillsweep` in a role that listens, as a process that can be killed."""

    def __init__(self, *arguments: str, environment: Mapping[str, str] | None = None) -> None:
        environment = {**(os.environ if environment is None else environment), "NO_COLOR": "1"}
        command = [binary(), *arguments]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
        assert self.process.stderr is not None
        log = self.process.stderr
        address = next((match for line in log if (match := re.search(r"http://[\d.:]+", line))), None)
        assert address is not None, "the server ended before it listened"
        self.server = address.group()
        # Read on, so that the pipe never fills.
        self._drain = threading.Thread(target=log.read, daemon=True)
        self._drain.start()

    def stop(self) -> None:
        self.process.terminate()
        self._end()

    def kill(self) -> None:
        self.process.kill()
        self._end()

    def _end(self) -> None:
        self.process.wait(60.0)
        self._drain.join(60.0)
        assert self.process.stderr is not None
        self.process.stderr.close()


def make_token(data: Path, scope: str) -> str:
    command = [binary(), "token", "create", "--owner", "anne", "--scope", scope, "--data", str(data)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def tokens_of(data: Path) -> set[str]:
    """The identifiers of the tokens there are."""
    command = [binary(), "token", "list", "--json", "--data", str(data)]
    listed = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    return {token["id"] for token in listed}


def revoke_token(data: Path, token: str) -> None:
    command = [binary(), "token", "revoke", token, "--data", str(data)]
    subprocess.run(command, capture_output=True, text=True, check=True)
