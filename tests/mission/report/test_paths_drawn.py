"""Paths on maps: arrows by the page, the error by colour, tubes that are none, starts that moved, names near by."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from mission.geometry.arrays import FloatArray
from mission.report.figures.fitting import GAPS_EM, place_names
from mission.report.figures.paths import (
    ARROW_EVERY_PT,
    MOST_STRETCHES,
    draw_arrows,
    draw_planned,
    flown_path,
    smoothed_path,
)
from mission.report.reading import parse_record
from tests.support.drawn_plans import PAPER_TOUR, SURVEY_TOUR, flight_of, plan_of

LINE = np.stack((np.linspace(0.0, 1000.0, 5000), np.zeros(5000)), axis=-1)


def arrows_on(line: FloatArray, pace_pt: float) -> list[FloatArray]:
    axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
    draw_arrows(axes, line, 1.0, "black", pace_pt)
    (heads,) = axes.collections
    return [np.asarray(path.vertices) for path in heads.get_paths()]


def words(figure: Figure) -> str:
    legend = [text.get_text() for each in figure.legends for text in each.get_texts()]
    return "\n".join([*(text.get_text() for text in figure.texts), *legend])


def drawn(axes: Axes, gid: str) -> list[FloatArray]:
    return [np.asarray(line.get_xydata()) for line in axes.lines if line.get_gid() == gid]


def test_arrows_are_as_far_apart_on_the_page_as_on_a_quiet_line_when_a_slow_flight_is_noisy() -> None:
    noisy = LINE + np.random.default_rng(2).normal(0.0, 4.0, LINE.shape)
    quiet, found = arrows_on(LINE, 1.0), arrows_on(noisy, 25.0)
    assert len(quiet) == 1000.0 // ARROW_EVERY_PT
    assert abs(len(found) - len(quiet)) <= 1
    gaps = np.diff(np.sort([head[:, 0].mean() for head in found]))
    assert gaps.min() > 0.6 * ARROW_EVERY_PT
    assert all(head[0, 0] > head[1, 0] for head in found)


def test_laps_on_the_same_line_do_not_heap_up_their_arrows() -> None:
    angle = np.linspace(0.0, 2 * np.pi, 2000)
    lap = 200.0 * np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    assert len(arrows_on(np.concatenate([lap] * 7), 1.0)) <= 2 * len(arrows_on(lap, 1.0))
    there_and_back = np.concatenate([LINE, LINE[::-1]])
    assert len(arrows_on(there_and_back, 1.0)) == 20


def test_a_line_of_one_point_has_no_arrow() -> None:
    assert arrows_on(LINE[:1], 1.0) == []


def test_the_error_is_told_by_colour_with_a_scale() -> None:
    plan = plan_of(PAPER_TOUR)
    error_m = np.zeros((500, 2))
    error_m[200:220, 0] = 0.4
    figure = flown_path(plan, parse_record(flight_of(plan, error_m=error_m, reports=500)[0]))
    axes, scale = figure.axes
    (lines,) = [each for each in axes.collections if isinstance(each, LineCollection) and each.get_gid() == "error"]
    shown = np.asarray(lines.get_array())
    assert shown.max() == pytest.approx(0.4)
    assert len(shown) <= MOST_STRETCHES
    assert lines.get_clim() == pytest.approx((0.0, 0.4))
    assert 10 <= np.count_nonzero(shown > 0.3) <= 22
    assert "error, m" in scale.get_ylabel()
    assert "±0.05 m" in scale.get_ylabel()
    assert scale.get_window_extent().x1 < figure.bbox.x1


def test_the_planned_path_is_white_where_the_flown_one_covers_it_and_black_elsewhere() -> None:
    axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
    draw_planned(axes, LINE, LINE[:2500] + np.array([0.0, 1.0]), 1.0)
    black, white = axes.lines
    np.testing.assert_array_equal(np.asarray(black.get_xydata()), LINE)
    seen = np.isfinite(np.asarray(white.get_xydata())).all(axis=1)
    assert seen[:2500].all()
    assert not seen[2520:].any()


def test_a_flight_that_never_began_has_no_colours() -> None:
    plan = plan_of(PAPER_TOUR)
    assert len(flown_path(plan, parse_record(flight_of(plan)[0].split(b"\n")[0] + b"\n")).axes) == 1


def test_a_mission_without_a_tube_is_said_to_have_none() -> None:
    plan = plan_of(PAPER_TOUR)
    with_tube = smoothed_path(plan)
    assert "Smoothed path and its tube" in words(with_tube)
    assert "tracking tube, ±0.05 m" in words(with_tube)
    bare = smoothed_path(replace(plan, certificate=replace(plan.certificate, tube_m=0.0)))
    assert "without a tube" in words(bare)
    assert "There is no tube" in words(bare).replace("\n", " ")
    assert "tracking tube" not in words(bare)
    assert not [patch for patch in bare.axes[0].patches if patch.get_gid() == "tube"]


def test_a_start_that_smoothing_moved_is_marked() -> None:
    plan = plan_of(PAPER_TOUR)
    begins = plan.curve.position(np.zeros(1))[0]
    for start_m, moved in (((begins[0], begins[1] + 0.3), True), (tuple(begins), False)):
        figure = smoothed_path(replace(plan, start_m=start_m))
        marks = drawn(figure.axes[0], "given start")
        assert len(marks) == moved
        assert all(np.array_equal(mark[0], start_m) for mark in marks)
        assert ("start as given" in words(figure)) is moved
        assert ("begins 0.3 m beside the start" in words(figure)) is moved


def test_a_name_that_does_not_fit_stands_close_to_its_region_with_a_leader() -> None:
    road = shapely.box(0.0, 0.0, 2.0, 400.0)
    em_m, size = 0.5, (8.0, 1.2)
    for obstacles in ([], [shapely.box(-100.0, 150.0, 102.0, 400.0)]):
        (name,) = place_names(
            [("long road", road, size)],
            em_m=em_m,
            sizes_pt=(12, 10, 8),
            obstacles=obstacles,
            frame=shapely.box(-150.0, -50.0, 150.0, 450.0),
        )
        box = name.box(em_m)
        assert box.distance(road) <= 1.5 * GAPS_EM[0] * em_m * name.size_pt
        assert not any(box.intersects(each) for each in [road, *obstacles])
        assert name.leader_m is not None
        assert road.distance(shapely.Point(name.leader_m)) < 1e-9


def test_no_picture_of_a_path_has_a_text_that_is_too_small_to_read() -> None:
    plan = plan_of(SURVEY_TOUR)
    record = parse_record(flight_of(plan)[0])
    for figure in (smoothed_path(plan), flown_path(plan, record)):
        texts = [*figure.texts, *(text for axes in figure.axes for text in axes.texts)]
        assert min(float(text.get_fontsize()) for text in texts) >= 8.0
    assert any(isinstance(each, PolyCollection) for each in figure.axes[0].collections)
