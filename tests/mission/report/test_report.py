"""The report: its numbers against computations of their own, its page against what a file or a vehicle may say."""

import base64
import itertools
import json
import math
from collections.abc import Mapping
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mission.monitor.attitude import horizontal_acceleration, tilt
from mission.report.figures import PICTURES, save_all
from mission.report.page import page
from mission.report.reading import Track, Visit, parse_record
from mission.report.report import write_report
from mission.report.summary import condensed, summary
from mission.report.tracking import nearest_to, tracking_of
from tests.support.drawn_plans import PAPER_TOUR, SURVEY_TOUR, Tour, flight_of, plan_of, record_of
from tests.support.timed_missions import timed_plan


class Page(HTMLParser):
    """Notes tags and text, and that every tag is closed in order."""

    VOID = ("meta", "img", "br", "input")

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def distance_to_segment(p: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], p[0] - a[0], p[1] - a[1]
    length = ux * ux + uy * uy
    t = 0.0 if length == 0 else min(1.0, max(0.0, (ux * vx + uy * vy) / length))
    return math.hypot(vx - t * ux, vy - t * uy)


def test_the_tracking_error_is_that_of_the_reports_on_the_trajectory() -> None:
    plan = plan_of(PAPER_TOUR)
    error = np.random.default_rng(3).normal(0.0, 0.02, (400, 2))
    record = parse_record(flight_of(plan, error_m=error)[0])
    flown = summary(plan, record)["flown"]
    lengths = [math.hypot(x, y) for x, y in error.tolist()]
    assert flown["largest_error_m"] == pytest.approx(max(lengths), rel=1e-9)
    assert flown["rms_error_m"] == pytest.approx(math.sqrt(sum(d * d for d in lengths) / len(lengths)), rel=1e-9)
    assert flown["largest_error_per_axis_m"] == pytest.approx(float(np.abs(error).max()), rel=1e-9)
    assert flown["largest_velocity_error_per_axis_m_s"] == pytest.approx(0.0, abs=1e-9)
    swifter = replace(record.track, velocity_m_s=record.track.velocity_m_s + np.array([0.1, -0.3, 5.0]))
    flown_faster = summary(plan, replace(record, track=swifter))["flown"]
    assert flown_faster["largest_velocity_error_per_axis_m_s"] == pytest.approx(0.3, rel=1e-6)
    assert flown["reports"] == 401
    assert flown["reports_on_trajectory"] == 400
    assert flown["duration_s"] == pytest.approx(plan.trajectory.duration_s)


def test_setpoints_are_interpolated_between_their_times() -> None:
    lines = [
        '{"kind":"header","t_s":null,"mission":"m","schema":1}',
        '{"kind":"setpoint","t_s":9,"position_m":[50,50,0],"trajectory_s":null}',
        '{"kind":"setpoint","t_s":10,"position_m":[0,0,0],"trajectory_s":0}',
        '{"kind":"setpoint","t_s":12,"position_m":[4,2,0],"trajectory_s":2}',
        '{"kind":"telemetry","t_s":9.5,"position_m":[9,9,9]}',
        '{"kind":"telemetry","t_s":11,"position_m":[2,2,0]}',
        '{"kind":"telemetry","t_s":11.5,"position_m":[null,2,0]}',
        '{"kind":"telemetry","t_s":13,"position_m":[9,9,9]}',
    ]
    tracking = tracking_of(parse_record("\n".join([*lines, ""]).encode()))
    assert tracking.trajectory_s.tolist() == [1.0]
    assert tracking.error_m.tolist() == [[0.0, 1.0]]
    assert tracking.distance_m.tolist() == [1.0]


@pytest.mark.parametrize("tour", [PAPER_TOUR, SURVEY_TOUR])
def test_distances_to_restricted_regions_are_those_of_the_line_flown(tour: Tour) -> None:
    plan = plan_of(tour)
    data, _ = flight_of(plan)
    found = summary(plan, parse_record(data))["flown"]["distance_to_restricted_m"]
    line = [(float(x), float(y)) for x, y in parse_record(data).track.position_m[:, :2]]
    for name, distance in found.items():
        best = math.inf
        for triangle in plan.labelling.triangles_of(name):
            ring = [(float(x), float(y)) for x, y in plan.partition.corners_m[triangle]]
            for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
                best = min(best, *(distance_to_segment(p, a, b) for p in line))
                best = min(best, *(distance_to_segment(a, p, q) for p, q in itertools.pairwise(line)))
        assert distance == pytest.approx(best, rel=1e-9)
    assert set(found) == {region.name for region in plan.spec.regions if region.kind == "restricted"}


def test_a_line_through_a_restricted_region_between_two_reports_is_at_no_distance() -> None:
    plan = plan_of(PAPER_TOUR)
    record = record_of(plan)
    k1 = plan.partition.corners_m[6].mean(axis=0)
    ends = np.array([[k1[0] - 9.0, k1[1], 5.0], [k1[0] + 9.0, k1[1], 5.0]])
    old = record.track
    track = Track(old.t_s[-2:], ends, old.velocity_m_s[-2:], old.attitude_rad[-2:], old.stages[-2:])
    flown = summary(plan, replace(record, track=track))["flown"]
    assert flown["distance_to_restricted_m"] == {"K1": 0.0}
    empty = replace(record, track=replace(record.track, position_m=np.full((2, 3), np.nan)))
    assert nearest_to(plan, empty) == {}


def test_attitudes_accelerate_where_a_multicopter_goes() -> None:
    g, angle = 9.80665, 0.2
    attitudes = np.array(
        [[angle, 0, 0], [0, -angle, 0], [0, -angle, math.pi / 2], [angle, 0, math.pi / 2], [0, 0, 1.0]]
    )
    expected = g * math.tan(angle) * np.array([[1, 0], [0, 1], [1, 0], [0, -1], [0, 0]])
    np.testing.assert_allclose(horizontal_acceleration(attitudes), expected, atol=1e-12)
    np.testing.assert_allclose(tilt(attitudes), [angle, angle, angle, angle, 0.0], atol=1e-7)


def test_the_word_is_condensed_by_labels() -> None:
    d, s = frozenset[str](), frozenset({"S1"})
    visits = [Visit(0.0, 1, d), Visit(1.0, 2, d), Visit(2.0, 3, s), Visit(3.0, -1, d), Visit(4.0, 2, d)]
    assert [(v.t_s, t) for v, t in condensed(visits)] == [(0.0, [1, 2]), (2.0, [3]), (3.0, [-1]), (4.0, [2])]


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Mapping[str, Any]]:
    """The folder of a report with all its pictures, and its numbers."""
    folder = tmp_path_factory.mktemp("reported") / "flight"
    plan, record = plan_of(PAPER_TOUR), record_of(plan_of(PAPER_TOUR))
    return folder, write_report(plan, record, folder, mission_text="name: paper # <i>\n")


def test_the_same_plan_and_flight_give_the_same_bytes(reported: tuple[Path, Mapping[str, Any]], tmp_path: Path) -> None:
    folder, _ = reported
    drawn = save_all(plan_of(PAPER_TOUR), record_of(plan_of(PAPER_TOUR)), tmp_path)
    covering = {"11_coverage.png", "12_moments.png", "13_flown_moments.png"}
    assert {entry.picture.file for entry in PICTURES} - {picture.file for picture in drawn} == covering
    assert len(drawn) == 9
    for picture in drawn:
        data = (tmp_path / picture.file).read_bytes()
        assert data == (folder / picture.file).read_bytes()
        assert b"tEXt" not in data


def test_the_folder_holds_page_numbers_and_pictures(reported: tuple[Path, Mapping[str, Any]]) -> None:
    plan, (folder, numbers) = plan_of(PAPER_TOUR), reported
    written = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert written == numbers
    assert written["planned"]["run"] == [0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10]
    assert written["planned"]["controls"] == [1, 3, 3, 1, 1, 3, 1, 2, 2, 2, 3, 2, 0]
    assert written["planned"]["length_m"] == plan.path.length_m
    assert [letter["labels"] for letter in written["flown"]["word"]] == [["S2"], [], ["S1"], [], ["R"]]
    html = Page((folder / "report.html").read_text(encoding="utf-8"))
    pictures = [value for name, value in html.attributes if name == "src"]
    assert len(pictures) == 9
    for picture in pictures:
        kind, data = str(picture).split(",")
        assert kind == "data:image/png;base64"
        assert base64.b64decode(data).startswith(b"\x89PNG")
    assert len(list(folder.glob("*.png"))) == 9
    text = " ".join(html.words)
    for words in ("The specification was achieved.", plan.spec.formula, "Smallest distance to K1", "name: paper # <i>"):
        assert words in text
    assert f"{written['flown']['largest_error_m']:.3f} m" in text
    assert list(folder.parent.rglob(".*")) == []


def test_what_a_vehicle_or_a_file_says_is_text_and_nothing_else() -> None:
    plan, evil = plan_of(PAPER_TOUR), "<script>alert('x')</script>\"&\ud800"
    spec = replace(plan.spec, name=evil, description=evil, formula=evil)
    hostile = replace(plan, spec=spec)
    record = replace(record_of(plan), vehicle={evil: evil}, verdict={"achieved": False, "reason": evil, evil: evil})
    html = page(hostile, record, summary(hostile, record), (), mission_text=evil)
    parsed = Page(html)
    assert "script" not in parsed.tags
    assert html.count("<script") == 0
    assert " ".join(parsed.words).count("alert('x')") >= 6
    assert not [value for name, value in parsed.attributes if name.startswith("on") or "alert" in (value or "")]


@pytest.mark.parametrize(
    ("achieved", "words"),
    [
        (True, "open: some satisfy the formula, as staying in the last region does, and some do not"),
        (False, "open: some satisfy the formula"),
    ],
)
def test_what_could_have_come_is_told_from_what_came(achieved: bool, words: str) -> None:  # noqa: FBT001 - a case
    plan = plan_of(PAPER_TOUR)
    record = replace(record_of(plan), verdict={"achieved": achieved, "reason": ""})
    numbers = summary(plan, record)
    numbers["flown"]["judged"] = {"so_far": "open", "done": 2, "total": 3, "awaited": ["home"]}
    said = Page(page(plan, record, numbers, ())).words
    assert words in said
    assert said[said.index("Progress of the automaton") + 1] == ("2 of 3" if achieved else "2 of 3; it waits for home")
    end = "At the end 2 of 3 steps of the automaton were done" + ("." if achieved else ", and it waited for home.")
    assert any(end in text for text in said)


def test_bounds_in_seconds_are_told_as_they_are_proved() -> None:
    plan = timed_plan("F G home & F[0,60] far & G[0,12] !gate")
    said = Page(page(plan, None, summary(plan, None), ())).words
    told = [said[k + 1] for k, each in enumerate(said) if each == "In time, in the tube"]
    assert told == [bound.text for bound in plan.bounds]


def test_bounds_in_seconds_are_told_as_they_were_flown() -> None:
    plan = plan_of(PAPER_TOUR)
    record = replace(record_of(plan), verdict={"achieved": False, "reason": ""})
    numbers = summary(plan, record)
    assert numbers["flown"]["judged"]["in_time"] == []
    numbers["flown"]["judged"]["in_time"] = ["F[0,60] far missed at 60.0 s"]
    said = Page(page(plan, record, numbers, ())).words
    assert said[said.index("In time, as it was flown") + 1] == "F[0,60] far missed at 60.0 s"


def test_what_would_turn_the_page_round_is_told_by_its_code() -> None:
    plan, evil = plan_of(PAPER_TOUR), "S1\u202e\x1b[2J"
    record = replace(record_of(plan), vehicle={evil: evil}, verdict={"achieved": False, "reason": evil})
    html = page(replace(plan, spec=replace(plan.spec, name=evil)), record, summary(plan, record), (), mission_text=evil)
    assert html.count("S1\\u202e\\x1b[2J") >= 4
    assert all(character.isprintable() or character == "\n" for character in html)


def test_a_plan_that_was_not_flown_has_a_report_too(tmp_path: Path) -> None:
    plan = plan_of(PAPER_TOUR)
    numbers = write_report(plan, None, tmp_path, pictures=False)
    assert numbers["flown"] is None
    assert numbers["verdict"] is None
    assert "Planned, not flown." in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["report.html", "summary.json"]


@pytest.mark.parametrize("lines", [0, 1, 2, 4, 9, 60])
def test_a_flight_that_was_cut_short_is_reported(tmp_path: Path, lines: int) -> None:
    plan = plan_of(PAPER_TOUR)
    data = b"".join(flight_of(plan)[0].splitlines(keepends=True)[:lines]) + b'{"kind":"tele'
    numbers = write_report(plan, parse_record(data), tmp_path, pictures=False)
    assert numbers["verdict"] == {"achieved": None, "reason": "the record ends before a verdict was reached"}
    assert numbers["flown"]["record_is_cut"]
    html = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "There is no verdict." in html.words
