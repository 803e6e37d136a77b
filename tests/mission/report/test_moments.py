"""Pictures of missions in which something moves: where it is later, and the flight at several moments."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from mission.report.figures import save_simulated
from mission.report.figures.chart import chart_of
from mission.report.figures.moments import planned_moments
from mission.report.figures.paths import smoothed_path
from mission.report.moving import drifting, shape_at
from mission.simulate import simulate_plan
from tests.support.drifting_plans import drifting_plan


def outlines(figure: Figure, gid: str) -> list[shapely.Polygon]:
    (axes,) = figure.axes
    patches = [each for each in axes.patches if isinstance(each, PathPatch) and each.get_gid() == gid]
    return [shapely.Polygon(patch.get_path().to_polygons()[0]) for patch in patches]


def test_what_moves_is_drawn_where_it_begins_and_its_later_places_are_outlined() -> None:
    plan = drifting_plan()
    figure = smoothed_path(plan)
    (begin,) = outlines(figure, "region:K")
    assert begin.equals(shapely.box(64, 12, 80, 28))
    later = outlines(figure, "later")
    assert np.allclose([each.bounds[1] for each in later], [12 + 10 / 3, 12 + 20 / 3, 22.0])
    (axes,) = figure.axes
    (way,) = (line for line in axes.lines if line.get_gid() == "way")
    assert np.allclose(np.asarray(way.get_xydata())[[0, -1]], [[72, 20], [72, 30]])
    assert "K\nby [0, 10] m\nuntil 20 s" in {text.get_text() for text in axes.texts}


def test_each_moment_shows_the_map_and_the_flight_as_they_are_then() -> None:
    plan = drifting_plan()
    figure = planned_moments(plan)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[:3] == ["0.0 s: begin of the flight, begin of the motion", "6.7 s: 1/3 of the motion", *titles[2:3]]
    assert titles[-1] == f"{plan.trajectory.duration_s:.1f} s: end of the flight"
    for axes, title in zip(figure.axes, titles, strict=True):
        time_s = float(title.split(" s:")[0])
        (mark,) = (line for line in axes.lines if line.get_gid() == "vehicle")
        place = np.asarray(mark.get_xydata())[0]
        assert np.abs(place - plan.trajectory.position(time_s)[0]).max() < 0.5
        (k,) = (each for each in axes.patches if each.get_gid() == "region:K")
        assert isinstance(k, PathPatch)
        assert k.get_path().get_extents().y0 == pytest.approx(12.0 + min(10.0, 0.5 * time_s), abs=0.1)


def test_a_chart_at_a_time_has_the_triangles_and_clearances_of_that_time() -> None:
    plan = drifting_plan()
    assert plan.moving is not None
    chart = chart_of(plan, 12.0)
    assert (chart.partition.vertices_m == plan.moving.vertices_at(12.0)).all()
    assert chart.shapes["K"].equals(shapely.box(64, 18, 80, 34))
    assert drifting(plan) == {"K": (0.0, 20.0)}
    home = chart.shapes["home"]
    assert shape_at(plan, "home", home, 12.0) is home


def test_a_simulated_flight_is_shown_at_several_moments_where_something_moves(tmp_path: Path) -> None:
    plan = drifting_plan()
    files = save_simulated(plan, simulate_plan(plan), tmp_path)
    assert files[-1].name == "11_true_moments.png"
    assert files[-1].read_bytes().startswith(b"\x89PNG")
