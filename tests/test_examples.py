"""The examples, run as they stand but for the length of the runs."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import nbclient
import nbformat
import numpy as np
import pytest

from drillsweep import Client
from service import REPOSITORY, Service

SHORT = (
    '"duration": 0.5, "accuracy": "draft", "recording.spectrum_windows": [], '
    '"recording.orbit_window": {"from": 0.1, "to": 0.5}'
)
SHORTER = {
    '    "paper-200m-damped",\n': f'    "paper-200m-damped",\n    set={{{SHORT}}},\n',
    '"preset": "paper-200m-damped",': f'"preset": "paper-200m-damped", "set": {{{SHORT}}},',
    "(15.0, 25.0), (14.5, 26.0), (50.0, 60.0)": "(0.1, 1.1), (0.1, 1.2), (0.2, 1.2)",
}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    data = tmp_path_factory.mktemp("data")
    service = Service("up", "--workers", "2", "--listen", "127.0.0.1:0", "--data", str(data))
    yield service.server
    service.stop()


def shortened(name: str, directory: Path) -> Path:
    text = (REPOSITORY / "examples" / name).read_text()
    for long, short in SHORTER.items():
        text = text.replace(long, short)
    script = directory / name
    script.write_text(text)
    return script


def run(name: str, interpreter: str, server: str, directory: Path, *arguments: str) -> str:
    script = shortened(name, directory)
    environment = {**os.environ, "DRILLSWEEP_SERVER": server, "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [interpreter, script, *arguments], cwd=directory, env=environment, capture_output=True, text=True, check=False
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


def test_the_scorecard_shows_values_of_the_runs(server: str, tmp_path: Path) -> None:
    shortened("paper_search.py", tmp_path)
    printed = run("paper_scorecard.py", sys.executable, server, tmp_path, "--quick", "--accuracy", "draft")
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in printed.splitlines() if "[0.1" in line]
    names = ("section 4.3, without mud", "section 4.3, with mud")
    with Client(server) as client:
        points = {sweep.name: sweep.point(1) for sweep in client.sweeps() if sweep.name in names}
        orbits = [points[name].orbit(node=node, time=(0.1, 1.1)) for name in names for node in (10, 49, 282)]
    assert [row[0] for row in rows] == ["10", "49", "282"] * 2
    for orbit, (_, _, offset, size, _, _, _, line) in zip(orbits, rows, strict=True):
        # Straight from the samples, by NumPy.
        position = 1e3 * (orbit["u"] + 1j * orbit["v"])
        assert float(offset) == pytest.approx(abs(position.mean()), abs=0.005)
        assert float(size) == pytest.approx(np.std(position), abs=0.005)
        window = np.hanning(len(position) + 1)[:-1]
        spectrum = np.abs(np.fft.fft(position * window)) / window.sum()
        frequency, amplitude = (float(part) for part in re.findall(r"[\d.]+", line))
        # Lines lie between bins, where Hann's weights lower the highest of them by up to 15 %.
        highest = spectrum[round(frequency)]
        assert 0.84 * amplitude - 0.005 <= highest <= amplitude + 0.005


def test_the_search_puts_the_best_first(server: str, tmp_path: Path) -> None:
    size = ["--surveys", "2", "--rounds", "1", "--draws", "1", "--confirmed", "1", "--neighbours", "1"]
    run("paper_search.py", sys.executable, server, tmp_path, *size, "--motions", "free twist", "held twist")
    with (tmp_path / "paper_search.csv").open() as file:
        candidates = list(csv.DictReader(file))
    # Two readings, each with the preset's survey, one of the two drawn, and one drawn around its best.
    assert [candidate["motion"] for candidate in candidates].count("free twist") == len(candidates) / 2 == 3
    costs = [float(candidate["cost"]) for candidate in candidates]
    assert costs == sorted(costs)
    for candidate in candidates:
        # The hole leaves a drillpipe's body 44.45 mm, and a run that leaves it by millimetres is wrong.
        for mud in ("dry", "wet"):
            assert 0.0 < float(candidate[f"{mud}_offset"]) < 0.04445 + 2e-3
            assert float(candidate[f"{mud}_gap"]) >= 0.0
        assert 0.0 < float(candidate["cost"]) < 1.0
