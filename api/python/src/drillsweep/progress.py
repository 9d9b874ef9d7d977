"""The progress bar of a sweep."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from drillsweep.sweep import Sweep

_WIDTH = 30


def is_interactive(stream: TextIO) -> bool:
    """Whether a stream can show a bar: a terminal or a notebook."""
    return stream.isatty() or "ipykernel" in sys.modules


class ProgressBar:
    """Shows a sweep in one line, rewritten with each change."""

    def __init__(self, stream: TextIO | None = None) -> None:
        """A bar on a stream; standard error unless given."""
        self._stream = stream or sys.stderr
        self._start = time.monotonic()
        self._first: float | None = None
        self._width = 0

    def show(self, sweep: Sweep) -> None:
        """Writes the sweep's line over the one before."""
        if self._first is None:
            self._first = sweep.progress
        elapsed = time.monotonic() - self._start
        filled = round(_WIDTH * sweep.progress)
        bar = "#" * filled + "." * (_WIDTH - filled)
        counts = sweep.counts
        text = f"[{bar}] {sweep.progress:4.0%} {counts.succeeded} of {counts.total} points, {counts.running} running"
        if counts.failed:
            text += f", {counts.failed} failed"
        if sweep.verified:
            text += f", {sweep.verified.succeeded} of {sweep.verified.total} verified"
        if sweep.waiting_for:
            text += ", waiting for a worker"
        text += f", {_clock(elapsed)}"
        done = sweep.progress - self._first
        if done > 0.0 and sweep.progress < 1.0:
            text += f", {_clock(elapsed * (1.0 - sweep.progress) / done)} left"
        self._stream.write("\r" + text.ljust(self._width))
        self._stream.flush()
        self._width = len(text)

    def close(self) -> None:
        """Leaves the line as it is and goes to the next."""
        if self._width:
            self._stream.write("\n")
            self._stream.flush()
            self._width = 0


def _clock(seconds: float) -> str:
    minutes, seconds = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"
