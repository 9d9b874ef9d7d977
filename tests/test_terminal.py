"""Commands on a terminal: progress is drawn there alone, and an interrupt ends them."""

from __future__ import annotations

import os
import pty
import signal
import subprocess

from service import binary

PLAN = ["plan", "paper-200m"]


def on_a_terminal() -> tuple[subprocess.Popen[bytes], int]:
    """The process of a plan, and the other side of its terminal."""
    reader, terminal = pty.openpty()
    environment = {**os.environ, "TERM": "xterm"}
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


def test_a_plan_names_the_part_in_work_on_a_terminal() -> None:
    process, reader = on_a_terminal()
    text = read_to(reader, b"follows from it\r\n")
    assert process.wait(60.0) == 0
    os.close(reader)
    drawn = text.partition(b"effects\r\n")[0]
    assert b"speed of this machine, 0s" in drawn
    assert b"equilibrium, 0s" in drawn


def test_an_interrupt_ends_a_plan_while_it_measures_the_machine() -> None:
    process, reader = on_a_terminal()
    read_to(reader, b"speed of this machine")
    process.send_signal(signal.SIGINT)
    assert process.wait(60.0) == -signal.SIGINT
    os.close(reader)


def test_a_plan_in_a_pipe_has_no_progress() -> None:
    plan = subprocess.run([binary(), *PLAN], check=True, capture_output=True, text=True)
    assert plan.stderr == ""
    assert plan.stdout.startswith("effects\n")
