"""The service against its own OpenAPI document, with requests that are drawn from it (schemathesis)."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from drillsweep import Client
from service import SHORT, Service

CONFIGURATION = """
[parameters]
"path.id" = "{id}"
"path.n" = 1
"query.node" = [10, 49, 282]

[[operations]]
include-operation-id = "get_artifact"
parameters = {{ "path.name" = "profile" }}

[[operations]]
include-operation-id = "delete_sweep"
parameters = {{ "query.dry_run" = true }}

# Modes take seconds.
[[operations]]
include-operation-id = "get_modes"
parameters = {{ "query.to_hz" = 2 }}

[[operations]]
include-operation-id = "get_scenario"
parameters = {{ "path.name" = "paper-200m" }}
"""


def test_service_keeps_to_its_document(tmp_path: Path) -> None:
    quick = ["--requests-per-second", "100000", "--request-burst", "100000"]
    service = Service("up", "--workers", "1", "--listen", "127.0.0.1:0", "--data", str(tmp_path / "data"), *quick)
    with Client(service.server) as client:
        # With all tables that a run can have.
        recording = {"recording.snapshots": {"rate_hz": 20}, "recording.orbit_window": "settled"}
        sweep = client.submit("paper-200m", set=SHORT | recording, axes={"flow_rate": [0.01, 0.02]}).wait(timeout=120.0)
    configuration = tmp_path / "schemathesis.toml"
    configuration.write_text(CONFIGURATION.format(id=sweep.id))
    command = [str(Path(sys.executable).with_name("schemathesis")), "--config-file", str(configuration), "run"]
    options = ["--seed", "1", "--max-examples", "20", "--request-timeout", "30", "--no-color", "--continue-on-failure"]
    # What can be simulated is more than a schema can say, and streams of events do not end.
    options += ["--exclude-checks", "positive_data_acceptance"]
    options += ["--exclude-operation-id", "follow_sweep"]
    # The drawn requests leave files where they are run.
    run = subprocess.run(
        [*command, f"{service.server}/openapi.json", *options], capture_output=True, text=True, cwd=tmp_path
    )
    service.stop()
    assert run.returncode == 0, run.stdout
    assert "Tested: 65" in run.stdout, run.stdout
    # The sweep was there for all but this: it has no cost study.
    _, _, missing = run.stdout.partition("Missing test data")
    without_data = re.findall(r"^  - (.+)$", missing.partition("💡")[0], re.MULTILINE)
    assert set(without_data) <= {"GET /v1/sweeps/{id}/points/{n}/cost"}, run.stdout
