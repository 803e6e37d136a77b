"""Key files of the vehicle, and what is kept beside them."""

import hashlib
import os
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.signing import Signer
from vehicle_sim.server.fleet import fleet_of
from vehicle_sim.server.key_file import KeyFile, key_of, signing_time
from vehicle_sim.vehicle import VehicleConfig

KEY = bytes(range(32))
NOW = 40_000_000 * 100_000


def signed(timestamp: int, system: int = 255) -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=190)
    mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = KEY, True, timestamp
    return bytes(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(mav))


@pytest.mark.parametrize(
    ("content", "key"),
    [
        (KEY, KEY),
        (KEY.hex().encode(), KEY),
        (KEY.hex().upper().encode() + b"\r\n", KEY),
        (b"open sesame\n", hashlib.sha256(b"open sesame").digest()),
        (b"thirty-one letters and an end..\n", hashlib.sha256(b"thirty-one letters and an end..").digest()),
    ],
)
def test_contents(content: bytes, key: bytes) -> None:
    assert key_of(content) == key


@pytest.mark.parametrize("content", [b"", b"\n", KEY[:31], bytes(32), b"0" * 64, b"two\nlines\n", b"\xff" * 33])
def test_what_is_no_key_says_what_to_write(content: bytes) -> None:
    with pytest.raises(ValueError, match=r"32 bytes|zeros"):
        key_of(content)


def key_file(folder: Path, mode: int = 0o600) -> tuple[Path, list[str]]:
    path = folder / "key"
    path.write_bytes(KEY)
    path.chmod(mode)
    return path, []


def test_faults_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="No such file"):
        KeyFile(tmp_path / "none", lambda _sentence: None)
    path, _ = key_file(tmp_path)
    path.write_bytes(b"")
    with pytest.raises(ConfigurationError, match="passphrase"):
        KeyFile(path, lambda _sentence: None)


@pytest.mark.skipif(os.name != "posix", reason="permissions are POSIX")
@pytest.mark.parametrize(("mode", "told"), [(0o600, False), (0o640, True), (0o604, True)])
def test_a_key_that_others_can_read_is_told_of(tmp_path: Path, mode: int, *, told: bool) -> None:
    path, said = key_file(tmp_path, mode)
    KeyFile(path, said.append)
    assert bool(said) == told


def test_no_timestamp_is_used_twice_over_restarts(tmp_path: Path) -> None:
    path, said = key_file(tmp_path)
    given: list[int] = []
    for _ in range(3):
        file = KeyFile(path, said.append)
        endpoints = fleet_of(VehicleConfig(), count=2, spacing_m=5.0, system_id=1, key_file=file, now=lambda: 10)
        given += [endpoints[0].signer.next_timestamp() for _ in range(4)]
        assert file.timestamp(1, 1) >= given[-1]
        assert file.timestamp(2, 1) == 0  # each for itself
    assert given == sorted(set(given))
    assert said == []
    (tmp_path / "key.timestamp.1.1").write_text("soon")
    with pytest.raises(ConfigurationError, match="delete it"):
        fleet_of(VehicleConfig(), count=1, spacing_m=5.0, system_id=1, key_file=KeyFile(path, said.append))


def test_what_an_earlier_run_accepted_is_not_accepted_again(tmp_path: Path) -> None:
    path, said = key_file(tmp_path)

    def signer() -> Signer:
        file = KeyFile(path, said.append)
        return fleet_of(VehicleConfig(), count=1, spacing_m=5.0, system_id=1, key_file=file, now=lambda: NOW)[0].signer

    first = signer()
    recorded = signed(NOW + 500)
    assert first.accepts(recorded)
    crashed = signer()
    first.finish()
    ended = signer()
    for later in (crashed, ended):
        assert not later.accepts(recorded)
        assert later.accepts(signed(later.next_timestamp() + 1))  # who has heard it signs by a later time
    ended.install(KEY)
    assert not ended.accepts(recorded)


def test_a_clock_that_is_ahead_is_told_of_once_with_what_to_do(tmp_path: Path) -> None:
    path, said = key_file(tmp_path)
    year = 365 * 86_400 * 100_000

    def signer() -> Signer:
        file = KeyFile(path, said.append)
        return fleet_of(
            VehicleConfig(), count=1, spacing_m=5.0, system_id=1, key_file=file, now=lambda: NOW, notify=said.append
        )[0].signer

    first = signer()
    assert first.accepts(signed(NOW + 500, system=9))
    assert said == []
    assert first.accepts(signed(NOW + year))
    assert first.accepts(signed(NOW + year + 1))
    assert not first.accepts(signed(NOW + 600, system=9))
    (told,) = said
    assert told.startswith("system 255, component 190 signs by a clock 365.0 days ahead of this machine's: ")
    assert f"delete {path}.timestamp.1.1 and" in told
    signer()
    assert said[1].startswith("the timestamps kept are 365.0 days ahead")
    (tmp_path / "key.timestamp.1.1").unlink()
    assert signer().accepts(signed(NOW + 600, system=9))
    assert len(said) == 2


def test_another_key_is_kept_whole_and_for_its_owner(tmp_path: Path) -> None:
    path, said = key_file(tmp_path)
    (endpoint,) = fleet_of(
        VehicleConfig(), count=1, spacing_m=5.0, system_id=1, key_file=KeyFile(path, said.append), notify=said.append
    )
    assert endpoint.key_setup.on_key is not None
    endpoint.key_setup.on_key(KEY[::-1])
    assert KeyFile(path, said.append).key == KEY[::-1]
    assert path.stat().st_mode & 0o777 == 0o600
    assert "kept in the key file" in said[-1]
    endpoint.key_setup.on_key(None)
    assert "ended signing" in said[-1]
    assert KeyFile(path, said.append).key == KEY[::-1]


@pytest.mark.skipif(os.name != "posix", reason="links are POSIX")
def test_no_link_leads_a_key_or_a_timestamp_elsewhere(tmp_path: Path) -> None:
    path, said = key_file(tmp_path)
    victim = tmp_path / "victim"
    victim.write_text("kept")
    for name in ("key.new", "key.timestamp.1.1.new", "key.timestamp.1.1"):
        (tmp_path / name).symlink_to(victim)
    file = KeyFile(path, said.append)
    file.keep_key(KEY[::-1])
    file.keep_timestamp(1, 1, 7)
    assert victim.read_text() == "kept"
    assert (file.timestamp(1, 1), KeyFile(path, said.append).key) == (7, KEY[::-1])


def test_the_time_of_signing_counts_from_2015() -> None:
    years = signing_time() / 100_000 / 86_400 / 365.25
    assert 9.0 < years < 60.0
