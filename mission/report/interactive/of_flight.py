"""What the map and the histories show of a plan and of its flight's record."""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import FloatArray
from mission.geometry.shapes import polygonal
from mission.monitor.attitude import tilt
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.coverage import covered_again
from mission.report.figures.chart import chart_of
from mission.report.figures.filtering import filtered, time_constant
from mission.report.figures.paths import tube_pieces
from mission.report.interactive.scene import (
    Area,
    Band,
    Bound,
    Cover,
    Dots,
    Flown,
    History,
    Layer,
    Margin,
    Nearest,
    Scene,
    Timeline,
    Trace,
)
from mission.report.moving import begun, clock_s, distances_at, drifting, in_order_at, instants_s
from mission.report.palette import BLUE, GREEN, KIND_COLOUR, LOOP, MESH, ORANGE, PLANNED, QUIET, SKY_BLUE, TUBE
from mission.report.reading import Record
from mission.report.summary import condensed
from mission.report.tracking import led_by_field, nearest_to, tracking_of
from mission.spec.model import FIELD, RegionKind
from mission.spec.restricted import restricted_as_drawn

MOST_ROWS: Final = 2400
"""So many reports are shown at most: more than a screen has columns."""
_NOISY: Final = ("speed", "error", "tilt", "misjudged")
_SAMPLES: Final = 1200
_SIMPLER: Final = 2e-4
"""Of the size of the domain: as much may a drawn line be off."""

_GROUND, _CLIMBING, _FLYING, _HOLDING, _LANDING = "on the ground", "climbing", "flying", "holding", "landing"
_PHASES: Final[Mapping[Stage, str]] = {
    **dict.fromkeys(Stage, _GROUND),
    **dict.fromkeys((Stage.TAKE_OFF, Stage.CLIMB, Stage.STREAM, Stage.OFFBOARD, Stage.SETTLE), _CLIMBING),
    **dict.fromkeys((Stage.FLY, Stage.ARRIVE), _FLYING),
    Stage.HOLD: _HOLDING,
    **dict.fromkeys((Stage.LAND, Stage.TOUCH_DOWN), _LANDING),
}
_PHASE_COLOUR: Final = {_GROUND: MESH, _CLIMBING: SKY_BLUE, _FLYING: GREEN, _HOLDING: ORANGE, _LANDING: LOOP}


def scene_of(plan: FlightPlan, record: Record | None) -> Scene:
    """The map of a plan, and of its flight where there is one."""
    chart = chart_of(plan)
    plans = [plan, *(later.plan for later in record.later)] if record else [plan]
    instants = instants_s(plan).tolist()
    moves = drifting(plan)

    def later(name: str, shape: BaseGeometry) -> tuple[BaseGeometry, ...]:
        return tuple(in_order_at(plan, name, shape, time_s) for time_s in instants if name in moves)

    fine_m = _SIMPLER * float(np.ptp(np.reshape(chart.land.bounds, (2, 2)), axis=0).max())
    return Scene(
        land=chart.land,
        areas=tuple(
            Area(name if name in moves else chart.titles[name], chart.kinds[name], shape, later(name, shape))
            for name, shape in chart.shapes.items()
        ),
        margins=tuple(Margin(more, later(name, more)) for name, _, more, _ in chart.margins),
        covers=(*_tubes(plans, fine_m), *_left_out(plan, record)),
        layers=(*_lanes(plans), *_paths(plans, fine_m), *_truth(record)),
        dots=_images(record),
        nearest=() if record is None else _nearest(plan, record),
        instants_s=tuple(instants),
    )


def flown_of(plan: FlightPlan, record: Record) -> tuple[Flown, Timeline]:
    """What was flown over time, thinned so that a page can hold it, with all extremes."""
    track = record.track
    known = np.isfinite(track.t_s)
    t_s, position = track.t_s[known], track.position_m[known]
    columns = {
        "height": position[:, 2],
        "speed": np.hypot(*track.velocity_m_s[known, :2].T),
        "tilt": np.rad2deg(tilt(track.attitude_rad[known])),
        **_asked(plan, record, t_s),
    }
    columns |= _surroundings(record, t_s, position)
    constant_s = time_constant(t_s)
    columns |= {_low(name): _low_passed(t_s, columns[name], constant_s) for name in _NOISY}
    rows = _thinned(t_s, columns)
    flown = Flown(t_s[rows], position[rows, :2], {name: values[rows] for name, values in columns.items()})
    restricted = restricted_as_drawn(plan.spec, plan.partition, plan.labelling)
    if restricted:
        clocks_s = clock_s(record, flown.t_s)
        with np.errstate(invalid="ignore"):  # of a place that is not known
            each = [distances_at(plan, name, shape, clocks_s, flown.position_m) for name, shape in restricted.items()]
        nearness = np.min(each, axis=0)
        flown = Flown(flown.t_s, flown.position_m, {**flown.columns, "nearness": nearness})
    histories = tuple(each for each in _histories(plan, constant_s) if _is_known(each, flown))
    began_s = begun(record)
    return flown, Timeline(
        _regions(plan, record, t_s), _phases(record, t_s), histories, began_s if math.isfinite(began_s) else None
    )


def _low(name: str) -> str:
    """The column of a noisy quantity without its noise."""
    return f"{name} low"


def _low_passed(t_s: FloatArray, values: FloatArray, constant_s: float) -> FloatArray:
    """A quantity without its noise at the same times; NaN where it is not known."""
    if not np.isfinite(values).any():
        return np.full(len(t_s), np.nan)
    seen = filtered(t_s, values, constant_s)
    return np.where(np.isfinite(values), np.interp(t_s, seen.t_s, seen.line), np.nan)


def _noisy(name: str, label: str, constant_s: float) -> tuple[Trace, Trace]:
    """A quantity as it was reported, light, and without its noise, strong."""
    return (
        Trace(name, label, SKY_BLUE, 0.8),
        Trace(_low(name), f"low-pass, {constant_s:g} s", BLUE, 2.0),
    )


def _histories(plan: FlightPlan, constant_s: float) -> tuple[History, ...]:
    tube_m, by_field = plan.certificate.tube_m, plan.spec.flight.guidance == FIELD
    tube = (Bound(f"tube, {tube_m:.3g} m", tube_m),) if tube_m > 0.0 and not by_field else ()
    tilt_deg = float(np.rad2deg(plan.spec.limits.tilt_rad))
    return (
        History("Height above the take-off point", "m", (Trace("height", "height", BLUE),), digits=1),
        History(
            "Speed over ground",
            "m/s",
            (*_noisy("speed", "reported", constant_s), Trace("asked_speed", "asked for", PLANNED, 1.0)),
            from_zero=True,
        ),
        History(
            "Distance from the trajectory, on the worse axis",
            "m",
            _noisy("error", "error", constant_s),
            tube,
            from_zero=True,
        ),
        History("Estimate off the truth, simulated", "m", _noisy("misjudged", "error", constant_s), from_zero=True),
        History("Distance to the nearest restricted region", "m", (Trace("nearness", "", BLUE),), from_zero=True),
        History(
            "Tilt",
            "°",
            _noisy("tilt", "tilt", constant_s),
            (Bound(f"limit, {tilt_deg:.3g}°", tilt_deg),),
            digits=1,
            from_zero=True,
        ),
        History("Battery left", "%", (Trace("charge", "", BLUE),), digits=0, from_zero=True),
        History("Delay of the link, both ways", "ms", (Trace("delay", "", BLUE),), digits=0, from_zero=True),
        History("Lost on the link", "%", (Trace("lost", "", BLUE),), digits=1, from_zero=True),
        History("Wind, as the vehicle tells it", "m/s", (Trace("wind", "", BLUE),), digits=1, from_zero=True),
    )


def _surroundings(record: Record, t_s: FloatArray, position_m: FloatArray) -> dict[str, FloatArray]:
    """Battery, link and wind at the times of the reports, as they were told last, and how far off the reports were."""
    told, charges = record.conditions, record.charges
    charged_s, percent = np.array([each.t_s for each in charges]), np.array([each.percent for each in charges])
    return {
        "charge": _last_told(t_s, charged_s, percent),
        "delay": _last_told(t_s, told.t_s, 1e3 * told.delay_s),
        "lost": _last_told(t_s, told.t_s, 1e2 * told.lost),
        "wind": _last_told(t_s, told.t_s, told.wind_m_s),
        "misjudged": _misjudged(record, t_s, position_m),
    }


def _misjudged(record: Record, t_s: FloatArray, position_m: FloatArray) -> FloatArray:
    """How far the reports were from the truth; NaN where that was not told."""
    truth = record.truth
    if not len(truth.t_s):
        return np.full(len(t_s), np.nan)
    true_m = np.stack([np.interp(t_s, truth.t_s, axis, left=np.nan, right=np.nan) for axis in truth.position_m.T], 1)
    distance: FloatArray = np.hypot(*(position_m[:, :2] - true_m).T)
    return distance


def _last_told(t_s: FloatArray, told_s: FloatArray, values: FloatArray) -> FloatArray:
    """What had been told at each time; NaN before the first."""
    if not len(told_s):
        return np.full(len(t_s), np.nan)
    at = np.searchsorted(told_s, t_s, side="right") - 1
    return np.where(at >= 0, values[np.maximum(at, 0)], np.nan)


def _is_known(history: History, flown: Flown) -> bool:
    """Whether there is anything to draw of it."""
    column = history.traces[0].column
    return column in flown.columns and bool(np.isfinite(flown.columns[column]).any())


def _asked(plan: FlightPlan, record: Record, t_s: FloatArray) -> dict[str, FloatArray]:
    """What was asked for at the times of the reports, and how far off they were; NaN off the trajectory."""
    tracking = led_by_field(record) if plan.spec.flight.guidance == FIELD else tracking_of(record)
    at = np.searchsorted(t_s, tracking.t_s)
    error, speed = np.full(len(t_s), np.nan), np.full(len(t_s), np.nan)
    error[at] = np.abs(tracking.error_m).max(axis=1, initial=0.0) if len(at) else np.nan
    speed[at] = np.hypot(*tracking.asked_velocity_m_s.T)
    return {"error": error, "asked_speed": speed}


def _thinned(t_s: FloatArray, columns: Mapping[str, FloatArray]) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Rows that are shown: evenly chosen, and where a column is least or most."""
    rows = set(range(0, len(t_s), max(1, -(-len(t_s) // MOST_ROWS)))) | ({len(t_s) - 1} if len(t_s) else set())
    for values in columns.values():
        if np.isfinite(values).any():
            rows |= {int(np.nanargmin(values)), int(np.nanargmax(values))}
    return np.array(sorted(rows), dtype=np.intp)


def _phases(record: Record, t_s: FloatArray) -> tuple[Band, ...]:
    entered = [
        (event.t_s, _PHASES[Stage(event.values["stage"])])
        for event in record.events
        if event.text == "stage" and np.isfinite(event.t_s)
    ]
    changes = [each for k, each in enumerate(entered) if not k or each[1] != entered[k - 1][1]]
    return _bands(changes, t_s, _PHASE_COLOUR)


def _regions(plan: FlightPlan, record: Record, t_s: FloatArray) -> tuple[Band, ...]:
    """When the vehicle was in which regions, of the smallest kind that matters; open ground is left white."""
    kinds = {region.name: region.kind for region in plan.spec.regions}
    visits = [(visit.t_s, sorted(visit.labels)) for visit, _ in condensed(record.visits) if np.isfinite(visit.t_s)]
    changes = [(at_s, ", ".join(labels)) for at_s, labels in visits]
    colour = {", ".join(labels): _colour([kinds[name] for name in labels if name in kinds]) for _, labels in visits}
    return tuple(band for band in _bands(changes, t_s, colour) if band.text)


def _colour(kinds: Sequence[RegionKind]) -> str:
    order = (RegionKind.RESTRICTED, RegionKind.SURVEY, RegionKind.HOME, RegionKind.AREA)
    return next((KIND_COLOUR[kind] for kind in order if kind in kinds), MESH)


def _bands(changes: Sequence[tuple[float, str]], t_s: FloatArray, colour: Mapping[str, str]) -> tuple[Band, ...]:
    """Stretches of time between changes; the last one ends with the reports."""
    if not changes:
        return ()
    end_s = max(float(t_s[-1]) if len(t_s) else changes[-1][0], changes[-1][0])
    return tuple(
        Band(from_s, to_s, text, colour[text]) for (from_s, text), (to_s, _) in pairwise([*changes, (end_s, "")])
    )


def _paths(plans: Sequence[FlightPlan], fine_m: float) -> Iterable[Layer]:
    for number, plan in enumerate(plans, 1):
        which = "" if number == 1 else f", plan {number}"
        times = np.union1d(np.linspace(0.0, plan.path.duration_s, _SAMPLES), plan.path.knots_s)
        dash = "solid" if number == 1 else "dashed"
        yield Layer(f"planned{which}", _simple(plan.path.position(times), fine_m), QUIET, 1.4, "dotted")
        yield Layer(f"smoothed{which}", _simple(_curve(plan), fine_m), PLANNED, 1.4, dash)


def _curve(plan: FlightPlan) -> FloatArray:
    return plan.curve.position(np.linspace(0.0, plan.curve.duration_s, _SAMPLES))


def _simple(points_m: FloatArray, fine_m: float) -> FloatArray:
    """The same line with fewer points."""
    return np.asarray(shapely.get_coordinates(shapely.LineString(points_m).simplify(fine_m)), dtype=np.float64)


def _tubes(plans: Sequence[FlightPlan], fine_m: float) -> tuple[Cover, ...]:
    pieces = [
        shapely.union_all(tube_pieces(_curve(plan), plan.certificate.tube_m))
        for plan in plans
        if plan.certificate.tube_m > 0.0 and plan.spec.flight.guidance != FIELD
    ]
    if not pieces:
        return ()
    return (Cover("tube", polygonal(shapely.union_all(pieces).simplify(fine_m)), TUBE, 0.55),)


def _left_out(plan: FlightPlan, record: Record | None) -> tuple[Cover, ...]:
    left = polygonal(
        shapely.union_all([visit.left_out for visit in covered_again(plan, record)]) if record else shapely.Polygon()
    )
    return () if left.is_empty else (Cover("not covered", left, LOOP, 0.9),)


def _lanes(plans: Sequence[FlightPlan]) -> tuple[Layer, ...]:
    lanes = [visit.lanes_m for plan in plans for visit in plan.covers]
    if not lanes:
        return ()
    broken = [np.concatenate([lane, [[np.nan, np.nan]]]) for each in lanes for lane in each]
    return (Layer("lanes", np.concatenate(broken), ORANGE, 1.2),)


def _truth(record: Record | None) -> tuple[Layer, ...]:
    """Where a simulated vehicle really was."""
    if record is None or len(record.truth.t_s) == 0:
        return ()
    return (Layer("true path of the simulated vehicle", record.truth.position_m, GREEN, 1.6),)


def _images(record: Record | None) -> tuple[Dots, ...]:
    taken = [each for each in record.pictures if np.isfinite(each.position_m[:2]).all()] if record else []
    if not taken:
        return ()
    texts = tuple(f"image {each.number} at {each.t_s:.1f} s" for each in taken)
    return (Dots("images", np.array([each.position_m[:2] for each in taken]), texts),)


def _nearest(plan: FlightPlan, record: Record) -> tuple[Nearest, ...]:
    found = []
    for name, (ends, distance_m) in nearest_to(plan, record).items():
        (x0, y0), (x1, y1) = ends.tolist()
        found.append(Nearest(name, (x0, y0), (x1, y1), distance_m))
    return tuple(found)
