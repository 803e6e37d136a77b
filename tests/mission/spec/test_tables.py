"""Long lists of points are read by a way of their own, and nobody can tell but by the time that it takes."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import Fault, SpecError
from mission.spec import yaml_tree
from mission.spec.loader import parse_mission
from mission.spec.nodes import Mapping, Node, Scalar, Table
from mission.spec.structure import plain_data, structure_findings
from mission.spec.tables import without_tables
from mission.spec.yaml_tree import MAX_BYTES_FOR_PYTHON, read_tree
from tests.support.drawn_cases import tried

BROKEN = Path(__file__).parents[3] / "missions" / "broken"

ROWS = [[i, i / 4 - 3] for i in range(70)]
FLOW = str(ROWS)
LINES = FLOW.replace("], ", "],\n   ")
DASHES = "".join(f"\n  - [{x}, {y}]" for x, y in ROWS)


def shape(node: Node) -> Any:  # noqa: ANN401 - nested
    """Everything that a tree says, table or not."""
    place = node.line, node.column
    if isinstance(node, Scalar):
        return *place, node.text, node.style
    if isinstance(node, Mapping):
        return *place, [(shape(node.keys[name]), shape(value)) for name, value in node.values.items()]
    return *place, [shape(item) for item in node.items]


def told(text: str) -> tuple[Any, Any, list[Fault]]:
    try:
        tree, faults = read_tree(text)
    except SpecError as error:
        return None, None, list(error.faults)
    return shape(tree), plain_data(tree)[0], faults


def told_without_tables(text: str) -> tuple[Any, Any, list[Fault]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(yaml_tree, "without_tables", lambda text: (text, {}))
        return told(text)


def has_tables(text: str) -> bool:
    """Whether what is read has a table in it."""
    todo = [read_tree(text)[0]]
    while todo:
        node = todo.pop()
        if isinstance(node, Table):
            return True
        todo.extend(
            [] if isinstance(node, Scalar) else node.values.values() if isinstance(node, Mapping) else node.items
        )
    return False


@pytest.mark.parametrize(
    "text",
    [
        f"a: {FLOW}\nb: 1\n",
        f"a: {LINES}\nb: 1\n",
        f"a: {LINES}   \n# end\nb: {FLOW}\n",
        f"a: {LINES}\nb: 1\n".replace("\n", "\r\n"),
        f"{{a: {FLOW}, b: 1}}",
        f"{{a: {LINES}, b: 1}}",
        f'{{"a":{FLOW},"b":{FLOW}}}',
        f"a:{DASHES}\nb: 1\n",
        f"a:{DASHES}  \n\n# end\nb: 1\n",
        f"a:{DASHES}\n".replace("\n", "\r\n"),
        f"a:{DASHES}".replace("\n  -", "\n-"),
        f"a: &all {FLOW}\nb: *all\n",
        f"a: &all\n  {LINES}\nb: *all\n",
        f"a: &all{DASHES}\nb: *all\n",
        f"a:\n  {LINES}\nb: 1",
        f"- {FLOW}\n- {FLOW}\n",
        FLOW,
        f"a: {FLOW.replace(' 1.25]', ' -1.25e-3]')}",
    ],
)
def test_tables_are_found_and_say_the_same(text: str) -> None:
    assert has_tables(text)
    assert told(text) == told_without_tables(text)


@pytest.mark.parametrize(
    "text",
    [
        f"a: 1  # {FLOW}\n",
        f"# {LINES}\nb: 1\n",
        f"a: '{FLOW}'\nb: 1",
        f'a: "{FLOW}"\nb: 1',
        f"a: |\n  {FLOW}\nb: 1",
        f"a: |{DASHES}\nb: 1",
        f"a: text {FLOW}\nb: 1",
        f"a:{FLOW}\nb: 1",
        f"{FLOW}: 1",
        f"? {FLOW}\n: 1",
        f"{{{FLOW}: 1}}",
        f"a: !!seq {FLOW}\n",
        f"a:{DASHES}\n  - [1, 2] # one more\n",
        f"a:\n  - [1, 2] # one before{DASHES}\n",
        f"a:{DASHES}\n  - [1, 2\n",
        f"a: {FLOW} b\n",
        f"a: {FLOW[:-1]}, 3]\n",
        f"a: {FLOW[:-1]}, [1, 010]]\n",
        f"a: {FLOW[:-1]}\nb: 1\n",
        f"{'[' * 19}{FLOW}{']' * 19}",
        f"{'[' * 18}{FLOW}{']' * 18}",
        f"{'- ' * 19}{DASHES.strip()}",
        f"a: {FLOW}\na: {FLOW}\n",
        f"a: \ue0000\nb: {FLOW}\n",
        f'a: {FLOW}\nb: "\\ue0000"\n',
        f'a: "\\ue0000"\n# {FLOW}',
        f"a: {FLOW}\nb: [1, 2\n",
        f"a: *b\nb: {FLOW}",
        f"a: {FLOW}\n---\nb: 1",
        f'? {{"{FLOW}',
    ],
)
def test_what_is_no_table_or_no_yaml_is_told_the_same(text: str) -> None:
    assert told(text) == told_without_tables(text)


PIECES = [
    "a: ",
    "b: ",
    "\n",
    "- ",
    "  ",
    "#",
    "'",
    '"',
    "|\n  ",
    "{",
    "}",
    "[",
    "]",
    ", ",
    "1",
    "&x ",
    "*x",
    "? ",
    FLOW,
    DASHES,
]


@given(st.lists(st.sampled_from(PIECES), max_size=12).map("".join))
@tried(60)
def test_wherever_a_table_stands_the_same_is_told(text: str) -> None:
    assert told(text) == told_without_tables(text)


def mission(nodes: str) -> str:
    return (
        f"domain:\n  nodes: {nodes}\nregions:\n  A: {{kind: survey, at: [20.3, 20.4]}}\n"
        "mission: {formula: F A}\nstart: {position_m: [1.3, 1.4]}\n"
    )


def grid(side: int) -> list[list[float]]:
    return [[x * 1.0000001, y * 1.0000001] for y in range(side) for x in range(side)]


def test_a_fault_within_a_table_has_its_place() -> None:
    rows = ["[0, 0]"] + [f"[{x}, {x * x % 97}]" for x in range(1, 90)]
    rows[77] = "[77, 1e8]"
    for separator in (", ", ",\n    "):
        text = mission(f"[{separator.join(rows)}]")
        with pytest.raises(SpecError) as caught:
            parse_mission(text.encode())
        (fault,) = caught.value.faults
        assert (fault.path, fault.message) == ("domain.nodes[77][1]", "100000000.0 is more than 20000000")
        assert text.split("\n")[fault.line - 1][fault.column - 1 :].startswith("1e8]")


@pytest.mark.parametrize("written", [str, lambda rows: "".join(f"\n  - [{x}, {y}]" for x, y in rows)])
def test_maps_of_a_hundred_thousand_triangles_are_read(written: Any) -> None:  # noqa: ANN401 - a function
    text = mission(written(grid(224)))
    assert len(text) > 1_048_576
    tree, faults = read_tree(text)
    data, findings = plain_data(tree)
    assert not [*faults, *findings, *structure_findings(data, tree)]
    assert len(data["domain"]["nodes"]) == 224**2


def test_the_number_of_values_is_bounded_in_tables_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(yaml_tree, "MAX_NODES", 1000)
    text = f"a: &a {FLOW}\nb: [*a, *a]\nc: *a\nd: *a\n"
    assert "more than 1000 values" in told(text)[2][0].message
    assert told(text)[2] == told_without_tables(text)[2]


@pytest.mark.parametrize("path", sorted(BROKEN.glob("*.yaml")), ids=lambda path: path.stem)
def test_errors_of_long_files_are_told_on_the_same_line(path: Path) -> None:
    text = path.read_bytes().decode("utf-8", "replace")
    try:
        list(yaml.parse(text, Loader=yaml.CSafeLoader))
    except yaml.MarkedYAMLError:
        long = text.rstrip("\n") + "\n#" + " " * MAX_BYTES_FOR_PYTHON
        (told_short,), (told_long,) = told(text)[2], told(long)[2]
        assert (told_short.line, told_short.message) == (told_long.line, told_long.message)
    except yaml.YAMLError:
        assert told(text)[2]


def test_the_text_keeps_its_places() -> None:
    for text in (f"a: {FLOW}, b", f"a: {LINES}, b", f"a:{DASHES}   # c"):
        short, taken = without_tables(text)
        assert len(taken) == (0 if text.endswith("# c") else 1)
        assert short.count("\n") == text.count("\n")
        assert len(short.split("\n")[-1]) == len(text.split("\n")[-1])
