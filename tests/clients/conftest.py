"""A client program on a vehicle: each a process of its own, over UDP on loopback."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import pytest

from tests.clients.environments import NoWheelError, environment
from tests.support.commands import ROOT

VEHICLE = (
    *("--speed", "10", "--patience", "10", "--listen", "udpin:127.0.0.1:0", "--no-ground-station"),
    *("--announce", "--exit-with-parent", "--quiet"),
)
SCENARIO_WITHIN_S = 100.0

Facts: TypeAlias = dict[str, Any]
Play: TypeAlias = Callable[[int, str, str], Facts]


@pytest.fixture(scope="session")
def play(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Play:
    """Return a function that plays a scenario of a version of MAVSDK on a flavour, and returns what it told."""
    is_alone = not hasattr(request.config, "workerinput")
    run = tmp_path_factory.getbasetemp() if is_alone else tmp_path_factory.getbasetemp().parent
    cache: pytest.Cache | None = getattr(request.config, "cache", None)  # there is none with -p no:cacheprovider
    kept = run if cache is None else cache.mkdir("clients")

    def played(version: int, flavour: str, scenario: str) -> Facts:
        try:
            python = environment(version, kept, run)
        except NoWheelError as error:
            pytest.skip(str(error))
        return _played(python, version, flavour, scenario)

    return played


def _played(python: Path, version: int, flavour: str, scenario: str) -> Facts:
    vehicle = subprocess.Popen(
        [sys.executable, "-m", "vehicle_sim", "--flavour", flavour, *VEHICLE],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with vehicle:
        assert vehicle.stdout is not None
        port = vehicle.stdout.readline().rpartition(":")[2].strip()
        client = subprocess.run(
            [python, "-m", f"tests.clients.mavsdk{version}_client", f"udpout://127.0.0.1:{port}", scenario],
            cwd=ROOT,
            capture_output=True,
            check=False,
            stdin=subprocess.DEVNULL,
            text=True,
            timeout=SCENARIO_WITHIN_S,
        )
        vehicle.terminate()
    lines = [json.loads(line) for line in client.stdout.splitlines() if line.startswith("{")]
    facts = {line["topic"]: line["value"] for line in lines}
    assert "done" in facts, f"the client ended early, with {facts}\n{client.stderr}"
    return facts
