"""Alerts and dashboard: against the metrics that a server shows, and by promtool if it is installed."""

from __future__ import annotations

import json
import re
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import yaml

from service import REPOSITORY, Service, binary

ALERTS = REPOSITORY / "deploy" / "prometheus"
DASHBOARD = REPOSITORY / "deploy" / "grafana" / "drillsweep.json"
LEVELS = REPOSITORY / "docs" / "slo.md"

NAME = re.compile(r"\b(?:drillsweep|process)_[a-z_]+\b")


@pytest.fixture(scope="module")
def metrics(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    data = str(tmp_path_factory.mktemp("data"))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        api = "{}:{}".format(*free.getsockname())
    # The metrics' address is logged first.
    listen = ["--metrics-listen", "127.0.0.1:0", "--listen", api]
    service = Service("serve", *listen, "--request-burst", "1", "--requests-per-second", "1", "--data", data)
    answers = []
    while 429 not in answers:
        answers.append(httpx.get(f"http://{api}/v1/queue").status_code)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        of_worker = "{}:{}".format(*free.getsockname())
    worker = subprocess.Popen([binary(), "worker", "--metrics-listen", of_worker, "--data", data])
    while True:
        try:
            of_worker_text = httpx.get(f"http://{of_worker}/metrics").text
        except httpx.ConnectError:
            of_worker_text = ""
        # It opens its store after it listens.
        if "drillsweep_worker" in of_worker_text:
            break
        assert worker.poll() is None
        time.sleep(0.05)
    worker.terminate()
    worker.wait()
    yield httpx.get(f"{service.server}/metrics").text + of_worker_text
    service.stop()


def shown(text: str) -> set[str]:
    """Names of the series of a text of metrics."""
    kinds = dict(re.findall(r"^# TYPE (\S+) (\S+)$", text, re.MULTILINE))
    suffixes = {"counter": ["_total"], "gauge": [""], "histogram": ["_count", "_sum", "_bucket"]}
    return {name + suffix for name, kind in kinds.items() for suffix in suffixes[kind]}


def rules() -> list[dict[str, str]]:
    groups = yaml.safe_load((ALERTS / "alerts.yaml").read_text())["groups"]
    return [rule for group in groups for rule in group["rules"]]


def test_alerts_and_dashboard_use_metrics_that_there_are(metrics: str) -> None:
    alerts = {name for rule in rules() for name in NAME.findall(rule["expr"])}
    panels = json.loads(DASHBOARD.read_text())["panels"]
    drawn = {name for panel in panels for target in panel["targets"] for name in NAME.findall(target["expr"])}
    assert len(alerts) > 8
    assert len(drawn) > 15
    assert alerts | drawn <= shown(metrics), (alerts | drawn) - shown(metrics)
    assert len({panel["id"] for panel in panels}) == len(panels)


def test_every_alert_has_instructions() -> None:
    described = LEVELS.read_text()
    for rule in rules():
        assert f"`{rule['alert']}`" in described, rule["alert"]


@pytest.mark.skipif(shutil.which("promtool") is None, reason="Prometheus is not installed")
@pytest.mark.parametrize("command", [["check", "rules", "alerts.yaml"], ["test", "rules", "tests.yaml"]])
def test_promtool_accepts_the_rules(command: list[str], tmp_path: Path) -> None:
    shutil.copytree(ALERTS, tmp_path, dirs_exist_ok=True)
    done = subprocess.run(["promtool", *command], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
