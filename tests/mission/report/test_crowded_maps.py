"""Maps of many triangles: the run is strong, the rest is faint, and no text is too small to read."""

from collections.abc import Callable

import numpy as np
import pytest
import shapely
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from mission.geometry.arrays import FloatArray
from mission.plan import FlightPlan
from mission.report.figures.automaton import automaton
from mission.report.figures.canvas import LEAST_PT
from mission.report.figures.partition import annotated_partition
from mission.report.figures.paths import planned_path
from mission.report.figures.quotient import MOST_IN_FULL, quotient
from tests.support.drawn_plans import PAPER_TOUR, PATROL_TOUR, SURVEY_TOUR, Tour, plan_of


def points_of(figure: Figure, gid: str) -> FloatArray:
    (drawn,) = [each for each in figure.axes[0].collections if each.get_gid() == gid]
    return np.asarray(drawn.get_offsets(), dtype=np.float64)


@pytest.mark.parametrize("tour", [SURVEY_TOUR, PATROL_TOUR])
def test_the_quotient_of_many_triangles_shows_the_run_and_its_neighbours(tour: Tour) -> None:
    plan = plan_of(tour)
    assert plan.partition.size > MOST_IN_FULL
    centres = plan.partition.corners_m.mean(axis=1)
    run = sorted(set(plan.run.states))
    restricted = set(np.flatnonzero(plan.restricted).tolist())
    neighbours = {n for i in run for n in plan.partition.neighbours[i].tolist() if n >= 0} - set(run) - restricted
    figure = quotient(plan)
    np.testing.assert_array_equal(points_of(figure, "run's states"), centres[run])
    np.testing.assert_array_equal(points_of(figure, "neighbours' states"), centres[sorted(neighbours)])
    widths = {
        each.get_gid(): float(np.asarray(each.get_linewidth()).max())
        for each in figure.axes[0].collections
        if isinstance(each, LineCollection) and each.get_gid() in ("neighbours", "others", None)
    }
    assert widths[None] > widths["neighbours"] > widths["others"]


@pytest.mark.parametrize("tour", [SURVEY_TOUR, PATROL_TOUR])
def test_numbers_of_the_run_keep_off_its_moves_and_each_other_and_those_without_room_are_counted(tour: Tour) -> None:
    plan = plan_of(tour)
    figure = quotient(plan)
    (axes,) = figure.axes
    figure.draw_without_rendering()
    shown = [text for text in axes.texts if text.get_gid() == "state"]
    run = set(plan.run.states)
    assert {int(text.get_text()) for text in shown} <= run
    lost = len(run) - len(shown)
    assert (f"{lost} numbers of states have no room" in figure.texts[-1].get_text()) == (lost > 0)
    boxes = [shapely.box(*axes.transData.inverted().transform(text.get_window_extent()).ravel()) for text in shown]
    order = [*plan.run.states, plan.run.suffix[0]]
    way = shapely.LineString(plan.partition.corners_m.mean(axis=1)[order])
    assert not shapely.intersects(boxes, way).any()
    assert len(shapely.STRtree(boxes).query(boxes, predicate="overlaps")[0]) == 0


@pytest.mark.parametrize("draw", [quotient, annotated_partition, planned_path, automaton])
@pytest.mark.parametrize("tour", [PAPER_TOUR, SURVEY_TOUR])
def test_no_text_is_too_small_to_read(draw: Callable[[FlightPlan], Figure], tour: Tour) -> None:
    figure = draw(plan_of(tour))
    texts = [*figure.texts, *(text for axes in figure.axes for text in axes.texts)]
    texts += [text for legend in figure.legends for text in legend.get_texts()]
    texts += [label for axes in figure.axes for label in (*axes.get_xticklabels(), *axes.get_yticklabels())]
    assert min(float(text.get_fontsize()) for text in texts) >= LEAST_PT
