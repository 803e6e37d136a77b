"""The bundled vehicle's process ends with the flight, whatever happens; signals become wishes."""

import os
import signal
import sys
import tempfile
from pathlib import Path

import pytest

from mission.errors import LinkError
from mission.fly import BundledVehicle, StopRequest, StopSignals, VehicleOptions, home_for
from tests.support.small_missions import SMALL, at_a_place, plan_of

LISTENS = "import sys; print('READY udpin:127.0.0.1:4242', flush=True); sys.stdin.read()"
STUBBORN = (
    "import signal, sys, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); "
    "print('READY udpin:127.0.0.1:4242', flush=True)\nwhile True: signal.pause()"
)


def program(text: str) -> tuple[str, ...]:
    return (sys.executable, "-c", text)


def is_running(process_id: int) -> bool:
    try:
        os.kill(process_id, 0)
    except ProcessLookupError:
        return False
    return True


def test_it_says_where_it_listens_and_ends_with_the_context() -> None:
    with BundledVehicle(VehicleOptions(), program(LISTENS)) as vehicle:
        assert vehicle.address == "udpout:127.0.0.1:4242"
        assert vehicle.failure() == ""
        assert is_running(vehicle.process_id)
    assert not is_running(vehicle.process_id)


def test_it_ends_with_an_exception() -> None:
    started: list[BundledVehicle] = []

    def fly_and_fail() -> None:
        with BundledVehicle(VehicleOptions(), program(LISTENS)) as vehicle:
            started.append(vehicle)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fly_and_fail()
    assert not is_running(started[0].process_id)


@pytest.mark.skipif(os.name != "posix", reason="signals that a program may ignore are POSIX")
def test_one_that_does_not_want_to_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mission.fly.vehicle_process._END_WITHIN_S", 0.2)
    with BundledVehicle(VehicleOptions(), program(STUBBORN)) as vehicle:
        assert is_running(vehicle.process_id)
    assert not is_running(vehicle.process_id)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("import sys; sys.exit('no port is free')", "did not start; it said: no port is free"),
        ("print('READY tcpin:127.0.0.1:1')", "did not start"),
        ("print('hello')", "did not start"),
    ],
)
def test_one_that_does_not_start_is_a_link_failure_with_its_words(text: str, words: str) -> None:
    with pytest.raises(LinkError, match=words):
        BundledVehicle(VehicleOptions(), program(text))


def test_a_program_that_is_not_there_is_a_link_failure(tmp_path: Path) -> None:
    with pytest.raises(LinkError, match=r"cannot be started: no such file or directory$"):
        BundledVehicle(VehicleOptions(), (str(tmp_path / "none"),))


def test_where_no_file_can_be_written_it_is_a_link_failure_that_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    with pytest.raises(LinkError, match=r"no folder for temporary files can be written to; .* TMPDIR"):
        BundledVehicle(VehicleOptions(), program(LISTENS))


def test_its_death_is_noticed() -> None:
    with BundledVehicle(VehicleOptions(), program(LISTENS)) as vehicle:
        os.kill(vehicle.process_id, signal.SIGTERM)
        failure = ""
        while not failure:
            failure = vehicle.failure()
        assert "has ended" in failure


def test_choices_become_arguments() -> None:
    options = VehicleOptions(
        speed=5,
        seed=3,
        wind="-1,2",
        flavour="px4",
        dynamics="quadrotor",
        home=(47.0, 8.5, 100.0),
        ground_station=False,
    )
    arguments = options.arguments()
    assert arguments[:3] == ["--listen", "udpin:127.0.0.1:0", "--announce"]
    assert {"--speed=5", "--seed=3", "--wind=-1,2", "--flavour=px4", "--no-ground-station"} <= set(arguments)
    assert "--dynamics=quadrotor" in arguments
    assert "--home=47.000000000,8.500000000,100.000" in arguments
    assert not any(
        a.startswith(("--seed", "--wind", "--flavour", "--dynamics", "--home")) for a in VehicleOptions().arguments()
    )


def test_the_vehicle_is_put_where_the_mission_starts() -> None:
    assert home_for(plan_of(SMALL).spec) is None
    home = home_for(plan_of(at_a_place(47.0, 8.0)).spec)
    assert home is not None
    assert home[0] == pytest.approx(47.0 + 8.0 / 111_170.0, abs=1e-6)  # 8 m north
    assert home[1] == pytest.approx(8.0 + 9.0 / 76_060.0, abs=1e-6)  # 9 m east


@pytest.mark.parametrize(
    ("number", "request_"),
    [
        (signal.SIGINT, StopRequest("interrupted by the user", after_lap=True)),
        (signal.SIGTERM, StopRequest("ended by SIGTERM")),
    ],
)
def test_a_signal_is_a_wish_and_the_next_before_it_is_heeded_an_order(
    number: signal.Signals, request_: StopRequest
) -> None:
    before = signal.getsignal(number)
    with StopSignals() as stop:
        for _ in range(2):
            assert stop.take() is None
            signal.raise_signal(number)
            assert stop.take() == request_
        signal.raise_signal(number)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(number)
        assert stop.exit_code == 128 + number
    assert signal.getsignal(number) is before


def test_a_hang_up_that_is_ignored_is_no_wish() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does it
    try:
        with StopSignals() as stop:
            signal.raise_signal(signal.SIGHUP)
            assert stop.take() is None
        assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
