"""The array of workers for Slurm, under a stand-in of Slurm: no cluster is needed, and none is tried."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from drillsweep import Axis, Client
from service import REPOSITORY, SHORT, Service, binary

SCRIPT = REPOSITORY / "deploy" / "slurm" / "workers.sbatch"


def until(reached: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 120.0
    while not reached():
        assert time.monotonic() < deadline, "not reached in time"
        time.sleep(0.05)


class Slurm:
    """As much of `sbatch` as the script asks for: an array, and a signal to the batch shell before its time is over."""

    def __init__(self, environment: dict[str, str]) -> None:
        text = SCRIPT.read_text()
        self.options = dict(re.findall(r"^#SBATCH --([a-z-]+)(?:=(\S+))?$", text, re.MULTILINE))
        self.environment = environment
        self.tasks: list[subprocess.Popen[bytes]] = []

    def submit(self, tasks: int, **environment: str) -> None:
        """`sbatch --array=1-TASKS`, all of them started at once."""
        for task in range(1, tasks + 1):
            own = {"SLURM_ARRAY_TASK_ID": str(task), **environment}
            self.tasks.append(subprocess.Popen(["bash", str(SCRIPT)], env={**self.environment, **own}))

    def time_is_nearly_over(self) -> None:
        """Sends the signal of `--signal`: to the batch shell alone, whatever it has started."""
        to, name = re.fullmatch(r"(B):([A-Z]+)@\d+", self.options["signal"]).groups()  # type: ignore[union-attr]
        assert to == "B"
        for task in self.tasks:
            task.send_signal(signal.Signals[f"SIG{name}"])

    def ended(self) -> list[int]:
        """The exit statuses of all tasks, within the time that the signal leaves them."""
        left = float(self.options["signal"].rpartition("@")[2])
        statuses = [task.wait(left) for task in self.tasks]
        self.tasks = []
        return statuses


@pytest.fixture
def site(tmp_path: Path) -> Iterator[tuple[Client, Slurm]]:
    shared = {
        "DRILLSWEEP_DATABASE": str(tmp_path / "drillsweep.sqlite"),
        "DRILLSWEEP_OBJECTS": str(tmp_path / "objects"),
    }
    service = Service("serve", "--listen", "127.0.0.1:0", environment={**os.environ, **shared})
    programs = f"{Path(binary()).parent}:{os.environ['PATH']}"
    slurm = Slurm({**os.environ, **shared, "PATH": programs, "TMPDIR": str(tmp_path)})
    with Client(service.server) as client:
        yield client, slurm
    for task in slurm.tasks:
        task.kill()
        task.wait()
    service.stop()


@pytest.fixture
def calm(tmp_path: Path) -> Iterator[Client]:
    """A service that nothing happens to."""
    service = Service("up", "--workers", "2", "--listen", "127.0.0.1:0", "--data", str(tmp_path / "calm"))
    with Client(service.server) as client:
        yield client
    service.stop()


def test_points_outlast_the_time_of_a_job_and_end_with_the_same_numbers(
    site: tuple[Client, Slurm], calm: Client, tmp_path: Path
) -> None:
    client, slurm = site
    changes = {**SHORT, "duration": 6}
    axes: dict[str, Axis] = {"flow_rate": [0.013, 0.047], "mud_density": [1230]}
    sweep = client.submit("paper-200m", set=changes, axes=axes)
    # A simulated second takes one at least: no point comes to its end before its job does.
    slurm.submit(2, DRILLSWEEP_PACE="1")
    until(lambda: sweep.refresh().counts.running == 2)
    time.sleep(1.5)
    slurm.time_is_nearly_over()
    assert slurm.ended() == [0, 0]
    counts = sweep.refresh().counts
    assert (counts.queued, counts.succeeded) == (2, 0), "given back, not failed"

    slurm.submit(1)
    assert slurm.ended() == [0], "it ends when there is nothing left to do"
    assert sweep.refresh().counts.succeeded == 2
    points = list(sweep.points())
    assert all(point.attempts == 1 for point in points), "a point that is given back is no failed attempt"
    provenances = [point.provenance or {} for point in points]
    assert all(provenance["resumed"] for provenance in provenances), "it went on, and did not begin again"
    alone = calm.submit("paper-200m", set=changes, axes=axes).wait(timeout=120.0, progress=False)
    ours = client.save(f"{sweep.path}/table", tmp_path / "ours.csv", {})
    theirs = calm.save(f"{alone.path}/table", tmp_path / "theirs.csv", {})
    assert ours.read_bytes() == theirs.read_bytes()


def test_a_job_reports_missing_settings() -> None:
    clean = {"PATH": os.environ["PATH"], "DRILLSWEEP_DATABASE": "here"}
    refused = subprocess.run(["bash", str(SCRIPT)], env=clean, capture_output=True, text=True, check=False)
    assert refused.returncode != 0
    assert "DRILLSWEEP_OBJECTS: the URL of the object store" in refused.stderr
