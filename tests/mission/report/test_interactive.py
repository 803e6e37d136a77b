"""The map and the histories of a report: what is in them, and that no name of a mission is more than text."""

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from bokeh.models import MultiPolygons, Text

from mission.report.interactive.chart_map import FLOWN_LABEL, map_of
from mission.report.interactive.embedding import figures, scripts
from mission.report.interactive.histories import histories_of, history_names
from mission.report.interactive.of_flight import MOST_ROWS, flown_of, scene_of
from mission.report.interactive.scene import Area, Band, Flown, History, Scene, Timeline, Trace
from mission.report.interactive.sources import cursor_source, flown_source
from mission.report.reading import Entry, Track, parse_record
from mission.spec.model import RegionKind
from tests.support.drawn_plans import PAPER_TOUR, SURVEY_TOUR, flight_of, plan_of, record_of

EVIL = "</script><img src=x onerror=alert(1)> $$x$$ \u202e"


def told(html: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="figures">(.*?)</script>', html, re.DOTALL)
    assert found is not None
    values: dict[str, Any] = json.loads(found[1])
    return values


def small(name: str = "here") -> tuple[Scene, Flown, Timeline]:
    """A flight of three reports over one region, as a page that is drawn live would have it."""
    scene = Scene(
        land=shapely.box(0, 0, 30, 20), areas=(Area(name, RegionKind.RESTRICTED, shapely.box(10, 5, 20, 15)),)
    )
    flown = Flown(np.array([1.0, 2.0, 3.0]), np.array([[0, 0], [5, 5], [9, 9.0]]), {"height": np.array([0.0, 5, 10])})
    timeline = Timeline(
        (Band(1.0, 2.0, name, "#000000"),), (), (History("Height", "m", (Trace("height", "height", "#000000"),)),)
    )
    return scene, flown, timeline


def test_the_map_has_what_was_planned_and_flown_and_how_near_that_came() -> None:
    plan, record = plan_of(SURVEY_TOUR), record_of(plan_of(SURVEY_TOUR))
    scene = scene_of(plan, record)
    assert [cover.label for cover in scene.covers] == ["tube"]
    assert [layer.label for layer in scene.layers] == ["planned", "smoothed"]
    assert {area.name for area in scene.areas} == {region.name for region in plan.spec.regions}
    line = shapely.LineString(record.track.position_m[:, :2])
    for near in scene.nearest:
        shape = next(area.shape for area in scene.areas if area.name == near.name)
        assert near.distance_m == pytest.approx(line.distance(shape), abs=1e-6)
    assert {near.name for near in scene.nearest} == {"school", "mast"}
    tube = scene.covers[0].shape
    assert tube.buffer(0.05).contains(shapely.LineString(scene.layers[1].points_m))
    assert scene_of(plan, None).nearest == ()


def test_histories_are_of_the_flight_with_its_extremes_and_fit_a_page() -> None:
    plan = plan_of(PAPER_TOUR)
    error = np.zeros((5000, 2))
    error[4321] = (0.031, -0.04)
    record = parse_record(flight_of(plan, error_m=error, reports=5000)[0])
    stages = (Entry(2.0, "stage", {"stage": "taking off"}), Entry(12.0, "stage", {"stage": "flying"}))
    flown, timeline = flown_of(plan, replace(record, events=(*record.events, *stages)))
    assert len(flown.t_s) <= MOST_ROWS + 12
    assert float(np.nanmax(flown.columns["error"])) == pytest.approx(0.04, abs=1e-6)
    assert [history.traces[0].column for history in timeline.histories] == [
        "height",
        "speed",
        "error",
        "nearness",
        "tilt",
    ]
    assert [band.text for band in timeline.regions] == ["S2", "S1", "R"]
    assert [band.text for band in timeline.phases] == ["climbing", "flying"]


def test_what_is_pointed_at_is_one_source_for_map_and_histories() -> None:
    scene, flown, timeline = small()
    source, cursor = flown_source(flown), cursor_source(flown)
    plot, grid = map_of(scene, source, cursor), histories_of(timeline, source, cursor)
    plots = [plot, *(row[0] for row in grid.children)]
    assert [each.name for each in plots[1:]] == history_names(timeline)
    assert all(any(renderer.data_source is cursor for renderer in each.renderers) for each in plots)
    assert len({each.x_range.id for each in plots[1:]}) == 1
    assert cursor.data["t"].tolist() == [3.0]
    named = {each.name for each in plot.renderers if each.name}
    assert FLOWN_LABEL in named


def test_regions_are_drawn_with_their_holes_and_their_names_as_written() -> None:
    ring = shapely.box(0, 0, 30, 20).difference(shapely.box(10, 5, 20, 15))
    scene, flown, _ = small()
    plot = map_of(
        replace(scene, areas=(Area("Süd $$x$$", RegionKind.SURVEY, ring),)), flown_source(flown), cursor_source(flown)
    )
    shapes = [each.data_source.data["xs"][0] for each in plot.renderers if isinstance(each.glyph, MultiPolygons)]
    assert [len(part) for part in shapes[1]] == [2]
    texts = [text for each in plot.renderers if isinstance(each.glyph, Text) for text in each.data_source.data["text"]]
    assert texts == ["Süd $$x$$"]


def test_names_are_text_and_nothing_is_fetched() -> None:
    scene, flown, timeline = small(EVIL)
    html = figures(scene, (flown, timeline))
    assert EVIL not in html
    assert "<img" not in html
    assert html.count("<script") == 2
    assert told(html)["regions"] == [[1.0, 2.0, EVIL.replace("\u202e", "\\u202e")]]
    assert re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)=", scripts() + html) == []


def test_a_flight_of_which_nothing_is_known_has_a_map() -> None:
    plan = plan_of(PAPER_TOUR)
    record = record_of(plan)
    empty = Track(np.empty(0), np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3)), ())
    silent = replace(record, track=empty, visits=(), events=())
    flown, timeline = flown_of(plan, silent)
    assert (len(flown.t_s), timeline) == (0, Timeline())
    assert told(figures(scene_of(plan, silent), (flown, timeline)))["histories"] == ["history 0"]
    assert told(figures(scene_of(plan, None), None))["histories"] == []


def test_battery_link_and_wind_are_shown_as_they_were_told_last() -> None:
    plan = plan_of(PAPER_TOUR)
    lines = [
        b'{"kind":"charge","t_s":20.0,"percent":99,"drawn_mah":50}',
        b'{"kind":"conditions","t_s":13.0,"delay_s":0.04,"lost":0.0,"wind_m_s":null,"wind_from_deg":null}',
        b'{"kind":"conditions","t_s":60.0,"delay_s":0.1,"lost":0.25,"wind_m_s":4.5,"wind_from_deg":270}',
    ]
    data = flight_of(plan)[0] + b"\n".join([*lines, b""])
    flown, timeline = flown_of(plan, parse_record(data))
    early, late = np.searchsorted(flown.t_s, [30.0, 80.0])
    shown = {name: flown.columns[name][[early, late]].tolist() for name in ("charge", "delay", "lost")}
    assert shown == {"charge": [99.0, 99.0], "delay": [40.0, 100.0], "lost": [0.0, 25.0]}
    assert np.isnan(flown.columns["wind"][early])
    assert flown.columns["wind"][late] == 4.5
    assert [history.traces[0].column for history in timeline.histories][-4:] == ["charge", "delay", "lost", "wind"]


def test_the_true_path_of_a_simulated_vehicle_is_on_the_map_and_the_estimate_is_compared_with_it() -> None:
    plan = plan_of(PAPER_TOUR)
    data, positions = flight_of(plan)
    record = parse_record(data)
    lines = [
        f'{{"kind":"truth","t_s":{t_s},"m":[{x + 0.3},{y - 0.4}]}}\n'
        for t_s, (x, y) in zip(record.track.t_s[1:].tolist(), positions.tolist(), strict=True)
    ]
    record = parse_record(data + "".join(lines).encode())
    assert [layer.label for layer in scene_of(plan, record).layers][-1] == "true path of the simulated vehicle"
    flown, _ = flown_of(plan, record)
    assert flown.columns["misjudged"][1:] == pytest.approx(0.5, abs=1e-6)
