"""The figures of the page: the map of a plan with its mesh, fields and vehicle, and its automaton."""

from collections.abc import Iterable
from typing import Any, Final

import numpy as np
from bokeh.document import Document
from bokeh.models import Circle, ColumnDataSource, MultiLine, Range1d, Ray, Scatter, Segment, Text
from bokeh.plotting import figure

from mission.geometry.arrays import FloatArray, IntArray
from mission.plan import FlightPlan
from mission.plan.definitions import fields_of_run
from mission.printable import printable
from mission.report.figures.automaton import ACCEPTING_FILL, shown_part
from mission.report.figures.automaton_layout import DISC_PT, Arrangement, Part
from mission.report.interactive.chart_map import FLOWN_LABEL, layer_colours, map_of
from mission.report.interactive.embedding import moving_of
from mission.report.interactive.of_flight import scene_of
from mission.report.interactive.scene import Flown, Scene
from mission.report.interactive.sources import cursor_source, flown_source
from mission.report.palette import BLACK, BLUE, FLOWN, MESH, QUIET, VERMILLION, WHITE, YELLOW

MAP_ID: Final = "map"
AUTOMATON_ID: Final = "automaton"
_MESH_LABEL, _FIELDS_LABEL = "triangles", "fields of the run"
_MESH: Final = "mesh"
_PX_A_PT: Final = 4.0 / 3.0
_MARGIN_PT: Final = 10.0
_RIM_PT: Final = 4.0
_NOSE_PX: Final = 20
_ARROWS_ACROSS: Final = 36
"""So many arrows of the fields stand side by side on the map."""


def figures(plan: FlightPlan) -> dict[str, Any]:
    """Both figures as JSON values, what can be switched on the map, and where the states of the automaton stand.

    The sources ``flown`` (t, x, y), ``cursor`` (t, x, y, angle) and ``present`` (x, y) are for the page to fill; where
    something moves, those that ``moving`` has the columns of are for it to change.
    """
    scene = scene_of(plan, None)
    nowhere = Flown(np.empty(0), np.empty((0, 2)), {})
    flown, cursor = flown_source(nowhere), cursor_source(nowhere)
    cursor.data["angle"] = np.empty(0)
    ground = map_of(scene, flown, cursor)
    paths = ground.renderers[1:]
    _draw_mesh(ground, plan)
    if plan.moving is None:
        _draw_fields(ground, plan)
    ground.renderers = [*ground.renderers[:1], *ground.renderers[1 + len(paths) :], *paths]  # between land and the rest
    nose = Ray(length=_NOSE_PX, length_units="screen", angle="angle", line_color=VERMILLION, line_width=5)
    ground.add_glyph(cursor, nose, level="overlay")
    part, arrangement = shown_part(plan)
    drawn = _automaton(plan, part, arrangement)
    document = Document()
    document.add_root(ground)
    document.add_root(drawn)
    roots = {ground.id: MAP_ID, drawn.id: AUTOMATON_ID}
    return {
        "documents": {"page": document.to_json(deferred=False)},
        "items": [{"docid": "page", "roots": roots, "root_ids": [*roots]}],
        "layers": layer_colours(scene)
        | {FLOWN_LABEL: FLOWN, _MESH_LABEL: MESH}
        | ({_FIELDS_LABEL: QUIET} if plan.moving is None else {}),
        **({"moving": moving} if (moving := _moving(plan, scene)) else {}),
        "states": dict(zip(map(str, part.states), arrangement.nodes.round(1).tolist(), strict=True)),
        "key": [printable(line) for line in (*part.key, *part.note.splitlines())],
    }


def _draw_mesh(ground: figure, plan: FlightPlan) -> None:
    """Each edge once, as one broken line, behind all else."""
    ends = plan.partition.vertices_m[_edges(plan)]
    source = _segments(ends[:, 0], ends[:, 1])
    source.name = _MESH
    ground.add_glyph(source, Segment(line_color=MESH, line_width=0.7), name=_MESH_LABEL)


def _edges(plan: FlightPlan) -> IntArray:
    """The ends of each edge of the mesh once, shape (E, 2)."""
    pairs = np.sort(plan.partition.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(pairs, axis=0)


def _moving(plan: FlightPlan, scene: Scene) -> dict[str, Any]:
    """What moves, the mesh included; empty where nothing does."""
    told = moving_of(scene)
    if plan.moving is None:
        return {}
    edges, frames = _edges(plan), []
    for time_s in scene.instants_s:
        (x0, y0), (x1, y1) = plan.moving.vertices_at(time_s)[edges].round(3).transpose(1, 2, 0).tolist()
        frames.append({"x0": x0, "y0": y0, "x1": x1, "y1": y1})
    return {"times": [*scene.instants_s], "sources": {**told.get("sources", {}), _MESH: frames}}


def _draw_fields(ground: figure, plan: FlightPlan) -> None:
    """The direction of each field at points of its triangle, faint."""
    west, south, east, north = plan.partition.corners_m.reshape(-1, 2).min(0).tolist() + (
        plan.partition.corners_m.reshape(-1, 2).max(0).tolist()
    )
    step_m = max(east - west, north - south) / _ARROWS_ACROSS
    lattice = np.stack(
        np.meshgrid(np.arange(west + 0.5 * step_m, east, step_m), np.arange(south + 0.5 * step_m, north, step_m)), -1
    ).reshape(-1, 2)
    inside = plan.locator.triangle_at(lattice)
    places, ways = [np.empty((0, 2))], [np.empty((0, 2))]
    for field in fields_of_run(plan):
        at_m = lattice[inside == field.triangle]
        flow = at_m @ field.F.T + field.g
        places.append(at_m)
        ways.append(flow / np.maximum(np.hypot(*flow.T), 1e-12)[:, None])
    at_m, way = np.concatenate(places), 0.36 * step_m * np.concatenate(ways)
    source = _segments(at_m - way, at_m + way)
    source.data["angle"] = np.arctan2(way[:, 1], way[:, 0]) - 0.5 * np.pi
    faint = {"line_color": QUIET, "line_alpha": 0.45}
    ground.add_glyph(source, Segment(line_width=0.9, **faint), name=_FIELDS_LABEL)
    head = Scatter(x="x1", y="y1", angle="angle", marker="triangle", size=5, fill_color=QUIET, fill_alpha=0.45)
    head.line_color = None
    ground.add_glyph(source, head, name=_FIELDS_LABEL)


def _segments(from_m: FloatArray, to_m: FloatArray) -> ColumnDataSource:
    (x0, y0), (x1, y1) = from_m.T.astype(np.float32), to_m.T.astype(np.float32)
    return ColumnDataSource({"x0": x0, "y0": y0, "x1": x1, "y1": y1})


def _automaton(plan: FlightPlan, part: Part, arrangement: Arrangement) -> figure:
    """The automaton as the picture of it stands, in points; its present states are filled."""
    (west, south), (east, north) = arrangement.corners + np.array([[-_MARGIN_PT], [_MARGIN_PT]])
    plot = figure(
        name=AUTOMATON_ID,
        width=round(_PX_A_PT * (east - west)),
        height=round(_PX_A_PT * (north - south)),
        x_range=Range1d(west, east),
        y_range=Range1d(south, north),
        tools="",
        toolbar_location=None,
        min_border=0,
        outline_line_color=None,
        background_fill_color=WHITE,
    )
    plot.axis.visible = plot.grid.visible = False
    idle = [k in part.idle for k in range(len(arrangement.curves))]
    _draw_arrows(plot, arrangement.curves, [QUIET if each else BLACK for each in idle])
    _draw_arrows(plot, arrangement.starts, [BLACK] * len(arrangement.starts))
    accepting = [state in plan.shown_automaton.accepting for state in part.states]
    x, y = arrangement.nodes.T
    fill = [ACCEPTING_FILL if each else WHITE for each in accepting]
    states = ColumnDataSource({"x": x, "y": y, "fill": fill, "text": [f"q{state}" for state in part.states]})
    plot.add_glyph(states, Circle(radius=DISC_PT, fill_color="fill", line_color=BLACK))
    present = ColumnDataSource({"x": [], "y": []}, name="present")
    plot.add_glyph(present, Circle(radius=DISC_PT, fill_color=YELLOW, line_color=VERMILLION, line_width=4))
    inner = arrangement.nodes[accepting]
    rims = ColumnDataSource({"x": inner[:, 0], "y": inner[:, 1]})
    plot.add_glyph(rims, Circle(radius=DISC_PT - _RIM_PT, fill_color=None, line_color=BLACK))
    plot.add_glyph(states, Text(text_align="center", text_baseline="middle", text_font_size="10pt"))
    x, y = arrangement.labels.T
    guards = ColumnDataSource(
        {
            "x": x,
            "y": y,
            "text": [printable(text) if "\n" not in text else text for text in part.texts],
            "colour": [QUIET if each else BLUE for each in idle],
        }
    )
    written = Text(
        text_color="colour",
        text_align="center",
        text_baseline="middle",
        text_font_size=f"{arrangement.size_pt}pt",
        background_fill_color=WHITE,
        background_fill_alpha=0.85,
    )
    plot.add_glyph(guards, written)
    return plot


def _draw_arrows(plot: figure, curves: Iterable[FloatArray], colours: list[str]) -> None:
    lines = [curve for curve in curves if len(curve) > 1]
    ends = np.array([curve[-1] for curve in lines]).reshape(-1, 2)
    ways = np.array([curve[-1] - curve[max(-4, -len(curve))] for curve in lines]).reshape(-1, 2)
    source = ColumnDataSource(
        {"xs": [line[:, 0] for line in lines], "ys": [line[:, 1] for line in lines], "colour": colours}
    )
    plot.add_glyph(source, MultiLine(line_color="colour"))
    lengths = np.maximum(np.hypot(*ways.T), 1e-12)[:, None]
    middle = ends - 4.0 * ways / lengths
    heads = ColumnDataSource(
        {
            "x": middle[:, 0],
            "y": middle[:, 1],
            "angle": np.arctan2(ways[:, 1], ways[:, 0]) - 0.5 * np.pi,
            "colour": colours,
        }
    )
    plot.add_glyph(heads, Scatter(marker="triangle", size=9, angle="angle", fill_color="colour", line_color="colour"))
