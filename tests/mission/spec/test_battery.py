"""``battery``: what is read, what is refused, and that it is written as read."""

import json

import pytest

from mission.errors import SpecError
from mission.spec.battery import Battery
from mission.spec.document import document_of
from mission.spec.loader import parse_mission

FILE = """
domain: {boundary: [[0, 0], [60, 0], [60, 40], [0, 40]], mesh: {}}
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
mission: {formula: F home}
start: {position_m: [9, 8]}
"""


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("{current_a: 14}", Battery(14.0, 0.2, None)),
        ("{current_a: 14.5, reserve: 0, capacity_mah: 5200}", Battery(14.5, 0.0, 5200.0)),
    ],
)
def test_what_is_read_is_written_and_read_again(written: str, read: Battery) -> None:
    spec = parse_mission(f"{FILE}battery: {written}\n".encode())
    assert spec.battery == read
    assert parse_mission(json.dumps(document_of(spec)).encode()).battery == read


def test_without_one_nothing_is_known_of_it() -> None:
    assert parse_mission(FILE.encode()).battery is None


@pytest.mark.parametrize(
    ("written", "words"),
    [("{}", "current_a"), ("{current_a: 0}", "less than 0.01"), ("{current_a: 9, reserve: 1}", "more than 0.9")],
)
def test_what_means_nothing_is_refused(written: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        parse_mission(f"{FILE}battery: {written}\n".encode())
    assert words in " ".join(f"{fault.path} {fault.message}" for fault in caught.value.faults)


def test_what_a_flight_takes() -> None:
    assert Battery(18.0).charge_mah(600.0) == pytest.approx(3000.0)
