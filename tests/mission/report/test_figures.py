"""The pictures, judged by their artists and by where their texts really stand."""

from collections.abc import Callable
from itertools import combinations, pairwise, product

import matplotlib as mpl
import numpy as np
import pytest
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from numpy.typing import ArrayLike

from mission.errors import AutomatonSizeError
from mission.geometry.arrays import FloatArray
from mission.logic.automata.translate import translate
from mission.logic.formula.parser import parse_formula
from mission.plan import FlightPlan
from mission.report.figures.automaton import automaton, automaton_of_formula, states_along
from mission.report.figures.automaton_layout import DISC_PT
from mission.report.figures.canvas import plain, text_size_em, to_png
from mission.report.figures.chart import chart_of
from mission.report.figures.histories import control_signals, time_histories, tracked_states
from mission.report.figures.partition import annotated_partition
from mission.report.figures.paths import flown_path, planned_path, smoothed_path, tube_pieces
from mission.report.figures.quotient import quotient
from mission.report.palette import KIND_COLOUR, OKABE_ITO
from mission.report.reading import parse_record
from mission.spec.model import RegionKind
from tests.support.drawn_plans import PAPER_TOUR, PATROL_TOUR, SURVEY_TOUR, Tour, flight_of, plan_of, record_of
from tests.support.usual_cases import sampled

TOURS = [PAPER_TOUR, SURVEY_TOUR, PATROL_TOUR]
MAPS: list[Callable[[FlightPlan], Figure]] = [
    annotated_partition,
    quotient,
    planned_path,
    smoothed_path,
    lambda plan: flown_path(plan, record_of(plan)),
]


def texts(axes: Axes, *names: str) -> list[Text]:
    return [text for text in axes.texts if text.get_gid() in names]


def boxes(figure: Figure, shown: list[Text]) -> list[Bbox]:
    figure.draw_without_rendering()
    return [text.get_window_extent() for text in shown]


def floats(values: ArrayLike) -> FloatArray:
    return np.asarray(values, dtype=np.float64)


def overlaps(shown: list[Bbox], slack_px: float = 0.5) -> int:
    return sum(
        a.x0 < b.x1 - slack_px and b.x0 < a.x1 - slack_px and a.y0 < b.y1 - slack_px and b.y0 < a.y1 - slack_px
        for a, b in combinations(shown, 2)
    )


@sampled(("draw", "tour"), product(MAPS, TOURS), [(draw, TOURS[i % len(TOURS)]) for i, draw in enumerate(MAPS)])
def test_a_map_has_equal_axes_hatched_restricted_regions_names_and_a_scale(
    draw: Callable[[FlightPlan], Figure], tour: Tour
) -> None:
    plan = plan_of(tour)
    figure = draw(plan)
    axes = figure.axes[0]
    figure.draw_without_rendering()
    assert axes.get_aspect() == 1.0
    pixels = axes.transData.transform([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    assert pixels[1, 0] - pixels[0, 0] == pytest.approx(pixels[2, 1] - pixels[0, 1], rel=1e-6)
    assert sorted(text.get_text() for text in texts(axes, "name")) == sorted(r.name for r in plan.spec.regions)
    outlines = {p.get_gid(): p for p in axes.patches if isinstance(p, PathPatch) and p.get_gid() is not None}
    for region in plan.spec.regions:
        outline = outlines[f"region:{region.name}"]
        assert bool(outline.get_hatch()) == (region.kind is RegionKind.RESTRICTED)
        assert to_hex(outline.get_edgecolor()).upper() == KIND_COLOUR[region.kind]
    (scale,) = texts(axes, "scale")
    assert scale.get_text().endswith(" m")


@pytest.mark.parametrize("tour", TOURS)
def test_the_annotated_partition_shows_every_triangle_and_vertex_and_no_text_covers_another(tour: Tour) -> None:
    plan = plan_of(tour)
    figure = annotated_partition(plan)
    (axes,) = figure.axes
    shown = texts(axes, "triangle", "narrow", "name", "vertex")
    lines = [text.get_text().split("\n") for text in texts(axes, "triangle", "narrow")]
    assert sorted(int(line[0].removeprefix("T")) for line in lines) == list(range(plan.partition.size))
    for line in lines:
        if len(line) > 1:
            assert [int(v) for v in line[1].split()] == plan.partition.triangles[int(line[0][1:])].tolist()
    assert {int(text.get_text()) for text in texts(axes, "vertex")} == set(np.unique(plan.partition.triangles).tolist())
    assert overlaps(boxes(figure, shown)) == 0


@pytest.mark.parametrize("tour", TOURS)
def test_a_triangle_s_annotation_lies_inside_it(tour: Tour) -> None:
    plan = plan_of(tour)
    figure = annotated_partition(plan)
    (axes,) = figure.axes
    shown = texts(axes, "triangle")
    to_domain = axes.transData.inverted()
    for text, box in zip(shown, boxes(figure, shown), strict=True):
        triangle = shapely.Polygon(plan.partition.corners_m[int(text.get_text().split("\n")[0][1:])])
        corners = to_domain.transform(box.corners())
        width, _ = to_domain.transform((1.0, 0.0)) - to_domain.transform((0.0, 0.0))
        assert shapely.contains(triangle.buffer(2.0 * width), shapely.MultiPoint(corners).envelope)


@pytest.mark.parametrize("tour", TOURS)
def test_names_keep_off_the_path_and_off_each_other(tour: Tour) -> None:
    plan = plan_of(tour)
    for draw, line in ((planned_path, "planned"), (smoothed_path, "smoothed")):
        figure = draw(plan)
        (axes,) = figure.axes
        shown = boxes(figure, texts(axes, "name"))
        (path,) = [shapely.LineString(drawn.get_xydata()) for drawn in axes.lines if drawn.get_gid() == line]
        for box in shown:
            west, south, east, north = axes.transData.inverted().transform(box).ravel()
            assert not path.intersects(shapely.box(west, south, east, north))
        assert overlaps(shown) == 0


def test_a_long_note_is_broken_into_lines_between_the_map_and_the_edges_of_the_picture() -> None:
    note = "Run of 400 states: " + " ".join(f"T{i}" for i in range(700, 745))
    figure, axes = chart_of(plan_of(SURVEY_TOUR)).figure("Path", legend=[], note=note)
    (shown,) = [text for text in figure.texts if text.get_text().split() == note.split()]
    figure.draw_without_rendering()
    box, label = shown.get_window_extent(), axes.xaxis.label.get_window_extent()
    assert shown.get_text().count("\n") >= 1
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.x1
    assert box.y0 >= 0.0
    assert box.y1 <= label.y0


def test_lines_and_fills_are_of_the_palette() -> None:
    plan = plan_of(PAPER_TOUR)
    for draw in (planned_path, smoothed_path, MAPS[-1]):
        axes = draw(plan).axes[0]
        colours = {to_hex(str(line.get_color())).upper() for line in axes.lines if line.get_gid()}
        colours |= {to_hex(patch.get_facecolor()).upper() for patch in axes.patches if patch.get_fill()}
        assert colours <= set(OKABE_ITO)


def test_the_flown_path_is_strong_and_the_planned_one_thin() -> None:
    axes = flown_path(plan_of(PAPER_TOUR), record_of(plan_of(PAPER_TOUR))).axes[0]
    widths = {line.get_gid(): line.get_linewidth() for line in axes.lines}
    assert widths["flown"] > 2 * widths["planned"]
    assert {"start", "end"} <= set(widths)


def test_a_loop_is_shown_for_recurrent_runs_only() -> None:
    for tour in TOURS:
        (axes,) = planned_path(plan_of(tour)).axes
        assert any(line.get_gid() == "loop" for line in axes.lines) == tour.recurrent


def test_the_quotient_has_a_state_a_triangle_and_the_paper_s_controls() -> None:
    plan = plan_of(PAPER_TOUR)
    (axes,) = quotient(plan).axes
    assert sorted(int(text.get_text()) for text in texts(axes, "state")) == list(range(13))
    neighbours = plan.partition.neighbours
    moves = [(i, j) for i in range(13) for j in range(3) if neighbours[i, j] >= 0 and 6 not in (i, neighbours[i, j])]
    assert len(texts(axes, "control")) == len(moves)
    written = sorted(text.get_text() for text in texts(axes, "control"))
    assert written == sorted(f"u{'₁₂₃'[j]}" for _, j in moves)
    assert "39 transitions" in axes.figure.texts[0].get_text()


def test_the_paper_s_automaton_shows_its_states_and_every_guard() -> None:
    plan = plan_of(PAPER_TOUR)
    figure = automaton(plan)
    (axes,) = figure.axes
    assert sorted(text.get_text() for text in texts(axes, "state")) == ["q0", "q1", "q2"]
    guards = [text.get_text().replace("\n", " ") for text in texts(axes, "guard")]
    signs = str.maketrans({"!": "¬", "&": "∧", "|": "∨"})
    assert sorted(guards) == sorted(str(edge.guard).translate(signs) for edge in plan.automaton.edges)
    accepting = next(drawn for drawn in axes.collections if drawn.get_gid() == "accepting")
    assert len(np.asarray(accepting.get_offsets())) == len(plan.automaton.accepting)


@pytest.mark.parametrize("tour", TOURS)
def test_no_text_of_an_automaton_covers_another(tour: Tour) -> None:
    figure = automaton(plan_of(tour))
    (axes,) = figure.axes
    assert overlaps(boxes(figure, texts(axes, "state", "guard", "key"))) == 0


FORMULAS = (
    "true",
    "false",
    "F a",
    "F G a | G F b",
    "F (a & X X X b)",
    "F a & F b & F c",
    "G (a -> F b) & G (c -> F d)",
    "G F a & G F b & G F c & G F d",
    "(G F a -> G F b) & (G F c -> G F d)",
    "F a & F b & F c & G (low -> !a & !b & !c U base)",
    "F (a & F (b & F (c & F (d & F (e & F (f & F (g & F h))))))) & G !k",
    'F (inspection_hall_north & F (loading_bay_7 & F "home base")) & G !restricted_area_east & G !"no fly zone"',
    "G (" + " | ".join(f"a_very_long_name_of_a_region_{i}" for i in range(12)) + ")",
)


@pytest.mark.parametrize("formula", FORMULAS)
def test_the_automaton_of_a_formula_is_drawn_whole_and_legibly(formula: str) -> None:
    machine = translate(parse_formula(formula))
    figure = automaton_of_formula(machine, formula)
    (axes,) = figure.axes
    assert len(texts(axes, "state")) == machine.size
    assert len(texts(axes, "guard")) == machine.edge_count
    shown = boxes(figure, [*texts(axes, "state", "guard", "key"), *figure.texts])
    assert overlaps(shown) == 0
    page = figure.bbox
    assert all(page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1 for box in shown)


def test_no_guard_of_a_loop_lies_on_another_arrow() -> None:
    figure = automaton_of_formula(translate(parse_formula("F a & F b & F c")), "")
    (axes,) = figure.axes
    arrows = next(drawn for drawn in axes.collections if isinstance(drawn, LineCollection))
    lines = [shapely.LineString(line) for line in arrows.get_segments()]
    guards = [
        shapely.box(*axes.transData.inverted().transform(box).ravel()) for box in boxes(figure, texts(axes, "guard"))
    ]
    for guard, line in zip(guards, lines, strict=True):
        if shapely.Point(line.coords[0]).distance(shapely.Point(line.coords[-1])) < 2 * DISC_PT:
            assert not any(guard.intersects(other) for other in lines)


def test_an_automaton_that_fills_more_than_a_page_is_refused() -> None:
    for formula in ("F a & F b & F c & F d", "F a & F b & F c & F d & F e"):
        with pytest.raises(AutomatonSizeError, match="cannot be read in a picture"):
            automaton_of_formula(translate(parse_formula(formula)), formula)


def test_the_states_along_the_run_read_its_word() -> None:
    plan = plan_of(PAPER_TOUR)
    along = states_along(plan)
    assert set(along) == {0, 1, 2}
    assert along[0] in plan.automaton.initial
    assert along[-1] in plan.automaton.accepting


def test_histories_show_what_was_asked_and_what_was_reported() -> None:
    plan = plan_of(PAPER_TOUR)
    data, flown = flight_of(plan)
    record = parse_record(data)
    figure = tracked_states(plan, record)
    for column in range(2):
        drawn = {line.get_gid(): line for line in figure.axes[column].lines}
        np.testing.assert_allclose(floats(drawn["flown"].get_ydata()), flown[:, column])
        asked = plan.trajectory.position(np.asarray(drawn["asked"].get_xdata()))
        np.testing.assert_allclose(floats(drawn["asked"].get_ydata()), asked[:, column], atol=1e-9)
    bounds = [line.get_ydata() for line in figure.axes[4].lines if line.get_gid() == "tube"]
    assert sorted(float(np.asarray(bound)[0]) for bound in bounds) == pytest.approx([-0.05, 0.05])
    axes = time_histories(plan).axes[0]
    drawn = {line.get_gid(): line for line in axes.lines}
    times = np.asarray(drawn["planned"].get_xdata())
    np.testing.assert_array_equal(drawn["planned"].get_ydata(), plan.path.position(times)[:, 0])
    tilt = control_signals(plan, record).axes[2]
    assert any(
        line.get_gid() == "limit" and np.asarray(line.get_ydata())[0] == pytest.approx(20) for line in tilt.lines
    )


def test_a_flight_that_never_began_can_be_drawn() -> None:
    plan = plan_of(PAPER_TOUR)
    record = parse_record(flight_of(plan)[0].split(b"\n")[0] + b"\n")
    for draw in (tracked_states, control_signals, flown_path):
        assert to_png(draw(plan, record)).startswith(b"\x89PNG")


def test_the_tube_holds_exactly_what_is_within_its_half_width_on_each_axis() -> None:
    line = np.array([[0.0, 0.0], [2.0, 1.0], [2.0, 3.0]])
    tube = shapely.union_all(tube_pieces(line, 0.25))
    rng = np.random.default_rng(5)
    fraction = np.linspace(0.0, 1.0, 4001)[:, None]
    dense = np.concatenate([a + fraction * (b - a) for a, b in pairwise(line)])
    for point in rng.uniform(-0.5, 3.5, (200, 2)):
        reach = np.abs(dense - point).max(axis=1).min()
        if abs(reach - 0.25) > 1e-3:
            assert tube.contains(shapely.Point(point)) == (reach < 0.25)


def test_drawing_leaves_the_caller_s_style_alone() -> None:
    with mpl.rc_context({"font.size": 33.0, "text.usetex": False}):
        before = dict(mpl.rcParams)
        first = to_png(planned_path(plan_of(PAPER_TOUR)))
        assert dict(mpl.rcParams) == before
    assert first == to_png(planned_path(plan_of(PAPER_TOUR)))


def test_texts_that_the_font_lacks_or_that_look_like_mathematics_are_drawn_as_they_are() -> None:
    assert plain("a\u4e2d\x07b\nc") == "a\ufffd\ufffdb\nc"
    assert plain("$x$ Büchi ∧ ¬") == "$x$ Büchi ∧ ¬"
    width, height = text_size_em("MM\nM")
    assert width > 1.5
    assert height == pytest.approx(2 * 1.17)
