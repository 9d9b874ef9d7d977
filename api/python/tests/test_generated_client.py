"""A client generated from the OpenAPI document submits sweeps with axes of every form, and reads them back."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from service import REPOSITORY, SHORT

# Flow rates that no other test has computed on the same service.
AXES: list[tuple[dict[str, Any], dict[str, Any]]] = [
    ({"flow_rate": {"values": [0.013, 0.017]}}, {}),
    ({"flow_rate": {"from": 0.013, "to": 0.043, "count": 3}}, {}),
    ({"flow_rate": {"from": 0.013, "to": 0.043, "count": 3, "scale": "log"}}, {}),
    ({"flow_rate": {"from": 0.013, "to": 0.043}}, {"design": "sobol", "samples": 3}),
    ({"flow_rate": {"from": 0.013, "to": 0.043, "scale": "log"}}, {"design": "latin_hypercube", "samples": 3}),
]


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The name of a package that openapi-python-client has made."""
    directory = tmp_path_factory.mktemp("generated")
    settings = directory / "settings.yaml"
    settings.write_text("package_name_override: generated_client\npost_hooks: []\n")
    document = REPOSITORY / "api" / "openapi.json"
    command = ["generate", "--path", str(document), "--config", str(settings), "--meta", "none"]
    command += ["--output-path", str(directory / "generated_client")]
    made = subprocess.run(
        [Path(sys.executable).parent / "openapi-python-client", *command], capture_output=True, text=True, check=False
    )
    assert made.returncode == 0, made.stdout + made.stderr
    sys.path.insert(0, str(directory))
    return "generated_client"


def test_axes_of_every_form_go_there_and_back(generated: str, server: str) -> None:
    package = importlib.import_module(generated)
    models = importlib.import_module(f"{generated}.models")
    submit = importlib.import_module(f"{generated}.api.sweeps.create_sweep")
    read = importlib.import_module(f"{generated}.api.sweeps.get_sweep")
    with package.Client(base_url=server) as client:
        for axes, design in AXES:
            document = {"preset": "paper-200m", "set": SHORT, "axes": axes, **design}
            request = models.SweepRequest.from_dict(document)
            assert request.to_dict()["axes"] == axes
            answer = submit.sync_detailed(client=client, body=request)
            assert answer.status_code == 201, answer.content
            sweep = read.sync(client=client, id=answer.parsed.id)
            assert sweep.counts.total == (2 if "values" in axes["flow_rate"] else 3)
            assert sweep.request.to_dict()["axes"]["flow_rate"].items() >= axes["flow_rate"].items()
