"""The examples, run as they stand but for the length of the runs."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import nbclient
import nbformat
import pytest

from service import REPOSITORY, Service

SHORTER = {
    '"duration": 60': '"duration": 0.5, "accuracy": "draft", "recording.spectrum_windows": [], '
    '"recording.orbit_window.from": 0.1, "recording.orbit_window.to": 0.5',
    "time=(40, 60)": "time=(0.1, 0.5)",
    "time=(50, 60)": "time=(0.1, 0.5)",
    "from=50&to=60": "from=0.1&to=0.5",
}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    data = tmp_path_factory.mktemp("data")
    service = Service("up", "--workers", "2", "--listen", "127.0.0.1:0", "--data", str(data))
    yield service.server
    service.stop()


def run(name: str, interpreter: str, server: str, directory: Path) -> str:
    text = (REPOSITORY / "examples" / name).read_text()
    for long, short in SHORTER.items():
        text = text.replace(long, short)
    script = directory / name
    script.write_text(text)
    environment = {**os.environ, "DRILLSWEEP_SERVER": server, "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [interpreter, script], cwd=directory, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_python_and_curl_give_the_same_table(server: str, tmp_path: Path) -> None:
    of_python = [line.split() for line in run("sweep.py", sys.executable, server, tmp_path).splitlines()[1:]]
    assert (tmp_path / "sweep.png").read_bytes().startswith(b"\x89PNG")
    lines = run("sweep.sh", "bash", server, tmp_path).splitlines()
    of_curl = [line.split("\t") for line in lines if "\t" in line]
    assert len(of_curl) == 12
    for python, curl in zip(of_python, of_curl, strict=True):
        assert [float(value) for value in python] == pytest.approx([float(value) for value in curl], rel=1e-3, abs=1e-6)
    peaks = [json.loads(line) for line in lines if line.startswith("{")]
    assert peaks[0]["amplitude"] == max(peak["amplitude"] for peak in peaks)


def test_the_guide_shows_the_example_as_it_is() -> None:
    assert (REPOSITORY / "examples" / "sweep.py").read_text() in (REPOSITORY / "docs" / "guide.md").read_text()


def test_the_notebook_draws_the_papers_figures(server: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DRILLSWEEP_SERVER", server)
    monkeypatch.setenv("ACCURACY", "draft")
    text = (REPOSITORY / "examples" / "paper_figures.ipynb").read_text()
    notebook = nbformat.reads(text, as_version=4)  # type: ignore[no-untyped-call]
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": tmp_path}}).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 8
    printed = "".join(output.get("text", "") for output in outputs)
    # The paper's: the mud damps less the faster it flows and, to a smaller extent, the denser it is.
    friction = {
        name: [float(of) for of in re.findall(rf"{name} .* C_f up to (\S+)", printed)]
        for name in ("flow_rate", "mud_density")
    }
    for values in friction.values():
        assert len(values) == 4
        assert values == sorted(values, reverse=True)
        assert values[0] > values[-1]
    assert friction["flow_rate"][-1] < friction["mud_density"][-1]
