"""Fault files: what they mean, and everything that can be wrong with them, told at once with lines and hints."""

from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.faults import Schedule, Since, read_schedule
from vehicle_sim.faults.fault_file import MAX_BYTES, MAX_FAULTS, FaultFileError
from vehicle_sim.faults.schedule import KINDS

GOOD = b"""\
faults:
  - {fault: gps_loss, since: takeoff, at_s: 20, for_s: 8}
  - fault: gust
    at_s: 60
    for_s: 4
    east_m_s: 9
  - {fault: motor, rotor: 2, efficiency: 0.8, ramp_s: 2}
  - {fault: link, drop: 0.2, down: 0}
"""


def test_a_file_means_what_it_says() -> None:
    loss, gust, motor, link = read_schedule(GOOD).faults
    assert (loss.kind, loss.since, loss.at_s, loss.for_s, loss.ramp_s) == ("gps_loss", Since.TAKEOFF, 20.0, 8.0, 0.0)
    assert (gust.since, gust.values) == (Since.BOOT, {"north_m_s": 0.0, "east_m_s": 9.0, "up_m_s": 0.0})
    assert (motor.for_s, motor.ramp_s, motor.values) == (inf, 2.0, {"rotor": 2.0, "efficiency": 0.8})
    assert (link.values["up"], link.values["down"], link.values["drop"], link.values["delay_s"]) == (1, 0, 0.2, 0)


def faults_of(text: str) -> list[tuple[int, str]]:
    with pytest.raises(FaultFileError) as caught:
        read_schedule(text.encode(), "f.yaml")
    return [(fault.line, f"{fault.message}; {fault.hint}") for fault in caught.value.faults]


BROKEN = [
    ("", 1, "the file is empty"),
    ("faults: 3", 1, "`faults` is not a list"),
    ("- 1", 1, "the file is not a mapping"),
    ("fault: []", 1, "`faults` is missing"),
    ("faults: []\nmore: 1", 2, "there is no key `more`"),
    ("faults:\n  - gps_loss", 2, "a fault is not a mapping"),
    ("faults:\n  - {at_s: 3}", 2, "`fault` is missing"),
    ("faults:\n  - {fault: gps_los}", 2, "did you mean `gps_loss`?"),
    ("faults:\n  - {fault: plague}", 2, "one of wind, gust, gps_loss"),
    ("faults:\n  - {fault: gps_loss, at_ss: 3}", 2, "did you mean `at_s`?"),
    ("faults:\n  - {fault: gps_loss, colour: 3}", 2, "`gps_loss` has no `colour`"),
    ("faults:\n  - {fault: gps_loss, since: landing}", 2, "no value of `since`; one of boot, arming, takeoff"),
    ("faults:\n  - {fault: gps_loss, at_s: -1}", 2, "`at_s` cannot be -1; write a number from 0"),
    ("faults:\n  - {fault: gps_loss, at_s: soon}", 2, "`at_s` cannot be soon"),
    ("faults:\n  - {fault: gps_loss, at_s: .nan}", 2, "`at_s` cannot be .nan"),
    ("faults:\n  - {fault: gps_loss, at_s: '3'}", 2, "`at_s` cannot be 3"),
    ("faults:\n  - {fault: gps_loss, at_s: [3]}", 2, "`at_s` cannot be this"),
    ("faults:\n  - {fault: gps_loss, for_s: 0}", 2, "a fault of no duration does nothing"),
    ("faults:\n  - {fault: gps_jump}", 2, "this `gps_jump` does nothing; give at least one of north_m"),
    ("faults:\n  - {fault: gps_jump, north_m: 20, for_s: 4, ramp_s: 3}", 2, "both ramps are longer"),
    ("faults:\n  - {fault: gps_noise}", 2, "`noise_m` is missing; a number from 0 to 100"),
    ("faults:\n  - {fault: gust, east_m_s: 5}", 2, "a `gust` needs `for_s`"),
    ("faults:\n  - {fault: gust, east_m_s: 5, for_s: 3, ramp_s: 1}", 2, "`gust` has no `ramp_s`"),
    ("faults:\n  - {fault: battery, voltage_v: 11, for_s: 3}", 2, "`battery` has no `for_s`"),
    ("faults:\n  - {fault: motor, rotor: 1.5, efficiency: 0.5}", 2, "write a whole number from 1 to 4"),
    ("faults:\n  - {fault: link, drop: 1.5}", 2, "write a number from 0 to 1"),
    ("faults:\n  - {fault: gps_loss, at_s: 1, at_s: 2}", 2, "the key `at_s` is repeated"),
    ("faults:\n  - {[1]: 2}", 2, "a key is not a name"),
    ("faults:\n  - {fault: gps_loss", 2, "this is not YAML"),
    ("faults: !!python/object:os.system {}", 1, "tags are not allowed"),
    ("faults: &a []", 1, "anchors and aliases are not allowed"),
    ("faults: " + "[" * 5000, 1, "nest too deep"),
    ("faults: []\n---\nfaults: []", 2, "this is not YAML"),
    ("faults: \x07", 1, "this is not YAML"),
    ("faults:\n" + "- {fault: gps_loss}\n" * (MAX_FAULTS + 1), 2, f"more than {MAX_FAULTS} faults"),
    ("#" * (MAX_BYTES + 1), 1, "the file is longer"),
]


@pytest.mark.parametrize(("text", "line", "words"), BROKEN, ids=[words for _, _, words in BROKEN])
def test_each_mistake_has_its_line_and_its_hint(text: str, line: int, words: str) -> None:
    found = faults_of(text)
    assert any(at == line and words in told for at, told in found), found


def test_every_fault_of_a_file_is_told_at_once() -> None:
    lines = [
        "faults:",
        "  - {fault: gps_los}",
        "  - {fault: gust, east_m_s: 99}",
        "  - {fault: gps_loss, at_s: 4}",
        "  - {fault: motor, rotor: 7}",
    ]
    found = faults_of("\n".join(lines))
    assert [line for line, _ in found] == [2, 3, 3, 5, 5]


def test_bytes_that_are_no_text_are_told_by_line() -> None:
    with pytest.raises(FaultFileError, match="f:2: the file is not UTF-8"):
        read_schedule(b"faults:\n  \xff", "f")


@given(st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
def test_any_bytes_are_a_schedule_or_an_error_that_speaks(content: bytes) -> None:
    try:
        schedule = read_schedule(content)
    except ConfigurationError:
        return
    assert isinstance(schedule, Schedule)


@given(st.data())
def test_every_kind_of_fault_can_be_written_within_its_bounds(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(KINDS)))
    kind = KINDS[name]
    values = {
        key: data.draw(
            st.integers(int(bounds.least), int(bounds.most)) if bounds.whole else st.floats(bounds.least, bounds.most)
        )
        for key, bounds in kind.quantities.items()
    }
    pairs = {"fault": name, **values} | ({"for_s": 5} if kind.lasting else {})
    text = "faults:\n- {" + ", ".join(f"{key}: {value}" for key, value in pairs.items()) + "}\n"
    (fault,) = read_schedule(text.encode()).faults
    assert fault.values == values
