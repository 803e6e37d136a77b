"""Names of regions with any letters and spaces: written in quotes, planned, amended, and shown as they are."""

import pytest
import yaml

from mission.errors import SpecError
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.spec.amendment import amended
from mission.spec.loader import parse_mission

MISSION = """
domain: {boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]}
regions:
  zu Hause: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  Südfeld 2: {kind: survey, polygon: [[26, 4], [36, 4], [36, 12], [26, 12]]}
  "'s Ende: #3": {kind: restricted, polygon: [[18, 20], [22, 20], [22, 24], [18, 24]]}
mission: {formula: 'F ("Südfeld 2" & F "zu Hause") & G !"''s Ende: #3"'}
tasks: [{avoid: "'s Ende: #3"}]
start: {position_m: [9, 8]}
"""


def test_they_are_planned_and_read_back() -> None:
    spec = parse_mission(MISSION.encode(), "names.yaml")
    plan = plan_mission(spec)
    assert [sorted(letter) for letter in plan.certificate.word if letter] == [["zu Hause"], ["Südfeld 2"], ["zu Hause"]]
    again = plan_from_json(plan_to_json(plan))
    assert (again.spec, again.certificate.word) == (spec, plan.certificate.word)


@pytest.mark.parametrize("name", ["", " a", "a ", 'say "a"', "a\\b", "F", "x" * 61])
def test_what_a_formula_could_not_say_is_no_name(name: str) -> None:
    document = yaml.safe_load(MISSION)
    document["regions"][name] = document["regions"].pop("Südfeld 2")
    with pytest.raises(SpecError) as caught:
        parse_mission(yaml.safe_dump(document).encode())
    assert any("cannot name a region" in fault.message for fault in caught.value.faults)


@pytest.mark.parametrize("formula", ["F Südfeld 2", "F zu Hause", "G !Südfeld 2 & F Südfeld 2"])
def test_a_name_without_its_quotes_is_told_to_have_them(formula: str) -> None:
    document = yaml.safe_load(MISSION)
    document["mission"]["formula"] = formula
    with pytest.raises(SpecError) as caught:
        parse_mission(yaml.safe_dump(document).encode())
    assert any(fault.hint.startswith("put the name in double quotes: ") for fault in caught.value.faults)


def test_amendments_name_them_in_quotes() -> None:
    spec = parse_mission(MISSION.encode())
    lines = ['restrict "neuer Teich" [[30, 20], [34, 20], [34, 24]]', 'formula F "Südfeld 2"', 'drop "\'s Ende: #3"']
    changed = amended(spec, lines, (9.0, 8.0))
    assert [region.name for region in changed.regions] == ["zu Hause", "Südfeld 2", "neuer Teich"]
    with pytest.raises(SpecError, match="after the region"):
        amended(spec, ["drop Südfeld 2"], (9.0, 8.0))
