"""The map: the ground with its regions, the paths, the tube, and the place that is pointed at."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from bokeh.models import ColumnDataSource, DataRange1d, HoverTool, MultiPolygons, Scatter, Text
from bokeh.plotting import figure
from shapely.geometry.base import BaseGeometry
from shapely.ops import polylabel

from mission.geometry.arrays import FloatArray
from mission.geometry.shapes import polygonal
from mission.printable import printable
from mission.report.interactive.scene import Area, Scene
from mission.report.palette import (
    BLACK,
    FILL_ALPHA,
    FLOWN,
    KIND_COLOUR,
    MARGIN_ALPHA,
    QUIET,
    VERMILLION,
    WHITE,
)
from mission.spec.model import RegionKind

MAP = "map"
FLOWN_LABEL = "flown, as reported"
_FLATTEST, _TALLEST = 2.4, 0.8
_FRAME_SHARE = 0.88  # of the width, where the numbers of the axis take the rest
_LABEL_SHARE = 0.02
_FONT = "13px"
_DIGITS = 3
_AREA, _MARGIN, _NAMES = "area {}", "margin {}", "names"


def map_of(scene: Scene, flown: ColumnDataSource, cursor: ColumnDataSource) -> figure:
    """Draw a map.

    Layers, covers, dots and the flown path are renderers with their labels as names, so that a page can switch them.

    Args:
        scene: What is known of the ground and of the plan.
        flown: As ``flown_source`` makes it; may have no rows yet.
        cursor: As ``cursor_source`` makes it.
    """
    west, south, east, north = scene.land.bounds
    aspect = min(max((east - west) / (north - south), _TALLEST), _FLATTEST)
    plot = figure(
        name=MAP,
        x_range=DataRange1d(range_padding=0.03),
        y_range=DataRange1d(range_padding=0.03),
        match_aspect=True,
        sizing_mode="scale_width",
        aspect_ratio=aspect * _FRAME_SHARE,
        tools="pan,wheel_zoom,box_zoom,reset,save",
        active_scroll=None,
        toolbar_location="above",
        x_axis_label="east, m",
        y_axis_label="north, m",
        background_fill_color=WHITE,
    )
    plot.toolbar.logo = None
    plot.grid.grid_line_color = "#E4E4E4"
    land = plot.add_glyph(_polygons(scene.land), MultiPolygons(fill_color="#FAFAF7", line_color=BLACK, line_width=1.4))
    plot.x_range.renderers = plot.y_range.renderers = [land]
    _draw_areas(plot, scene)
    for cover in scene.covers:
        glyph = MultiPolygons(fill_color=cover.colour, fill_alpha=cover.alpha, line_color=cover.colour, line_width=0.6)
        plot.add_glyph(_polygons(cover.shape), glyph, name=cover.label)
    plot.line("x", "y", source=flown, line_color=FLOWN, line_width=3.0, line_join="round", name=FLOWN_LABEL)
    for layer in scene.layers:
        x, y = layer.points_m.T.astype(np.float32)
        plot.line(
            x,
            y,
            line_color=layer.colour,
            line_width=layer.width,
            line_dash=layer.dash,
            line_join="round",
            name=layer.label,
        )
    for dots in scene.dots:
        source = ColumnDataSource({**_columns(dots.points_m), "text": [printable(text) for text in dots.texts]})
        drawn = plot.add_glyph(source, Scatter(size=5, fill_color=BLACK, line_color=WHITE), name=dots.label)
        plot.add_tools(HoverTool(renderers=[drawn], tooltips="@text", visible=False))
    _draw_nearest(plot, scene)
    _draw_names(plot, scene)
    mark = Scatter(size=15, fill_color=VERMILLION, line_color=WHITE, line_width=2.5)
    plot.add_glyph(cursor, mark, level="overlay")
    return plot


def moving_columns(scene: Scene) -> dict[str, list[dict[str, Any]]]:
    """Of each source of a map that moves, by its name, the columns that change, at each of the scene's instants."""
    shapes = {_AREA.format(k): area.later for k, area in enumerate(scene.areas)}
    shapes |= {_MARGIN.format(k): margin.later for k, margin in enumerate(scene.margins)}
    found = {name: [_rings(shape) for shape in later] for name, later in shapes.items() if later}
    for k, _ in enumerate(scene.instants_s if found else ()):
        x, y = np.array([_middle_at(area, scene, k) for area in scene.areas]).round(_DIGITS).T.tolist()
        found.setdefault(_NAMES, []).append({"x": x, "y": y})
    return found


def layer_colours(scene: Scene) -> dict[str, str]:
    """What can be switched on a map, and the colour of each."""
    covers = {cover.label: cover.colour for cover in scene.covers}
    layers = {layer.label: layer.colour for layer in scene.layers}
    return {**covers, **layers, **{dots.label: BLACK for dots in scene.dots}}


def _draw_areas(plot: figure, scene: Scene) -> None:
    for number, area in enumerate(scene.areas):
        colour, hatched = KIND_COLOUR[area.kind], area.kind is RegionKind.RESTRICTED
        plot.add_glyph(
            _polygons(area.shape, _AREA.format(number)),
            MultiPolygons(
                fill_color=colour,
                fill_alpha=FILL_ALPHA[area.kind],
                line_color=colour,
                line_width=1.8,
                hatch_pattern="/" if hatched else " ",
                hatch_color=colour,
                hatch_alpha=0.6,
            ),
        )
    for number, margin in enumerate(scene.margins):
        glyph = MultiPolygons(fill_color=BLACK, fill_alpha=0.5 * MARGIN_ALPHA, line_color=QUIET, line_dash="dashed")
        plot.add_glyph(_polygons(margin.shape, _MARGIN.format(number)), glyph)


def _draw_nearest(plot: figure, scene: Scene) -> None:
    for near in scene.nearest:
        plot.line(*np.array([near.flown_m, near.region_m]).T, line_color=VERMILLION, line_width=2, line_dash="dotted")
    # Written on the region's side of the line, where they hide no path.
    ends = [near.region_m for near in scene.nearest]
    away = np.sign([np.subtract(near.region_m, near.flown_m) for near in scene.nearest]).reshape(-1, 2)
    offsets = {
        "x_offset": (8 * away[:, 0]).tolist(),
        "y_offset": (-10 * away[:, 1]).tolist(),
        "text_align": ["right" if side < 0 else "left" for side in away[:, 0]],
    }
    texts = [f"{near.distance_m:.1f} m" for near in scene.nearest]
    _write(plot, ends, texts, offsets, text_color=VERMILLION, text_font_size="12px")


def _draw_names(plot: figure, scene: Scene) -> None:
    places = [_middle(area, scene) for area in scene.areas]
    names = [area.name for area in scene.areas]
    written = [(place.x, place.y) for place in places]
    _write(plot, written, names, {}, source=_NAMES, text_color=BLACK, text_font_size=_FONT)


def _middle_at(area: Area, scene: Scene, instant: int) -> tuple[float, float]:
    """Where its name stands at an instant."""
    first = _middle(area, scene)
    if not area.later:
        return first.x, first.y
    (east, north), (x, y) = (
        shapely.get_coordinates(shape.centroid)[0] for shape in (area.later[0], area.later[instant])
    )
    return float(first.x + x - east), float(first.y + y - north)


def _middle(area: Area, scene: Scene) -> shapely.Point:
    """Where there is most room in a region, beside the smaller ones that lie in it."""
    inside = [other.shape for other in scene.areas if other.shape.area < area.shape.area]
    own = polygonal(shapely.difference(area.shape, shapely.union_all(inside)))
    parts = [part for part in shapely.get_parts(own if own.area > 0.0 else area.shape) if part.area > 0.0]
    part = max(parts, key=lambda each: float(each.area))
    return polylabel(part, _LABEL_SHARE * math.sqrt(part.area))


def _write(
    plot: figure,
    places_m: Sequence[Sequence[float]],
    texts: Sequence[str],
    columns: Mapping[str, Sequence[Any]],
    source: str | None = None,
    **look: str,
) -> None:
    """Write names on the map; texts of a glyph are drawn as they are, those of a label would be read for formulas."""
    places = {"x": [x for x, _ in places_m], "y": [y for _, y in places_m], "text": list(map(printable, texts))}
    style = {"text_align": {"value": "center"}, **look, **{name: {"field": name} for name in columns}}
    glyph = Text(**style, text_baseline="middle", background_fill_color=WHITE, background_fill_alpha=0.75, padding=1)
    plot.add_glyph(ColumnDataSource({**places, **columns}, name=source), glyph)


def _columns(points_m: FloatArray) -> dict[str, Any]:
    x, y = points_m.T.astype(np.float32)
    return {"x": x, "y": y}


def _polygons(shape: BaseGeometry, name: str | None = None) -> ColumnDataSource:
    """A shape as one row of polygons with holes."""
    return ColumnDataSource(_rings(shape), name=name)


def _rings(shape: BaseGeometry) -> dict[str, Any]:
    parts = [part for part in shapely.get_parts(polygonal(shape)) if not part.is_empty]
    rings = [[ring.coords[:-1] for ring in (part.exterior, *part.interiors)] for part in parts]
    xs = [[[round(x, _DIGITS) for x, _ in ring] for ring in part] for part in rings]
    ys = [[[round(y, _DIGITS) for _, y in ring] for ring in part] for part in rings]
    return {"xs": [xs], "ys": [ys]}
