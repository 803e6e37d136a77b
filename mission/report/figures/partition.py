"""Figure 2: the partition, annotated with triangles, their vertices in order, and regions."""

from dataclasses import dataclass

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from mission.geometry.arrays import FloatArray
from mission.geometry.simplices import Partition
from mission.plan import FlightPlan
from mission.report.figures.canvas import LEAST_PT, LINE_HEIGHT_EM, drawing, plain, text_size_em
from mission.report.figures.chart import Chart, chart_of, draw_names, name_sizes
from mission.report.figures.fitting import Placed, boxes_at, largest_boxes, place_names, towards_incentres
from mission.report.palette import BLACK, QUIET, WHITE

MOST_ANNOTATED = 150
SIZES_PT = (10.5, 9.5, 8.5, LEAST_PT)
DIGIT_HEIGHT_EM = 0.75
NAME_SIZES_PT = (13.0, 11.5, 10.0, 8.5)
NAME_SCALE = 1.25
CLEAR_OF_EDGES = 0.93


@dataclass(frozen=True)
class Block:
    """The annotation of one triangle: a region's name in bold, where it is the one to carry it, over small lines."""

    triangle: int
    name: str
    lines: str

    @property
    def size_em(self) -> tuple[float, float]:
        """Width and height in units of the small lines' font size."""
        width, height = text_size_em(self.lines)
        if not self.name:
            return width, height
        name_width, name_height = text_size_em(self.name, "bold")
        return max(width, NAME_SCALE * name_width), height + NAME_SCALE * name_height


def annotated_partition(plan: FlightPlan) -> Figure:
    """Every triangle with its index and vertices, every region with its name; only names above 150 triangles."""
    chart = chart_of(plan)
    size = plan.partition.size
    with drawing():
        if size > MOST_ANNOTATED:
            note = f"{size} triangles are too many to number here; the tables of the plan list them."
            figure, axes = chart.figure(f"Partition: {size} triangles", legend=[], note=note)
            chart.draw_domain(axes)
            names = name_sizes(chart.shapes, chart.titles)
            draw_names(
                axes, place_names(names, em_m=chart.em_m, sizes_pt=NAME_SIZES_PT, obstacles=[], frame=chart.frame)
            )
            return figure
        disc_pt = _disc_pt(plan.partition)
        vertices = _apart(plan.partition, 2 * disc_pt * chart.em_m)
        annotated = _annotations(chart, vertices, disc_pt)
        example = (
            "T3 over 7 4 1: triangle 3 has the vertices 7, 4, 1, counter-clockwise; u1 leaves opposite vertex 7, ..."
        )
        note = f"{example} Without room for the vertices, its number stands alone{annotated.left_out}."
        figure, axes = chart.figure(f"Partition: {size} triangles", legend=[], note=note)
        chart.draw_domain(axes)
        _draw_vertices(axes, chart, vertices, disc_pt)
        for block, centre, size_pt in annotated.blocks:
            _draw_block(axes, block, centre, size_pt, chart.em_m, ground=block.triangle in chart.restricted)
        draw_names(axes, annotated.names)
        draw_names(axes, annotated.pointed, colour=QUIET, bold=False, gid="narrow")
    return figure


def _disc_pt(partition: Partition) -> float:
    """The radius of a disc that holds the longest number of a vertex."""
    width, _ = text_size_em(str(int(partition.triangles.max())))
    return 0.5 * LEAST_PT * float(np.hypot(width, DIGIT_HEIGHT_EM)) + 1.0


def _apart(partition: Partition, distance_m: float) -> list[int]:
    """The vertices that are numbered: each that is so far from those before it."""
    chosen: list[int] = []
    for vertex in np.unique(partition.triangles).tolist():
        ways = partition.vertices_m[chosen] - partition.vertices_m[vertex]
        if not chosen or float(np.hypot(*ways.T).min()) >= distance_m:
            chosen.append(vertex)
    return chosen


def _draw_vertices(axes: Axes, chart: Chart, numbered: list[int], disc_pt: float) -> None:
    x, y = chart.partition.vertices_m[numbered].T
    axes.scatter(x, y, s=(2 * disc_pt) ** 2, facecolor=WHITE, edgecolor=QUIET, linewidth=0.7, zorder=3)
    for vertex, at_x, at_y in zip(numbered, x.tolist(), y.tolist(), strict=True):
        axes.text(
            at_x,
            at_y,
            str(vertex),
            fontsize=LEAST_PT,
            color=QUIET,
            ha="center",
            va="center_baseline",
            zorder=4,
            gid="vertex",
        )


@dataclass(frozen=True, eq=False)
class _Annotations:
    """What is written into and beside triangles, and what has no room.

    Attributes:
        blocks: Each with its centre, metres, and size in points.
        names: Of regions that no block carries.
        pointed: Numbers of narrow triangles, beside them.
        left_out: What the note says of those that have no room.
    """

    blocks: list[tuple[Block, FloatArray, float]]
    names: tuple[Placed, ...]
    pointed: tuple[Placed, ...]
    left_out: str


def _annotations(chart: Chart, vertices: list[int], disc_pt: float) -> _Annotations:
    """Annotate each triangle as fully and as large as it has room for; then name the regions that are left."""
    partition = chart.partition
    regions = {name: chart.labelling.triangles_of(name) for name in chart.shapes}
    carriers = {int(own[np.argmax(partition.areas_m2[own])]): name for name, own in regions.items()}
    taken = list(shapely.buffer(shapely.points(partition.vertices_m[vertices]), disc_pt * chart.em_m))
    placed: list[tuple[Block, FloatArray, float]] = []
    waiting = list(range(partition.size))
    # From the fullest annotation to the barest, each for the triangles that had no room for the one before.
    for named, full in ((True, True), (True, False), (False, True), (False, False)):
        blocks = [
            _block(partition, i, chart.titles[carriers[i]] if named and i in carriers else "", full=full)
            for i in waiting
        ]
        sizes = np.array([block.size_em for block in blocks]).reshape(-1, 2)
        corners = partition.corners_m[waiting]
        centres, scales = largest_boxes(corners, sizes)
        waiting = []
        for k, block in enumerate(blocks):
            fit = _fit(corners[k], centres[k], sizes[k], scale=float(scales[k]), em_m=chart.em_m, disc_pt=disc_pt)
            if fit is None:
                waiting.append(block.triangle)
                continue
            size_pt, centre = fit
            if block.name:
                del carriers[block.triangle]
            placed.append((block, centre, size_pt))
            taken.append(boxes_at(centre[:1], centre[1:], block.size_em, chart.em_m * size_pt)[0])
    left = {name: chart.shapes[name] for name in carriers.values()}
    names = place_names(
        name_sizes(left, chart.titles), em_m=chart.em_m, sizes_pt=NAME_SIZES_PT, obstacles=taken, frame=chart.frame
    )
    taken += [name.box(chart.em_m) for name in names]
    shapes = shapely.polygons(partition.corners_m[waiting])
    narrow = [(f"T{i}", shape, text_size_em(f"T{i}")) for i, shape in zip(waiting, shapes, strict=True)]
    pointed = place_names(
        narrow, em_m=chart.em_m, sizes_pt=SIZES_PT[-1:], obstacles=taken, frame=chart.frame, needed=False
    )
    lost = len(narrow) - len(pointed), len(np.unique(partition.triangles)) - len(vertices)
    said = [f"{count} {what}" for count, what in zip(lost, ("triangles", "vertices"), strict=True) if count]
    left_out = f"; {' and '.join(said)} have no room for their numbers" if said else ""
    return _Annotations(placed, names, pointed, left_out)


def _block(partition: Partition, triangle: int, name: str, *, full: bool) -> Block:
    vertices = " ".join(map(str, partition.triangles[triangle].tolist()))
    return Block(triangle, plain(name), f"T{triangle}\n{vertices}" if full else f"T{triangle}")


def _fit(
    corners: FloatArray, centre: FloatArray, size: FloatArray, *, scale: float, em_m: float, disc_pt: float
) -> tuple[float, FloatArray] | None:
    """The largest font size, and a centre, that keep a block inside its triangle and off the discs of the vertices."""
    for size_pt in SIZES_PT:
        box = em_m * size_pt * size / CLEAR_OF_EDGES
        if em_m * size_pt > CLEAR_OF_EDGES * scale:
            continue
        at = towards_incentres(corners[None], centre[None], box[None])[0]
        for spot in (at, centre):
            gaps = np.maximum(np.abs(corners - spot) - 0.5 * box, 0.0)
            if np.hypot(gaps[:, 0], gaps[:, 1]).min() > (disc_pt + 1.0) * em_m:
                return size_pt, spot
    return None


def _draw_block(axes: Axes, block: Block, centre: FloatArray, size_pt: float, em_m: float, *, ground: bool) -> None:
    x, y = centre.tolist()
    width, height = block.size_em
    if ground:  # letters on hatching are hard to read
        corner = (x - 0.5 * width * size_pt * em_m, y - 0.5 * height * size_pt * em_m)
        box = Rectangle(corner, width * size_pt * em_m, height * size_pt * em_m)
        box.set(facecolor=WHITE, alpha=0.85, linewidth=0, zorder=4)
        axes.add_patch(box)
    top = y + 0.5 * height * size_pt * em_m
    if block.name:
        name_height = NAME_SCALE * LINE_HEIGHT_EM * size_pt * em_m
        axes.text(
            x,
            top - 0.5 * name_height,
            block.name,
            fontsize=NAME_SCALE * size_pt,
            fontweight="bold",
            color=BLACK,
            ha="center",
            va="center",
            zorder=5,
            gid="name",
        )
        top -= name_height
    y = 0.5 * (top + y - 0.5 * height * size_pt * em_m)
    axes.text(
        x,
        y,
        block.lines,
        fontsize=size_pt,
        color=QUIET,
        ha="center",
        va="center",
        linespacing=1.0,
        zorder=5,
        gid="triangle",
    )
