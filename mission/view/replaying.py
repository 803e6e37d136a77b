"""Moments of a flight that is over, from its record, and of one that is only planned, as if it flew its plan."""

import math
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from mission.fly.nearness import Nearness
from mission.fly.result import Progress
from mission.monitor.legs import FlightLegs
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.reading import Record
from mission.report.replay import legs_of
from mission.report.tracking import tracking_of
from mission.spec.model import Point

_INTENTION: Final = "intention"
_MOST_ROWS: Final = 1500
"""So many moments are shown at most: more than a screen has columns."""


def recorded(plan: FlightPlan, record: Record) -> Iterator[Progress]:
    """The moments of a flight.

    Args:
        plan: As it was flown first.
        record: The flight's, with its later plans.
    """
    track, tracking, legs = record.track, tracking_of(record), legs_of(plan, record)
    errors_m = np.abs(tracking.error_m).max(axis=1, initial=0.0)
    flown = dict(
        zip(tracking.t_s.tolist(), zip(tracking.trajectory_s.tolist(), errors_m.tolist(), strict=True), strict=True)
    )
    known = np.isfinite(track.t_s) & np.isfinite(track.position_m).all(axis=1)
    rows = np.flatnonzero(known).tolist()
    charges = [charge for charge in record.charges if math.isfinite(charge.percent + charge.t_s)]
    intended = [event for event in record.events if event.text == _INTENTION and math.isfinite(event.t_s)]
    shown, view = _every(len(rows)), _View(legs)
    for number, row in enumerate(rows):
        t_s, stage = float(track.t_s[row]), track.stages[row]
        east, north, up = track.position_m[row].tolist()
        legs.report(stage, t_s, (east, north))
        if number not in shown:
            continue
        trajectory_s, error_m = flown.get(t_s, (0.0, None))
        speed_m_s = float(np.hypot(*track.velocity_m_s[row, :2]))
        heading_rad = float(track.attitude_rad[row, 2])
        told = intended[: bisect_right(intended, t_s, key=lambda event: event.t_s)]
        charged = charges[: bisect_right(charges, t_s, key=lambda charge: charge.t_s)][-1:]
        moment = view.moment(
            stage or Stage.CONNECT,
            t_s,
            ((east, north), up),
            trajectory_s=trajectory_s,
            speed_m_s=speed_m_s,
            heading_rad=heading_rad if math.isfinite(heading_rad) else None,
            error_m=error_m,
        )
        yield replace(
            moment,
            told=tuple(str(event.values.get("reason")) for event in told),
            battery_percent=charged[0].percent if charged else None,
        )


def planned(plan: FlightPlan) -> Iterator[Progress]:
    """The moments of a vehicle that is where the plan says, of laps without end one."""
    legs = FlightLegs(plan)
    trajectory = plan.trajectory if math.isfinite(plan.trajectory.duration_s) else plan.trajectory.ended_after(0.0)
    times = np.linspace(0.0, trajectory.duration_s, _MOST_ROWS)
    position_m, velocity_m_s, *_ = trajectory.state(times)
    view = _View(legs)
    for t_s, (east, north), (east_m_s, north_m_s) in zip(
        times.tolist(), position_m.tolist(), velocity_m_s.tolist(), strict=True
    ):
        legs.report(Stage.FLY, t_s, (east, north))
        speed_m_s = math.hypot(east_m_s, north_m_s)
        yield view.moment(
            Stage.FLY,
            t_s,
            ((east, north), trajectory.altitude_m),
            trajectory_s=t_s,
            speed_m_s=speed_m_s,
            heading_rad=math.atan2(east_m_s, north_m_s) if speed_m_s > 0.0 else None,
            error_m=None,
        )


class _View:
    """What monitors know of a moment, as whoever watches a flight would be told."""

    def __init__(self, legs: FlightLegs) -> None:
        self._legs, self._nearness = legs, Nearness()

    def moment(
        self,
        stage: Stage,
        t_s: float,
        place: tuple[Point, float],
        *,
        trajectory_s: float,
        speed_m_s: float,
        heading_rad: float | None,
        error_m: float | None,
    ) -> Progress:
        leg = self._legs.now
        plan, monitor, (place_m, altitude_m) = leg.plan, leg.judged.monitor, place
        counted, trajectory = monitor.progress, plan.trajectory
        on_curve_s = float(trajectory.parameter(trajectory_s)[0])
        since_s = t_s - monitor.visits[0].entered_s if monitor.visits else 0.0
        return Progress(
            stage=stage,
            waiting_for="",
            t_s=t_s,
            trajectory_s=trajectory_s,
            duration_s=trajectory.duration_s,
            leg=max(bisect_right(plan.leg_starts_s, on_curve_s) - 1, 0),
            legs=len(plan.leg_starts_s),
            done=counted.done,
            total=counted.total,
            awaited=counted.awaited,
            laps=monitor.laps,
            laps_asked=trajectory.laps,
            returning=0.0 < trajectory.laps_end_s <= trajectory_s,
            verdict=monitor.verdict,
            altitude_m=altitude_m,
            speed_m_s=speed_m_s,
            error_m=error_m,
            nearest=self._nearness.of(plan, place_m, since_s),
            plan=plan,
            place_m=place_m,
            heading_rad=heading_rad,
            word=monitor.word,
            bounds=self._legs.bounds,
            since_s=since_s,
        )


def _every(rows: int) -> frozenset[int]:
    """Which of so many rows are shown: evenly chosen ones, the first and the last among them."""
    return frozenset(np.unique(np.linspace(0, max(rows - 1, 0), min(rows, _MOST_ROWS)).astype(int)).tolist())
