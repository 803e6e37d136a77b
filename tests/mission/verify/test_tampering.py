"""A plan that was tampered with is found: each kind of entry of its file is altered, and `mission verify` says so."""

import json
from collections.abc import Callable, Iterator
from functools import cache
from itertools import chain
from math import isclose
from pathlib import Path
from typing import Any, Final

import pytest

import mission.cli.verify
from mission.cli import main
from mission.plan import FlightPlan, plan_mission, plan_to_json
from mission.spec.loader import load_mission
from mission.spec.model import MissionSpec, Point
from tests.support.commands import MISSIONS
from tests.support.small_missions import CORRIDOR, FIELDS, PHOTOGRAPHED, ROUNDS, SMALL, plan_of

LEFT_AS_IT_IS: Final = {
    ".certificate.clearance_m: a little": "a lower bound that is a little lower, or still below the truth, is one",
    ".certificate.knots_s.#: a little": "pieces with the same triangles may meet anywhere where the tube is in both",
    ".certificate.possible.#: order": "a set has no order",
    ".covers.#.before: gone": "without it nothing of the region was covered before, which is so",
    ".covers.#.first_s: gone": "without it the first image is at the begin of the first lane, which is so",
    ".homeward.certificate.clearance_m: a little": "as of the laps",
    ".homeward.certificate.knots_s.#: a little": "as of the laps",
    ".homeward.certificate.possible.#: order": "as of the laps",
    ".onward: gone": "without it a flight begins at rest, which this one does",
    ".photographs: gone": "without it there are none, which is so where no camera is",
    ".trajectory.legs.#.curve.controls_m.#.#.#: a little": "a curve as smooth, or that turns where it rests",
}
"""What may pass, with the reason why no claim is touched; entry and alteration."""

TURNS: Final = {"laps": 0, "corridor": 0, "lanes": 1}
"""The plans whose entries are altered in each run of the suite, and with which alteration one begins.

They stand in the order of how long it takes to check them, the quickest last.
"""

Place = tuple[str | int, ...]
GONE: Final = object()


def entries(value: object, place: Place = (), kind: str = "") -> Iterator[tuple[str, Place, Any]]:
    """Every entry of a document: what kind it is (numbers of lists left out), where, and its value."""
    if isinstance(value, dict | list):
        inner = value.items() if isinstance(value, dict) else enumerate(value)
        for key, part in inner:
            of = f"{kind}.{key if isinstance(value, dict) else '#'}"
            yield of, (*place, key), part
            yield from entries(part, (*place, key), of)


def alterations(value: object) -> dict[str, Any]:
    """Values that an entry might be given instead."""
    if isinstance(value, bool):
        return {"turned": not value}
    if isinstance(value, int):
        return {"a little": value + 1, "much": 10 * value + 7}
    if isinstance(value, float):
        return {"a little": value + 1e-5 * max(1.0, abs(value)), "much": 3.0 * value + 10.0}
    if isinstance(value, str):
        return {"letter": f"{value}x"}
    if isinstance(value, list) and value:
        ends = value[0], value[-1]
        numbers = all(isinstance(end, float) for end in ends)
        alike = isclose(*ends, abs_tol=1e-9) if numbers else ends[0] == ends[1]  # rounding
        return {**({} if alike else {"order": [value[-1], *value[1:-1], value[0]]}), "shorter": value[:-1]}
    return {"nothing": 1 if value is None else None}


def altered(document: object, place: Place, value: object) -> str:
    copy: Any = json.loads(json.dumps(document))
    part: Any = copy
    for key in place[:-1]:
        part = part[key]
    if value is GONE:
        del part[place[-1]]
    else:
        part[place[-1]] = value
    return json.dumps(copy)


def plans() -> dict[str, Callable[[], FlightPlan]]:
    return {
        "laps": lambda: plan_of(ROUNDS + FIELDS),
        "stops": lambda: plan_of(SMALL + FIELDS),
        "corridor": lambda: plan_of(ROUNDS.replace("kind: survey,", "kind: survey, loiter_s: 1,", 1) + CORRIDOR),
        "lanes": lambda: plan_of(PHOTOGRAPHED + FIELDS),
        "paper": lambda: plan_mission(load_mission(MISSIONS / "paper.yaml")),
        "survey": lambda: plan_mission(load_mission(MISSIONS / "survey.yaml")),
    }


@pytest.fixture
def planned_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same mission is planned once."""
    known: dict[str, FlightPlan] = {}

    def plan_known(spec: MissionSpec, *, start_m: Point, run: int | None) -> FlightPlan:
        key = repr((spec, start_m, run))
        if key not in known:
            known[key] = plan_mission(spec, start_m=start_m, run=run)
        return known[key]

    monkeypatch.setattr(mission.cli.verify, "plan_mission", plan_known)


@cache
def whole(name: str) -> str:
    return plan_to_json(plans()[name]())


@cache
def kinds(name: str) -> dict[str, list[tuple[Place, Any]]]:
    """Each kind of entry of a plan, with the places and values of those that it has."""
    found: dict[str, list[tuple[Place, Any]]] = {}
    for kind, place, value in entries(json.loads(whole(name))):
        if place[0] != "mission":  # what a plan is measured by
            found.setdefault(kind, []).append((place, value))
    return found


@cache
def share_of(name: str) -> frozenset[str]:
    """The kinds of entries that are tried on this plan in each run of the suite: those that no later one has."""
    last_of = {kind: plan for plan in TURNS for kind in kinds(plan)}
    return frozenset(kind for kind, plan in last_of.items() if plan == name)


def tried(
    name: str, *, samples: int, turn: int | None = None, share: frozenset[str] | None = None
) -> Iterator[tuple[str, Place, Any]]:
    """Alterations of entries of a plan: kind and alteration, place, and value.

    Args:
        name: Which plan.
        samples: How many entries of each kind.
        turn: Which of the alterations of each; all of them by default.
        share: The kinds of entries; all of them by default.
    """
    for number, (kind, all_of_it) in enumerate(kinds(name).items()):
        if share is not None and kind not in share:
            continue
        for place, value in all_of_it[:: max(1, -(-len(all_of_it) // samples))]:
            ways = list({**alterations(value), "gone": GONE}.items())
            for what, new in ways if turn is None else [ways[(number + turn) % len(ways)]]:
                yield f"{kind}: {what}", place, new


def passed(
    name: str, file: Path, *, samples: int, turn: int | None = None, share: frozenset[str] | None = None
) -> list[str]:
    """The alterations that are not found."""
    document, through = json.loads(whole(name)), []
    for what, place, new in tried(name, samples=samples, turn=turn, share=share):
        file.write_text(altered(document, place, new), encoding="utf-8")
        if main(["verify", str(file)]) not in (1, 2):
            through.append(what)
    return through


@pytest.mark.usefixtures("planned_once")
@pytest.mark.parametrize(("name", "turn"), TURNS.items())
def test_an_altered_entry_is_found(name: str, turn: int, tmp_path: Path) -> None:
    file = tmp_path / "plan.json"
    file.write_text(whole(name), encoding="utf-8")
    assert main(["verify", str(file)]) == 0
    assert set(passed(name, file, samples=1, turn=turn, share=share_of(name))) <= LEFT_AS_IT_IS.keys()


def test_each_kind_of_entry_of_these_plans_is_altered_in_one() -> None:
    assert sorted(kind for name in TURNS for kind in share_of(name)) == sorted({*chain(*map(kinds, TURNS))})


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.usefixtures("planned_once")
@pytest.mark.parametrize("name", plans())
def test_whatever_is_altered_is_found(name: str, tmp_path: Path) -> None:
    assert set(passed(name, tmp_path / "plan.json", samples=4)) <= LEFT_AS_IT_IS.keys()
