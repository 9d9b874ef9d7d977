"""The units for systemd: by its own verification if it is installed, and against the program's options."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from service import REPOSITORY, binary

FOLDER = REPOSITORY / "deploy" / "systemd"

PROGRAM = "/usr/local/bin/drillsweep"

SECONDS = {"drillsweep.service": 13, "drillsweep-worker@.service": 60}
"""How long each takes to end at most."""


def settings(file: Path) -> dict[str, dict[str, str]]:
    """The settings of a unit, by section."""
    sections: dict[str, dict[str, str]] = {}
    section: dict[str, str] = {}
    for line in file.read_text().splitlines():
        if line.startswith("["):
            section = sections.setdefault(line.strip("[]"), {})
        elif line and not line.startswith("#"):
            name, value = line.split("=", 1)
            assert name not in section, f"{name} of {file.name} stands there twice"
            section[name] = value
    return sections


def test_there_are_a_server_and_workers() -> None:
    assert {file.name for file in FOLDER.iterdir()} == set(SECONDS)


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd is not installed")
def test_systemd_accepts_the_units(tmp_path: Path) -> None:
    def complaints(spoilt: str) -> str:
        for file in FOLDER.iterdir():
            text = file.read_text().replace(PROGRAM, binary()).replace("NoNewPrivileges", spoilt)
            (tmp_path / file.name).write_text(text)
        units = [str(tmp_path / f"{name}.service") for name in ("drillsweep", "drillsweep-worker@1")]
        command = ["systemd-analyze", "verify", "--man=no", "--recursive-errors=no", *units]
        done = subprocess.run(command, capture_output=True, text=True)
        return done.stdout + done.stderr

    assert not complaints("NoNewPrivileges")
    assert "NoNewPrivilege" in complaints("NoNewPrivilege"), "a misspelt setting is found"


@pytest.mark.parametrize("name", SECONDS)
def test_units_are_fenced_in_and_run_the_program(name: str) -> None:
    unit = settings(FOLDER / name)
    service = unit["Service"]
    program, command, *options = service["ExecStart"].split()
    assert program == PROGRAM
    described = subprocess.run([binary(), command, "--help"], capture_output=True, text=True, check=True).stdout
    assert set(options) <= set(re.findall(r"--[a-z-]+", described))
    variable, directory = service["Environment"].split("=")
    assert variable in re.findall(r"\[env:\s+([A-Z_]+)", described)
    assert directory == f"/var/lib/{service['StateDirectory']}"
    fence = ["NoNewPrivileges", "PrivateTmp", "PrivateDevices", "ProtectHome", "RestrictNamespaces", "RestrictSUIDSGID"]
    assert {setting: service[setting] for setting in fence} == dict.fromkeys(fence, "yes")
    assert service["ProtectSystem"] == "strict"
    assert service["User"] == "drillsweep"
    assert (service["StateDirectoryMode"], service["UMask"]) == ("0700", "0077")
    assert re.fullmatch(r"\d+[MG]", service["MemoryMax"])
    assert service["Restart"] == "on-failure"
    assert int(service["TimeoutStopSec"]) > SECONDS[name]
    assert unit["Install"]["WantedBy"] == "multi-user.target"
