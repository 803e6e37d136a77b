"""Every mission file keeps what it promises: sound ones plan with a proof, broken ones give their error and line."""

import json
import re
from collections import Counter
from itertools import groupby
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import shapely
import yaml

from mission.logic.formula.word import LassoWord, satisfies
from mission.plan import FlightPlan, plan_from_json
from mission.spec.loader import load_mission
from mission.spec.model import BoundaryDomain, PolygonShape
from mission.steering.joined import JoinedCurve
from mission.steering.path import SteeringPath
from mission.steering.polyline import Polyline
from mission.verify.plans import claims
from tests.support.commands import MISSIONS, ran
from tests.support.steered_plans import fields_of

SOUND = sorted(MISSIONS.glob("*.yaml"))
BROKEN = sorted((MISSIONS / "broken").glob("*.yaml"))
WHOLE_FILE = {"empty.yaml", "only_comments.yaml"}
"""Where there is no line to point at."""
WORDS = {
    "closing": "home ferry corridor bridge weir corridor home",
    "delivery": "base depot clinic farm base",
    "drifting": "S2 S1 R",
    "farm": "pad field field pad",
    "inspection": "pad roof tank pad",
    "orchard": "shed rows rows rows rows rows rows rows rows shed",
    "pairs": "home field depot field depot home",
    "paper": "S2 S1 R",
    "park": "car_park meadow stage meadow car_park",
    "patrol": "home east west north east",
    "power_line": "yard north south yard",
    "response": "lab well lab pond lab",
    "ship": "quay deck pier",
    "survey": "home S1 S2 S3 home",
    "tasks_delivery": "base depot clinic farm base",
    "timed": "home road mast road barn home",
    "tasks_soft": "home road mast road barn home",
    "yard": "office gate tank crane stock office",
}
"""The regions that each flight enters, in turn; of patrols once round. A tour may be flown the other way about.
A region of several parts is entered as often as lanes lead from one part to the next."""


GALLERY = (MISSIONS / "README.md").read_text(encoding="utf-8")
FIGURES = {
    name: figures.split(" | ") for name, figures in re.findall(r"^\| (\w+) \| (\d.*) \|$", GALLERY, flags=re.MULTILINE)
}
"""Of each mission in the gallery's table: triangles, smallest angle, lanes, shares, duration."""


def name_of(file: Path) -> str:
    return file.stem


def figures_of(plan: dict[str, Any]) -> tuple[list[float], list[float]]:
    """What the gallery says of a mission: sizes of the mesh, lanes, and seconds; and the shares, in percent."""
    covers = plan["covers"]
    lanes = [float(sum(cover["lanes"] for cover in covers))] if covers else []
    shares = [100.0 * cover["planned_share"] for cover in covers]
    return [plan["triangles"], plan["smallest_angle_deg"], *lanes, plan["flight_duration_s"]], shares


def check_run(plan: FlightPlan) -> None:
    """The run of a flight in a corridor is what its curve passes, in order, and so is that of its way back."""
    if not isinstance(plan.path, Polyline):
        return
    legs, lap, corners = plan.curve.legs, plan.trajectory.lap, plan.partition.corners_m
    cut = len(legs) if lap is None else lap + 1
    parts = [(legs[:cut], plan.run, plan.certificate)]
    if plan.homeward is not None:
        parts.append((legs[cut:], plan.homeward.run, plan.homeward.certificate))
    for flown, run, proof in parts:
        states = [*run.states, run.suffix[0]]
        # The tip of a way that turns back at a rest lies at a joint.
        times_s = [np.union1d(np.linspace(0.0, leg.duration_s, 20_001), JoinedCurve((leg,)).joints_s) for leg in flown]
        points = np.concatenate([leg.position(at_s) for leg, at_s in zip(flown, times_s, strict=True)])
        if plan.moving is not None:
            moments_s = np.arange(0.0, plan.trajectory.duration_s, 0.01)
            points = plan.moving.pulled_back(moments_s, plan.trajectory.position(moments_s))
        assert shapely.distance(shapely.polygons(corners[states]), shapely.linestrings(points)).max() < 1e-3
        passed, read = iter(states), iter([plan.labelling.label(state) for state in states])
        assert all(triangle in passed for triangle, _ in groupby(plan.locator.triangle_at(points).tolist()))
        assert all(letter in read for letter in proof.word)


def check_plan(plan: FlightPlan) -> None:
    """Its run satisfies its formula, and its flight stays as long as it must in each region that it enters."""
    assert plan.certificate.holds
    labels = [plan.labelling.label(state) for state in plan.run.states]
    split = len(plan.run.prefix)
    assert satisfies(LassoWord(tuple(labels[:split]), tuple(labels[split:])), plan.formula)
    assert not plan.restricted[list(plan.run.states)].any()
    speeds = np.linalg.norm(plan.trajectory.velocity(np.linspace(0.0, plan.trajectory.duration_s, 2000)), axis=1)
    assert speeds.max() <= plan.spec.limits.speed_m_s * (1.0 + 1e-9)
    stopped = [s for s, _ in plan.stops] or [0.0]
    places = plan.curve.position(stopped)
    if plan.moving is not None:
        places = plan.moving.pulled_back(plan.trajectory.time_at(stopped), places)
    loiters = {region.name: region.loiter_s for region in plan.spec.regions if region.loiter_s > 0.0}
    for triangle, (_, seconds) in zip(plan.locator.triangle_at(places).tolist(), plan.stops, strict=False):
        assert seconds in {loiters.get(name) for name in plan.labelling.label(triangle)}
    if isinstance(plan.path, SteeringPath):
        assert len(plan.stops) == sum(len(entries(plan, name)) for name in loiters)
    else:
        visited = {name for triangle in plan.run.states for name in plan.labelling.label(triangle)}
        assert len(plan.stops) >= len(loiters.keys() & visited)


def entries(plan: FlightPlan, name: str) -> list[int]:
    """Places on the path at which a region is entered."""
    inside = [name in plan.labelling.label(segment.triangle) for segment in fields_of(plan).segments]
    return [i for i in range(1, len(inside)) if inside[i] and not inside[i - 1]]


def test_there_are_missions_of_both_sorts() -> None:
    assert len(SOUND) >= 5
    assert len(BROKEN) >= 50


@pytest.mark.parametrize("file", SOUND, ids=name_of)
def test_a_sound_mission_is_planned_with_a_proof(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    written = tmp_path / "plan.json"
    result = ran(capsys, "plan", str(file), "--json", "--out", str(written))
    assert (result.code, result.err) == (0, "")
    assert [claim for claim in claims(written.read_text(encoding="utf-8")) if claim.fault] == []
    read = plan_from_json(written.read_text(encoding="utf-8"))
    check_run(read)
    check_plan(read)
    plan = json.loads(result.out)
    assert plan["certificate"]["holds"] is True
    assert len(plan["run"]) == len(plan["controls"])
    assert set(plan["controls"]) <= {0, 1, 2, 3}
    assert plan["product_states"] == plan["triangles"] * plan["searched_automaton_states"]
    assert plan["searched_automaton_states"] <= plan["automaton_states"]
    assert plan["shortest_runs"] >= 1
    assert plan["length_m"] > 0.0
    assert plan["duration_s"] > 0.0
    visits = [name for letter in plan["certificate"]["word"] for name in letter]
    assert Counter(visits) == Counter(WORDS[file.stem].split())
    if file.stem in FIGURES:
        *sizes, shares, seconds = FIGURES[file.stem]
        figures, covered = figures_of(plan)
        given = [float(cell) for cell in (*sizes, seconds) if cell != "-"]
        if not covered:
            assert given == pytest.approx(figures, rel=0.01)
            return
        # Among headings that take nearly as long, other versions of the libraries may choose another.
        assert given[:2] == pytest.approx(figures[:2], rel=0.01)
        assert given[2] == pytest.approx(figures[2], abs=1.0)
        assert given[3] == pytest.approx(figures[3], rel=0.04)
        assert [float(share) for share in shares.split(", ")] == pytest.approx(covered, abs=0.5)


def test_the_gallery_has_a_sentence_and_a_picture_of_each_mission() -> None:
    shown = re.findall(r"^### (\w+)\.yaml\n\n[^\n]+\.\n\n!\[[^\]]+\]\((.+)\)$", GALLERY, flags=re.MULTILINE)
    assert sorted(name for name, _ in shown) == [file.stem for file in SOUND]
    assert set(FIGURES) <= {name for name, _ in shown}
    assert all(Path(picture).stem == name for name, picture in shown)
    assert sum((MISSIONS / picture).stat().st_size for _, picture in shown) < 1_000_000


@pytest.mark.parametrize("file", SOUND, ids=name_of)
def test_no_corner_stands_on_a_straight_edge_for_the_sake_of_the_mesh(file: Path) -> None:
    mission = load_mission(file)
    shapes = [region.shape for region in mission.regions]
    if isinstance(mission.domain, BoundaryDomain):
        shapes.append(mission.domain.boundary)
    for ring in (np.array(shape.corners_m) for shape in shapes if isinstance(shape, PolygonShape)):
        (ax, ay), (bx, by) = (ring - np.roll(ring, 1, axis=0)).T, (np.roll(ring, -1, axis=0) - ring).T
        assert (np.abs(ax * by - ay * bx) > 1e-9).all()


@pytest.mark.parametrize("file", SOUND, ids=name_of)
def test_a_sound_mission_says_what_it_is_for(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    mission = yaml.safe_load(text)
    assert text.startswith("# ")
    assert mission["name"]
    assert mission["description"].endswith(".")


def test_the_printed_schema_accepts_every_sound_mission(capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "schema")
    assert (result.code, result.err) == (0, "")
    schema = json.loads(result.out)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for file in SOUND:
        validator.validate(yaml.safe_load(file.read_text(encoding="utf-8")))


@pytest.mark.parametrize("file", BROKEN, ids=name_of)
def test_a_broken_mission_gives_its_error_and_line(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "check", str(file))
    assert (result.code, result.out) == (2, "")
    first, *rest = result.err.splitlines()
    place = "" if file.name in WHOLE_FILE else r":\d+:\d+"
    assert re.fullmatch(rf"{re.escape(str(file))}{place}: .+", first), first
    hints = [line for line in rest if line.startswith("    ") and not line.startswith("    |")]
    assert hints, "what to write instead is missing"
    if place:
        assert rest[1].startswith("    | ")
        assert rest[1].endswith("^")
