"""Automata that a mission file names: read beside it, frozen in the mission, and what may be wrong with them."""

import json
from pathlib import Path

import pytest

from mission.errors import SpecError
from mission.logic.automata.automaton import GeneralisedBuchi
from mission.spec.document import document_of
from mission.spec.loader import MAX_AUTOMATON_BYTES, load_mission, parse_mission
from mission.spec.model import MissionSpec
from mission.spec.task import TaskKind

MISSION = """\
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  Field: {kind: survey, polygon: [[10, 10], [20, 10], [20, 20], [10, 20]]}
mission: {automaton: there/field.hoa}
start: {position_m: [5, 5]}
"""
FIELD = """\
HOA: v1 Start: 0 AP: 1 "Field" Acceptance: 1 Inf(0)
--BODY--
State: 0 [!0] 0 [0] 1
State: 1 {0} [t] 1
--END--
"""


def written(folder: Path, automaton: bytes | None, mission: str = MISSION) -> Path:
    (folder / "there").mkdir()
    if automaton is not None:
        (folder / "there" / "field.hoa").write_bytes(automaton)
    (folder / "mission.yaml").write_text(mission, encoding="utf-8")
    return folder / "mission.yaml"


def automaton_of(spec: MissionSpec) -> GeneralisedBuchi:
    assert spec.automaton is not None
    return spec.automaton.automaton


def faults_of(path: Path) -> list[tuple[int, int, str, str]]:
    with pytest.raises(SpecError) as caught:
        load_mission(path)
    assert all(fault.hint for fault in caught.value.faults)
    return [(fault.line, fault.column, fault.path, fault.message) for fault in caught.value.faults]


def test_it_is_read_relative_to_the_mission_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, FIELD.encode())
    spec = load_mission(path)
    assert spec.formula == ""
    assert spec.automaton is not None
    assert (spec.automaton.file, spec.automaton.text) == ("there/field.hoa", FIELD)
    assert (automaton_of(spec).size, automaton_of(spec).propositions) == (2, ("Field",))
    monkeypatch.chdir(tmp_path)
    assert load_mission("mission.yaml") == spec
    assert hash(spec) == hash(load_mission(path))


def test_it_may_have_a_byte_order_mark_and_an_absolute_path(tmp_path: Path) -> None:
    absolute = MISSION.replace("there/field.hoa", str(tmp_path / "there" / "field.hoa"))
    spec = load_mission(written(tmp_path, b"\xef\xbb\xbf" + FIELD.encode(), absolute))
    assert automaton_of(spec).size == 2


def test_tasks_may_stand_beside_it(tmp_path: Path) -> None:
    spec = load_mission(written(tmp_path, FIELD.encode(), MISSION + "tasks:\n  - visit: Field\n"))
    assert automaton_of(spec).size == 2
    assert [task.kind for task in spec.tasks] == [TaskKind.VISIT]


def test_as_data_it_is_named_and_read_back_from_what_it_held(tmp_path: Path) -> None:
    spec = load_mission(written(tmp_path, FIELD.encode()))
    content = json.dumps(document_of(spec)).encode()
    assert json.loads(content)["mission"]["automaton"] == "there/field.hoa"
    assert parse_mission(content, read=lambda _: FIELD.encode()) == spec


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "there/field.hoa: there is no such file"),
        (b"", "there/field.hoa, line 1, column 1: header is expected here, not the end of the file"),
        (b"HOA: v1\n\xff", "there/field.hoa, line 2: the byte 0xff is not UTF-8"),
        (b" " * (MAX_AUTOMATON_BYTES + 1), f"there/field.hoa: the file is larger than {MAX_AUTOMATON_BYTES} bytes"),
        (FIELD.replace("[0] 1", "[1] 1").encode(), "there/field.hoa, line 3, column 18: proposition 1 does not exist"),
        (
            FIELD.replace('"Field"', '"' + "field" * 30 + '"').encode(),
            "the automaton in there/field.hoa speaks of `" + "field" * 11 + "fi...`, which is no region",
        ),
    ],
)
def test_what_is_wrong_with_it_is_said_where_it_is_named(tmp_path: Path, content: bytes | None, message: str) -> None:
    assert faults_of(written(tmp_path, content)) == [(5, 22, "mission.automaton", message)]


def test_its_faults_are_listed_with_all_others_of_the_mission(tmp_path: Path) -> None:
    text = MISSION.replace("[5, 5]", "[5, 50]").replace("kind: survey", "kind: sruvey")
    found = faults_of(written(tmp_path, FIELD.replace('"Field"', '"Feild"').encode(), text))
    assert [fault[2] for fault in found] == ["regions.Field.kind", "mission.automaton", "start.position_m"]


def test_a_mission_that_comes_from_no_file_can_name_none() -> None:
    with pytest.raises(SpecError, match=r"there/field\.hoa: there is no such file"):
        parse_mission(MISSION.encode())
