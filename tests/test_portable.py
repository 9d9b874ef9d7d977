"""The build for any x86-64 processor: slower, to the same bits."""

from __future__ import annotations

import os
import platform
import subprocess
from pathlib import Path

import pytest

from service import REPOSITORY, binary

METHODS = ["esdirk4", "generalized_alpha", "rk4"]


def last_state(program: Path, method: str) -> str:
    """Output of the example after 200 steps: displacements of a node with all their digits."""
    return subprocess.run([program, method, "200"], check=True, capture_output=True, text=True).stdout


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="other processors have one build only")
def test_a_build_without_vector_instructions_gives_the_same_bits() -> None:
    usual = Path(binary()).parent
    target = usual.parent / "portable"
    # RUSTFLAGS takes the place of what .cargo/config.toml says.
    environment = {**os.environ, "RUSTFLAGS": "-C target-cpu=x86-64", "CARGO_TARGET_DIR": str(target)}
    # Without optimisation, which changes no bit either and takes a fraction of the time to compile.
    environment["CARGO_PROFILE_DEV_OPT_LEVEL"] = "0"
    plain = ["--config", "profile.dev.package.drillsweep-sim.opt-level=0"]
    build = ["cargo", "build", "--quiet", "--locked", *plain, "--package", "drillsweep-sim", "--example", "steps"]
    subprocess.run(build, check=True, cwd=REPOSITORY, env=environment)
    for method in METHODS:
        portable = last_state(target / "debug" / "examples" / "steps", method)
        assert portable == last_state(usual / "examples" / "steps", method), method
