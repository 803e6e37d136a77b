"""The drawn modes are the tables: what is drawn is read back and compared with them."""

import re
import shutil
import subprocess

import pytest

from vehicle_sim import cli
from vehicle_sim.autopilot.diagram import Drawing, drawing
from vehicle_sim.autopilot.modes import FAILSAFE_MODES, FIRST_MODE, MODES, TRANSITIONS
from vehicle_sim.parameters import Flavour

BOTH = pytest.mark.parametrize("flavour", Flavour)
Way = tuple[str, str, str, bool]


def ways_of_the_tables(flavour: Flavour) -> set[Way]:
    names = {mode: rule.name for mode, rule in MODES[flavour].items()}

    def words(name: str) -> str:
        return " ".join(name.lower().split("_"))

    ways = {
        (names[source], names[target], words(event.name), False)
        for (source, event), target in TRANSITIONS[flavour].items()
    }
    for action, (first, *others) in FAILSAFE_MODES[flavour].items():
        ways.add(("failsafe", names[first], words(action.name), False))
        ways |= {("failsafe", names[other], words(action.name), True) for other in others}
    return ways


@BOTH
def test_graphviz_shows_every_mode_and_every_way(flavour: Flavour) -> None:
    text = drawing(flavour, Drawing.DOT)
    found = re.findall(r'^  "([^"]+)" -> "([^"]+)" \[label="([^"]+)"(, style=dashed)?\];$', text, re.MULTILINE)
    assert {(a, b, label, bool(dashed)) for a, b, label, dashed in found} == ways_of_the_tables(flavour)
    boxes = dict(re.findall(r'^  "([^"]+)"( \[.*fillcolor="#56B4E9"\])?;$', text, re.MULTILINE))
    assert {name: bool(filled) for name, filled in boxes.items()} == {
        rule.name: rule.needs_position for rule in MODES[flavour].values()
    }
    assert f'  "power on" -> "{MODES[flavour][FIRST_MODE[flavour]].name}";' in text


@BOTH
def test_mermaid_shows_the_same(flavour: Flavour) -> None:
    text = drawing(flavour, Drawing.MERMAID)
    names = dict(re.findall(r'^  (\w+)\["(.+)"\]$', text, re.MULTILINE)) | {"failsafe": "failsafe"}
    assert set(names.values()) - {"failsafe"} == {rule.name for rule in MODES[flavour].values()}
    firm = re.findall(r"^  (\w+) -- (.+) --> (\w+)$", text, re.MULTILINE)
    dashed = re.findall(r"^  (\w+) -\. (.+) \.-> (\w+)$", text, re.MULTILINE)
    ways = {(names[a], names[b], label, False) for a, label, b in firm}
    ways |= {(names[a], names[b], label, True) for a, label, b in dashed}
    assert ways == ways_of_the_tables(flavour)
    needing = re.search(r"^  class (.+) position$", text, re.MULTILINE)
    assert needing
    assert set(needing[1].split(",")) == {mode.name for mode, rule in MODES[flavour].items() if rule.needs_position}


@BOTH
def test_the_table_has_a_line_for_each_mode(flavour: Flavour) -> None:
    lines = drawing(flavour, Drawing.TABLE).splitlines()
    rows = [re.split(r"  +", line) for line in lines[2:-2]]
    assert [row[0].removesuffix(" *") for row in rows] == [rule.name for rule in MODES[flavour].values()]
    for row, (mode, rule) in zip(rows, MODES[flavour].items(), strict=True):
        assert (row[1] == "needed", row[2] == "yes") == (rule.needs_position, rule.armable)
        assert row[0].endswith(" *") is (mode is FIRST_MODE[flavour])
    said = "\n".join(lines)
    for source, target, label, is_fallback in ways_of_the_tables(flavour):
        assert (f"{label}: {target}" if source != "failsafe" else f"({label})" if is_fallback else label) in said


@BOTH
@pytest.mark.parametrize("form", Drawing)
def test_the_program_prints_it(flavour: Flavour, form: Drawing, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--flavour", flavour.value, "--modes", form.value]) == 0
    assert capsys.readouterr().out == drawing(flavour, form)


def test_without_a_form_it_is_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--modes"]) == 0
    assert capsys.readouterr().out == drawing(Flavour.ARDUPILOT, Drawing.TABLE)


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed here")
@BOTH
def test_graphviz_understands_it(flavour: Flavour) -> None:
    program = shutil.which("dot")
    assert program is not None
    text = drawing(flavour, Drawing.DOT)
    done = subprocess.run([program, "-Tplain"], input=text, capture_output=True, text=True, check=True)  # noqa: S603 - Graphviz
    assert done.stderr == ""
    assert done.stdout.count("\nnode ") == len(MODES[flavour]) + 2
