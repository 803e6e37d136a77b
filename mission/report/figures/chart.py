"""The domain as a map: axes of equal scale in metres, the mesh behind, regions filled, restricted ones hatched."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import FloatArray
from mission.geometry.regions import Labelling, union_of
from mission.geometry.shapes import polygonal
from mission.geometry.simplices import Partition
from mission.plan import FlightPlan
from mission.report.figures.canvas import (
    NOTE_LINE_PT,
    NOTE_PT,
    SIDE_PT,
    about,
    head_pt,
    in_width,
    new_figure,
    plain,
    text_size_em,
    titled,
)
from mission.report.figures.filtering import round_number
from mission.report.figures.fitting import Placed
from mission.report.moving import drifting, partition_at, shape_at
from mission.report.palette import (
    BLACK,
    FILL_ALPHA,
    HATCH,
    KIND_COLOUR,
    MARGIN_ALPHA,
    MARGIN_DASHES,
    MESH,
    QUIET,
    WHITE,
)
from mission.spec.areas import Ground, boundary_ground, region_ground
from mission.spec.model import BoundaryDomain, RegionKind
from mission.spec.windows import window_text

WIDTH_PT = 620.0
SMALLEST_WIDTH_PT = 430.0
LARGEST_MAP_HEIGHT_PT = 560.0
LEFT_PT, RIGHT_PT, BOTTOM_PT, ABOVE_MAP_PT = 54.0, 14.0, 58.0, 6.0
LEGEND_ROW_PT = 17.0
PAD_PT = 14.0
SCALE_STRIP_PT = 26.0
MOST_TRIANGLES_DRAWN_STRONG = 150
_FADING = (0.75, 0.5, 0.3)
_LATER = len(_FADING)
_OF_THE_WAY = 25
_SHORT_WAY_PT = 8.0
_NARROW_EM = 8.0


@dataclass(frozen=True, eq=False)
class Chart:
    """A domain with what is drawn of it on every map.

    Attributes:
        plan: Whose mesh and labels are drawn.
        kinds: What each region is for, by name, in the order of the mission file.
        fence: Where the vehicle may fly; None where the mesh alone says that.
        grounds: The areas of regions that have one, by name.
        time_s: The time on the clock of the trajectory of which it is the map; None for that of the whole flight, where
            what moves is drawn where it begins, and its later places are outlined.
    """

    plan: FlightPlan
    kinds: dict[str, RegionKind]
    fence: Ground | None = None
    grounds: dict[str, Ground] = field(default_factory=dict)
    time_s: float | None = None

    @cached_property
    def partition(self) -> Partition:
        """The mesh."""
        return partition_at(self.plan, self.time_s or 0.0)

    @property
    def labelling(self) -> Labelling:
        """Which regions each triangle belongs to."""
        return self.plan.labelling

    @cached_property
    def land(self) -> BaseGeometry:
        """The domain, its boundary as it is drawn."""
        if self.fence is not None:
            return self.fence.drawn
        return union_of(self.partition, np.arange(self.partition.size))

    @cached_property
    def titles(self) -> dict[str, str]:
        """The name of each region, and when it is there if that is for a time only, or how it moves."""
        texts = {region.name: window_text(region) for region in self.plan.spec.regions}
        moves = {region.name: region.motion.text for region in self.plan.spec.regions if region.motion is not None}
        told = {name: f"{name} ({text})" if text else name for name, text in texts.items()}
        return told | {name: f"{name}\n{in_width(text, _NARROW_EM)}" for name, text in moves.items()}

    @cached_property
    def shapes(self) -> dict[str, BaseGeometry]:
        """Each region as it is drawn, but for what lies outside of the domain."""
        shapes = {name: self.shape_at(name, self.time_s or 0.0) for name in self.kinds}
        return {name: shape for name, shape in shapes.items() if shape.area > 0.0}

    def shape_at(self, name: str, time_s: float) -> BaseGeometry:
        """A region as it is drawn at a time."""
        if name not in self.grounds:
            return union_of(partition_at(self.plan, time_s), self.labelling.triangles_of(name))
        drawn = shape_at(self.plan, name, self.grounds[name].drawn, time_s)
        return polygonal(shapely.intersection(drawn, self.land))

    @cached_property
    def margins(self) -> list[tuple[str, str, BaseGeometry, BaseGeometry]]:
        """Of each clearance whose it is, its colour, the ground up to where it ends, and the line where it ends.

        That of the boundary has no name.
        """
        of_regions = [(name, KIND_COLOUR[self.kinds[name]], ground) for name, ground in self.grounds.items()]
        bounds = [] if self.fence is None else [("", BLACK, self.fence)]
        found = []
        for name, colour, ground in (*bounds, *of_regions):
            drawn, kept = (shape_at(self.plan, name, each, self.time_s or 0.0) for each in (ground.drawn, ground.kept))
            more = polygonal(shapely.intersection(shapely.symmetric_difference(drawn, kept), self.land))
            if ground.clearance_m > 0.0 and not more.is_empty:
                found.append((name, colour, more, shapely.intersection(kept.boundary, self.land)))
        return found

    @cached_property
    def restricted(self) -> frozenset[int]:
        """Triangles that are never entered."""
        return frozenset(np.flatnonzero(self.plan.restricted).tolist())

    @cached_property
    def bounds_m(self) -> FloatArray:
        """West, south, east, north of the domain."""
        return np.array(self.land.bounds)

    @cached_property
    def em_m(self) -> float:
        """Metres for one point on paper."""
        west, south, east, north = self.bounds_m
        width = WIDTH_PT - LEFT_PT - RIGHT_PT - 2 * PAD_PT
        height = LARGEST_MAP_HEIGHT_PT - 2 * PAD_PT - SCALE_STRIP_PT
        return float(max((east - west) / width, (north - south) / height))

    @cached_property
    def limits_m(self) -> FloatArray:
        """West, south, east, north of the axes."""
        west, south, east, north = self.bounds_m
        pad = PAD_PT * self.em_m
        least = (SMALLEST_WIDTH_PT - LEFT_PT - RIGHT_PT) * self.em_m
        more = max(0.0, 0.5 * (least - (east - west) - 2 * pad))
        return np.array([west - pad - more, south - pad - SCALE_STRIP_PT * self.em_m, east + pad + more, north + pad])

    @property
    def frame(self) -> BaseGeometry:
        """Where names may stand: the axes without the strip of the scale bar."""
        west, south, east, north = self.limits_m
        return shapely.box(west, south + SCALE_STRIP_PT * self.em_m, east, north)

    def figure(
        self, title: str, *, legend: list[Artist], note: str = "", beside_pt: float = 0.0
    ) -> tuple[Figure, Axes]:
        """An empty map: axes, scale bar, title, mission, and a legend of the region kinds and of the artists given.

        To the right of it ``beside_pt`` points are left empty.
        """
        west, south, east, north = self.limits_m
        handles = self.kind_handles() + legend
        map_width, map_height = (east - west) / self.em_m, (north - south) / self.em_m
        width = LEFT_PT + map_width + RIGHT_PT + beside_pt
        rows = _rows(handles, width - 20)
        about_it = about(self.plan, width)
        head = head_pt(about_it)
        top = head + ABOVE_MAP_PT + LEGEND_ROW_PT * len(rows)
        note = in_width(note, (width - 2 * SIDE_PT) / NOTE_PT)
        bottom = BOTTOM_PT + NOTE_LINE_PT * note.count("\n") if note else BOTTOM_PT - 14
        height = bottom + map_height + top
        figure = new_figure(width, height)
        axes = figure.add_axes((LEFT_PT / width, bottom / height, map_width / width, map_height / height))
        axes.set(xlim=(west, east), ylim=(south, north), xlabel="east, m", ylabel="north, m")
        axes.set_aspect("equal", adjustable="box")
        axes.locator_params(nbins=8)
        titled(figure, title, note, about_it)
        for index, row in enumerate(rows):
            at = (SIDE_PT / width, 1 - (head + 2 + LEGEND_ROW_PT * index) / height)
            figure.legend(
                handles=row,
                loc="upper left",
                bbox_to_anchor=at,
                ncols=len(row),
                borderpad=0,
                borderaxespad=0,
                handlelength=1.9,
                handletextpad=0.5,
                columnspacing=1.2,
            )
        self._scale_bar(axes)
        return figure, axes

    def draw_domain(self, axes: Axes, *, mesh: bool = True) -> None:
        """Fill and outline the regions, draw the mesh and the boundary of the domain."""
        corners = self.partition.corners_m
        fine = 0.7 if self.partition.size <= MOST_TRIANGLES_DRAWN_STRONG else 0.35
        if mesh:
            axes.add_collection(
                PolyCollection(list(corners), facecolors="none", edgecolors=MESH, linewidths=fine, zorder=1)
            )
        for name, shape in self.shapes.items():
            kind = self.kinds[name]
            path = outline_of(shape)
            axes.add_patch(
                PathPatch(path, facecolor=KIND_COLOUR[kind], alpha=FILL_ALPHA[kind], linewidth=0, zorder=0.5)
            )
            hatch = HATCH if kind is RegionKind.RESTRICTED else None
            axes.add_patch(
                PathPatch(
                    path,
                    facecolor="none",
                    edgecolor=KIND_COLOUR[kind],
                    linewidth=1.6,
                    hatch=hatch,
                    zorder=1.5,
                    gid=f"region:{name}",
                )
            )
        axes.add_patch(PathPatch(outline_of(self.land), facecolor="none", edgecolor=BLACK, linewidth=1.2, zorder=1.6))
        for _, colour, ground, rim in self.margins:
            axes.add_patch(
                PathPatch(
                    outline_of(ground), facecolor=colour, alpha=MARGIN_ALPHA, linewidth=0, zorder=0.6, gid="margin"
                )
            )
            lines = [shapely.get_coordinates(line) for line in shapely.get_parts(rim)]
            axes.add_collection(
                LineCollection(
                    lines, colors=colour, linewidths=1.0, linestyles=[MARGIN_DASHES], zorder=1.55, gid="margin"
                )
            )
        for name in self._later:
            self._draw_later(axes, name)

    @property
    def _later(self) -> list[str]:
        """The regions whose later places are outlined."""
        return [name for name in drifting(self.plan) if name in self.shapes] if self.time_s is None else []

    def _draw_later(self, axes: Axes, name: str) -> None:
        """Where a region is later, ever fainter, and the way that it goes."""
        begin_s, end_s = drifting(self.plan)[name]
        colour, times = KIND_COLOUR[self.kinds[name]], np.linspace(begin_s, end_s, _LATER + 1)
        for time_s, alpha in zip(times[1:].tolist(), _FADING, strict=True):
            rim = outline_of(self.shape_at(name, time_s))
            axes.add_patch(
                PathPatch(rim, facecolor="none", edgecolor=colour, alpha=alpha, linewidth=1.3, zorder=1.5, gid="later")
            )
        finely = np.linspace(begin_s, end_s, _OF_THE_WAY)
        way = np.array([shapely.get_coordinates(self.shape_at(name, t).centroid)[0] for t in finely.tolist()])
        if shapely.LineString(way).length > _SHORT_WAY_PT * self.em_m:
            axes.plot(*way.T, color=colour, lw=1.2, zorder=1.7, gid="way")
            arrow = {"arrowstyle": "-|>,head_length=0.6,head_width=0.25", "color": colour, "lw": 1.2, "shrinkA": 0.0}
            axes.annotate("", xy=way[-1], xytext=way[-2], arrowprops={**arrow, "shrinkB": 0.0}, zorder=1.7)

    def kind_handles(self) -> list[Artist]:
        """The entries of a legend for what a map has of the mission."""
        present = [kind for kind in RegionKind if any(self.kinds[name] is kind for name in self.shapes)]
        handles: list[Artist] = [
            Patch(
                facecolor=(KIND_COLOUR[kind], FILL_ALPHA[kind]),
                edgecolor=KIND_COLOUR[kind],
                hatch=HATCH if kind is RegionKind.RESTRICTED else None,
                label=kind.value,
            )
            for kind in present
        ]
        if self._later:
            label = "later places, ever fainter"
            handles.append(Line2D([], [], color=QUIET, lw=1.3, alpha=_FADING[0], label=label))
        if self.margins:
            face = (BLACK, MARGIN_ALPHA)
            handles.append(Patch(facecolor=face, edgecolor=BLACK, linestyle=MARGIN_DASHES, label="clearance"))
        return handles

    def _scale_bar(self, axes: Axes) -> None:
        west, south, east, _ = self.limits_m
        length = round_number(0.22 * (east - west))
        x, y, tick = west + PAD_PT * self.em_m, south + 11 * self.em_m, 3 * self.em_m
        axes.add_collection(
            LineCollection(
                [
                    [(x, y), (x + length, y)],
                    [(x, y - tick), (x, y + tick)],
                    [(x + length, y - tick), (x + length, y + tick)],
                ],
                colors=BLACK,
                linewidths=1.6,
                zorder=6,
                gid="scale",
            )
        )
        axes.text(x + length + 6 * self.em_m, y, f"{length:g} m", fontsize=9.5, va="center", gid="scale")


def chart_of(plan: FlightPlan, time_s: float | None = None) -> Chart:
    """The chart of a plan's domain, at a time where that is given."""
    domain, regions = plan.spec.domain, plan.spec.regions
    grounds = {region.name: region_ground(region, domain) for region in regions}
    return Chart(
        plan,
        {region.name: region.kind for region in regions},
        boundary_ground(domain) if isinstance(domain, BoundaryDomain) else None,
        {name: ground for name, ground in grounds.items() if ground is not None},
        time_s,
    )


def draw_names(
    axes: Axes, placed: tuple[Placed, ...], *, colour: str = BLACK, bold: bool = True, gid: str = "name"
) -> None:
    """Write placed names, each on a faint white ground, with its leader where it has one."""
    for name in placed:
        if name.leader_m is not None:
            axes.add_line(
                Line2D([name.x_m, name.leader_m[0]], [name.y_m, name.leader_m[1]], color=QUIET, lw=0.8, zorder=4.5)
            )
        axes.text(
            name.x_m,
            name.y_m,
            name.text,
            fontsize=name.size_pt,
            color=colour,
            ha="center",
            va="center",
            fontweight="bold" if bold else "normal",
            linespacing=1.0,
            zorder=5,
            gid=gid,
            bbox={"facecolor": WHITE, "alpha": 0.72, "linewidth": 0, "boxstyle": "square,pad=0.08"},
        )


def name_sizes(
    shapes: dict[str, BaseGeometry], titles: Mapping[str, str]
) -> list[tuple[str, BaseGeometry, tuple[float, float]]]:
    """The regions as ``place_names`` takes them: names stand where no smaller one lies, if they can."""
    names = []
    for name, shape in shapes.items():
        inside = [other for other in shapes.values() if other.area < shape.area]
        own = polygonal(shapely.difference(shape, shapely.union_all(inside)))
        title = plain(titles[name])
        names.append((title, own if own.area > 0.0 else shape, text_size_em(title, "bold")))
    return names


def _rows(handles: list[Artist], width_pt: float) -> list[list[Artist]]:
    """Break a legend into rows that are no wider than the figure."""
    rows: list[list[Artist]] = []
    used = 0.0
    for handle in handles:
        own = 9.5 * (text_size_em(str(handle.get_label()))[0] + 1.9 + 0.5 + 1.2)
        if not rows or used + own > width_pt:
            rows.append([])
            used = 0.0
        rows[-1].append(handle)
        used += own
    return rows


def outline_of(shape: BaseGeometry) -> Path:
    """A polygon, with holes or in several parts, as one path."""
    rings = [ring for part in shapely.get_parts(shape) for ring in (part.exterior, *part.interiors)]
    return Path.make_compound_path(*(Path(np.asarray(ring.coords), closed=True) for ring in rings))
