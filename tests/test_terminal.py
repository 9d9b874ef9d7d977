"""Commands on a terminal: progress is drawn there alone, and an interrupt ends them."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
from pathlib import Path

from service import binary

PLAN = ["plan", "paper-200m"]


def on_a_terminal(cache: Path) -> tuple[subprocess.Popen[bytes], int]:
    """The process of a plan with a directory for its cache, and the other side of its terminal."""
    reader, terminal = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "XDG_CACHE_HOME": str(cache)}
    process = subprocess.Popen(
        [binary(), *PLAN], stdin=terminal, stdout=terminal, stderr=terminal, env=environment, start_new_session=True
    )
    os.close(terminal)
    return process, reader


def read_to(reader: int, word: bytes) -> bytes:
    """Everything written to a terminal until a word is there; a process that ends before it fails the test."""
    text = b""
    while word not in text:
        # Linux reports the end of the other side as an error.
        text += os.read(reader, 4096)
    return text


def test_a_plan_names_the_part_in_work_on_a_terminal(tmp_path: Path) -> None:
    process, reader = on_a_terminal(tmp_path)
    text = read_to(reader, b"follows from it\r\n")
    assert process.wait(60.0) == 0
    os.close(reader)
    drawn = text.partition(b"effects\r\n")[0]
    assert b"speed of this machine, 0s" in drawn
    assert b"equilibrium, 0s" in drawn


def test_an_interrupt_ends_a_plan_while_it_measures_the_machine(tmp_path: Path) -> None:
    process, reader = on_a_terminal(tmp_path)
    read_to(reader, b"speed of this machine")
    process.send_signal(signal.SIGINT)
    assert process.wait(60.0) == -signal.SIGINT
    os.close(reader)
    assert list(tmp_path.iterdir()) == []


def test_the_speed_of_the_machine_is_measured_once_and_a_plan_in_a_pipe_has_no_progress(tmp_path: Path) -> None:
    def plan(*options: str) -> str:
        environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
        command = [binary(), *PLAN, *options]
        done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
        assert done.stderr == ""
        return done.stdout

    first, kept = plan(), plan()
    assert first.startswith("effects\n")
    assert "s to measure the machine, " in first.splitlines()[-1]
    [file] = (tmp_path / "drillsweep").iterdir()
    measured = json.loads(file.read_text())
    assert f"speed of the machine as measured on {measured['measured'][:10]}, " in kept.splitlines()[-1]
    # Processor times follow from the speed alone.
    assert first.splitlines()[:-1] == kept.splitlines()[:-1]
    assert json.loads(plan("--json"))["machine_speed"] == measured["speed"]
    file.write_text("{")
    assert json.loads(plan("--json"))["machine_speed"] != measured["speed"]
    assert json.loads(file.read_text())["measured"] != measured["measured"]
    assert "s to measure the machine, " in plan("--measure-speed").splitlines()[-1]
