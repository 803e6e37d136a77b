"""The checklist of what a real autopilot does: every line has its tests, and every test that is named exists."""

import ast
import tomllib
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import pytest

TESTS = Path(__file__).parents[2]
LINES: list[dict[str, Any]] = tomllib.loads((Path(__file__).parent / "lines.toml").read_text(encoding="utf-8"))["line"]
SECTIONS = {1, 2, 3, 4, 5, 6, 7, 8, 10}


@cache
def collected(module: str) -> frozenset[str]:
    """Return the tests that pytest collects from a module: functions at its top, and methods of its test classes."""
    tree = ast.parse((TESTS / f"{module}.py").read_text(encoding="utf-8"))
    names = set()
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            names.add(node.name)
        elif isinstance(node, ast.ClassDef):
            names |= {child.name for child in node.body if isinstance(child, ast.FunctionDef)}
    return frozenset(names)


def test_every_section_is_there_and_no_line_twice() -> None:
    assert {line["section"] for line in LINES} == SECTIONS
    assert [line["section"] for line in LINES] == sorted(line["section"] for line in LINES)
    assert [says for says, count in Counter(line["says"] for line in LINES).items() if count > 1] == []


@pytest.mark.parametrize("line", LINES, ids=lambda line: f"{line['section']}-{line['says'][:40]}")
def test_a_line_has_tests_that_exist_or_says_why_not(line: dict[str, Any]) -> None:
    assert set(line) <= {"section", "says", "tests", "out_of_scope"}
    assert line["says"]
    tests = line.get("tests", [])
    assert len(tests) == len(set(tests))
    for test in tests:
        module, _, name = test.partition("::")
        assert name in collected(module), f"there is no {test}"
    if "out_of_scope" in line:
        assert len(line["out_of_scope"]) > 20
        assert not tests
    else:
        assert tests
