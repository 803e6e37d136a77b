"""A start from which nothing can be proved is told when the file is read, with what to write instead."""

import re

import pytest

from mission.errors import SpecError
from mission.plan import plan_mission
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

TEXT = """\
domain:
  boundary: [[0, 0], [120, 0], [120, 80], [0, 80]]
  clearance_m: {fence}
regions:
  home: {{kind: home, polygon: [[5, 5], [30, 5], [30, 30], [5, 30]]}}
  field: {{kind: survey, polygon: [[60, 10], [110, 10], [110, 70], [60, 70]]}}
  barn: {{kind: restricted, polygon: [[33, 10], [44, 10], [44, 36], [33, 36]], clearance_m: {barn}}}
mission: {{formula: F field & F G home}}
start: {{position_m: [{east}, 15]}}
flight: {{disturbance_m_s2: {disturbance}, time_constant_s: {tau}}}
"""


def read(**other: float) -> MissionSpec:
    values = {"fence": 2.0, "barn": 4.0, "east": 28.7, "disturbance": 2.0, "tau": 0.5} | other
    return parse_mission(TEXT.format(**values).encode())


def said(**other: float) -> tuple[str, str]:
    with pytest.raises(SpecError) as refused:
        read(**other)
    (fault,) = refused.value.faults
    assert (fault.line, fault.path) == (9, "start.position_m")
    return fault.message, fault.hint


def test_what_is_written_instead_is_enough_and_no_more_is() -> None:
    message, hint = said()
    assert message == (
        "the start (28.7, 15) is 0.3 m from barn with its clearance of 4 m, within the tube of the proof, "
        "0.5 m each way"
    )
    found = re.search("at most ([0-9.]+) for regions.barn.clearance_m, or write at most ([0-9.]+) for flight", hint)
    assert found is not None
    barn, disturbance = map(float, found.groups())
    assert 3.77 <= barn <= 3.8
    assert 1.16 <= disturbance <= 1.2
    for allowed in ({"barn": barn}, {"disturbance": disturbance}, {"east": 28.45}):
        assert plan_mission(read(**allowed)).certificate.holds
    # The check is sure only of what is deeper in the tube than 2 % of it.
    said(barn=barn + 0.04)
    said(disturbance=disturbance + 0.08)


def test_the_boundary_is_told_with_its_clearance_and_without() -> None:
    message, hint = said(east=2.2)
    assert "is 0.2 m from the boundary with its clearance of 2 m, within the tube" in message
    assert "or write at most 1.7 for domain.clearance_m" in hint
    read(east=2.2, fence=1.7)
    message, hint = said(east=0.2, fence=0.0)
    assert "is 0.2 m from the boundary, within the tube of the proof, 0.5 m each way" in message
    assert "clearance" not in hint
    read(east=0.2, fence=0.0, disturbance=0.0)


def test_other_causes_of_the_tube_count_where_the_file_gives_them() -> None:
    text = TEXT.format(fence=2.0, barn=4.0, east=28.7, disturbance=0.4, tau=0.5)
    parse_mission(text.encode())
    given = text.replace(
        "time_constant_s", "tube: {estimator_m: 0.2, following_m: 0.2, correction_m: 0}, time_constant_s"
    )
    with pytest.raises(SpecError, match=r"within the tube of the proof, 0\.5 m each way") as refused:
        parse_mission(given.encode())
    assert refused.value.faults[0].hint.endswith("or write less for the causes in flight.tube, for 0.29 m in all")


def test_the_tube_of_a_mission_that_says_nothing_of_it_counts_as_well() -> None:
    text = TEXT.partition("flight:")[0].format(fence=0, barn=0, east=32.5)
    with pytest.raises(SpecError, match=r"is 0\.5 m from barn, within the tube of the proof, 0\.6 m each way"):
        parse_mission(text.encode())
