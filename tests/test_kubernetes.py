"""The manifests for Kubernetes against its schemas, the program's options, and each other. No cluster is needed."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml

from service import REPOSITORY, binary

FOLDER = REPOSITORY / "deploy" / "kubernetes"

VERSION = "1.31"

DRAIN_SECONDS = 10
"""Time that the server gives open requests to end."""

DATABASE_SECONDS = 60
"""How long a server that starts waits for its database."""

UPLOAD_SECONDS = 60
"""How long a worker tries to store what it has."""


def documents() -> list[dict[str, Any]]:
    files = [FOLDER / name for name in kustomization()["resources"]]
    return [document for file in files for document in yaml.safe_load_all(file.read_text())]


def kustomization() -> dict[str, Any]:
    return dict(yaml.safe_load((FOLDER / "kustomization.yaml").read_text()))


def pods() -> dict[str, dict[str, Any]]:
    """The pods' specifications, by the name of what makes them."""
    found = {}
    for document in documents():
        if document["kind"] == "Deployment":
            found[document["metadata"]["name"]] = document["spec"]["template"]["spec"]
        elif document["kind"] == "CronJob":
            found[document["metadata"]["name"]] = document["spec"]["jobTemplate"]["spec"]["template"]["spec"]
    return found


def one(kind: str, name: str) -> dict[str, Any]:
    (found,) = [d for d in documents() if (d["kind"], d["metadata"]["name"]) == (kind, name)]
    return found


def test_every_file_is_a_resource() -> None:
    files = {file.name for file in FOLDER.glob("*.yaml")} - {"kustomization.yaml"}
    assert set(kustomization()["resources"]) == files


def test_kubernetes_knows_every_field() -> None:
    own = [document for document in documents() if not document["apiVersion"].startswith("keda.sh/")]
    assert len(own) == 9
    for document in own:
        kubernetes_validate.validate(document, VERSION, strict=True)


def test_a_misspelt_field_would_be_found() -> None:
    document = one("Deployment", "server")
    document["spec"]["template"]["spec"]["terminationGracePeriod"] = 30
    with pytest.raises(kubernetes_validate.ValidationError):
        kubernetes_validate.validate(document, VERSION, strict=True)


@pytest.mark.parametrize("name", ["server", "worker", "gc"])
def test_the_program_has_every_option_and_variable(name: str) -> None:
    (container,) = pods()[name]["containers"]
    command, *arguments = container["args"]
    described = subprocess.run([binary(), command, "--help"], capture_output=True, text=True, check=True).stdout
    options = set(re.findall(r"--[a-z-]+", described))
    assert {argument for argument in arguments if argument.startswith("--")} <= options
    variables = {variable["name"] for variable in container["env"]} | set(one("ConfigMap", "drillsweep")["data"])
    known = set(re.findall(r"\[env:\s+([A-Z_]+)", described)) | {"DRILLSWEEP_LOG"}
    assert {variable for variable in variables if variable.startswith("DRILLSWEEP_")} <= known
    assert {variable for variable in variables if variable.startswith("AWS_")} <= set(
        re.findall(r"AWS_[A-Z_]+", described)
    )


def test_pods_are_closed_and_secrets_are_elsewhere() -> None:
    for name, pod in pods().items():
        assert pod["automountServiceAccountToken"] is False
        assert pod["securityContext"]["runAsNonRoot"] is True
        assert pod["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
        (container,) = pod["containers"]
        fence = container["securityContext"]
        assert fence == {
            "allowPrivilegeEscalation": False,
            "readOnlyRootFilesystem": True,
            "capabilities": {"drop": ["ALL"]},
        }
        assert "memory" in container["resources"]["limits"], name
        mounts = {mount["mountPath"] for mount in container["volumeMounts"]}
        files = [v["value"] for v in container["env"] if v["name"].endswith("_FILE")]
        files.append(one("ConfigMap", "drillsweep")["data"]["DRILLSWEEP_OBJECTS_CREDENTIALS_FILE"])
        assert all(str(Path(file).parent) in mounts for file in files), files
        assert {mount["name"] for mount in container["volumeMounts"]} == {volume["name"] for volume in pod["volumes"]}
    assert not [document for document in documents() if document["kind"] == "Secret"]
    worker = {secret["key"] for v in pods()["worker"]["volumes"] for secret in v.get("secret", {}).get("items", [])}
    assert worker == {"worker-password"}, "the tables' owner is not for workers"


def test_processes_have_the_time_to_end() -> None:
    assert pods()["server"]["terminationGracePeriodSeconds"] > DRAIN_SECONDS
    assert pods()["worker"]["terminationGracePeriodSeconds"] > UPLOAD_SECONDS


def test_servers_are_spread_over_nodes_and_have_time_to_start() -> None:
    server = pods()["server"]
    (spread,) = server["topologySpreadConstraints"]
    labels = one("Deployment", "server")["spec"]["template"]["metadata"]["labels"]
    assert spread["topologyKey"] == "kubernetes.io/hostname"
    assert spread["labelSelector"]["matchLabels"] == labels
    (container,) = server["containers"]
    probe = container["startupProbe"]
    assert probe["httpGet"] == container["livenessProbe"]["httpGet"]
    assert probe["periodSeconds"] * probe["failureThreshold"] > DATABASE_SECONDS


def test_metrics_are_reached_by_labelled_pods_alone() -> None:
    rules = one("NetworkPolicy", "server")["spec"]["ingress"]
    ports = {port["name"] for port in pods()["server"]["containers"][0]["ports"]}
    assert {port["port"] for rule in rules for port in rule["ports"]} == ports
    for rule in rules:
        if "metrics" in {port["port"] for port in rule["ports"]}:
            (source,) = rule["from"]
            assert all(source[kind]["matchLabels"] for kind in ("namespaceSelector", "podSelector"))


def test_workers_follow_the_queue() -> None:
    scaled = one("ScaledObject", "worker")["spec"]
    assert scaled["scaleTargetRef"]["name"] == one("Deployment", "worker")["metadata"]["name"]
    assert "replicas" not in one("Deployment", "worker")["spec"], "two would decide"
    (trigger,) = scaled["triggers"]
    assert trigger["type"] == "postgresql"
    queue = one("TriggerAuthentication", trigger["authenticationRef"]["name"])["spec"]["secretTargetRef"]
    assert queue == [{"parameter": "password", "name": "drillsweep-database", "key": "worker-password"}]
    schema = (REPOSITORY / "migrations" / "postgres" / "0001_schema.sql").read_text()
    table = schema.split("CREATE TABLE work (")[1].split(") WITH")[0]
    assert all(re.search(rf"^    {column} ", table, re.MULTILINE) for column in ("state", "held"))
    assert trigger["metadata"]["query"].startswith("SELECT count(*) FROM work WHERE state IN ('queued', 'leased')")
