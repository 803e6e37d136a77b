"""What follows from a record: how well the trajectory was tracked, and how close to restricted regions it came."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from scipy.interpolate import CubicHermiteSpline
from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import FloatArray
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.moving import clock_s, drifting, nearest
from mission.report.reading import Record, Track
from mission.spec.restricted import restricted_as_drawn

_OF_NEITHER: Final = 0.5


@dataclass(frozen=True, eq=False)
class Tracking:
    """What was reported while the trajectory was flown, and what was asked for at the same moments.

    All arrays have one row for each telemetry line between the first and the last setpoint of the trajectory that
    holds a horizontal position; ENU in the domain's frame. Setpoints are interpolated between their times.

    Attributes:
        t_s: Vehicle time, shape (N,).
        trajectory_s: Time on the trajectory, shape (N,).
        position_m: As reported, shape (N, 2).
        asked_position_m: Shape (N, 2).
        velocity_m_s: As reported, shape (N, 2).
        asked_velocity_m_s: Shape (N, 2).
        asked_acceleration_m_s2: Shape (N, 2).
        attitude_rad: Roll, pitch, yaw as reported, shape (N, 3).
    """

    t_s: FloatArray
    trajectory_s: FloatArray
    position_m: FloatArray
    asked_position_m: FloatArray
    velocity_m_s: FloatArray
    asked_velocity_m_s: FloatArray
    asked_acceleration_m_s2: FloatArray
    attitude_rad: FloatArray

    @property
    def error_m(self) -> FloatArray:
        """Reported less asked position, shape (N, 2)."""
        return self.position_m - self.asked_position_m

    @property
    def velocity_error_m_s(self) -> FloatArray:
        """Reported less asked velocity, shape (N, 2)."""
        return self.velocity_m_s - self.asked_velocity_m_s

    @property
    def distance_m(self) -> FloatArray:
        """Horizontal distance from where it should be, shape (N,)."""
        distance: FloatArray = np.hypot(*self.error_m.T)
        return distance


def tracking_of(record: Record) -> Tracking:
    """Bring reports and setpoints of a flight to the same times; empty where no trajectory was flown."""
    setpoints, track = record.setpoints, record.track
    of_trajectory = np.isfinite(setpoints.trajectory_s) & np.isfinite(setpoints.t_s)
    of_trajectory &= np.isfinite(setpoints.position_m[:, :2]).all(axis=1)
    times = setpoints.t_s[of_trajectory]
    known = np.isfinite(track.position_m[:, :2]).all(axis=1) & np.isfinite(track.t_s)
    if len(times):
        known &= (track.t_s >= times[0]) & (track.t_s <= times[-1])
        # Between two plans there may be setpoints of neither.
        sent = np.isfinite(setpoints.t_s)
        known &= np.interp(track.t_s, setpoints.t_s[sent], of_trajectory[sent].astype(np.float64)) > _OF_NEITHER
    else:
        known[:] = False
    at = track.t_s[known]

    def asked(values: FloatArray, slopes: FloatArray | None = None) -> FloatArray:
        return _between(at, times, values[of_trajectory, :2], None if slopes is None else slopes[of_trajectory, :2])

    return Tracking(
        t_s=at,
        trajectory_s=np.interp(at, times, setpoints.trajectory_s[of_trajectory]) if len(times) else times,
        position_m=track.position_m[known, :2],
        asked_position_m=asked(setpoints.position_m, setpoints.velocity_m_s),
        velocity_m_s=track.velocity_m_s[known, :2],
        asked_velocity_m_s=asked(setpoints.velocity_m_s, setpoints.acceleration_m_s2),
        asked_acceleration_m_s2=asked(setpoints.acceleration_m_s2),
        attitude_rad=track.attitude_rad[known],
    )


def _between(at_s: FloatArray, t_s: FloatArray, values: FloatArray, slopes: FloatArray | None) -> FloatArray:
    """Values between those at times, shape (N, 2): on cubics with these slopes, or straight where one is not known."""
    if not len(t_s):
        return np.zeros((0, 2))
    times, first = np.unique(t_s, return_index=True)
    if slopes is not None and len(times) > 1 and np.isfinite(slopes).all() and np.isfinite(values).all():
        cubics: FloatArray = CubicHermiteSpline(times, values[first], slopes[first])(at_s)
        return cubics
    return np.stack([np.interp(at_s, times, axis) for axis in values[first].T], axis=-1)


def flown_by_field(track: Track) -> Track:
    """What was reported of a flight that follows no trajectory, from its beginning to its end."""
    flying = np.array([stage is Stage.FLY for stage in track.stages], dtype=np.bool_)
    known = np.isfinite(track.position_m[:, :2]).all(axis=1) & np.isfinite(track.t_s) & flying
    return Track(
        t_s=track.t_s[known],
        position_m=track.position_m[known],
        velocity_m_s=track.velocity_m_s[known],
        attitude_rad=track.attitude_rad[known],
        stages=(Stage.FLY,) * int(known.sum()),
    )


def led_by_field(record: Record) -> Tracking:
    """What was reported of such a flight, and the velocity that it was asked for; NaN for all else that was not asked.

    Its time on a trajectory is that since its beginning.
    """
    track, setpoints = flown_by_field(record.track), record.setpoints
    told = np.isfinite(setpoints.t_s) & np.isfinite(setpoints.velocity_m_s[:, :2]).all(axis=1)
    nothing = np.full((len(track.t_s), 2), np.nan)
    asked = nothing
    if told.any():
        east, north = setpoints.velocity_m_s[told, :2].T
        asked = np.stack([np.interp(track.t_s, setpoints.t_s[told], axis) for axis in (east, north)], axis=-1)
    return Tracking(
        t_s=track.t_s,
        trajectory_s=track.t_s - track.t_s[0] if len(track.t_s) else track.t_s,
        position_m=track.position_m[:, :2],
        asked_position_m=nothing,
        velocity_m_s=track.velocity_m_s[:, :2],
        asked_velocity_m_s=asked,
        asked_acceleration_m_s2=nothing,
        attitude_rad=track.attitude_rad,
    )


def flown_line(record: Record) -> BaseGeometry | None:
    """The line through the reported positions, or the only one, in ENU; None where there is none."""
    positions = record.track.position_m[:, :2]
    positions = positions[np.isfinite(positions).all(axis=1)]
    if not len(positions):
        return None
    return shapely.LineString(positions) if len(positions) > 1 else shapely.Point(positions[0])


def nearest_to(plan: FlightPlan, record: Record) -> dict[str, tuple[FloatArray, float]]:
    """Where the line through the reported positions was nearest to each restricted region, and how near; 0 in it.

    What moves is where it was at the time. Empty where no position was reported.

    Returns:
        By the names of the regions the two ends of the shortest line, shape (2, 2), and its length.
    """
    line, moves = flown_line(record), drifting(plan)
    if line is None:
        return {}
    known = np.isfinite(record.track.position_m[:, :2]).all(axis=1) & np.isfinite(record.track.t_s)
    clocks_s, points = clock_s(record, record.track.t_s[known]), record.track.position_m[known, :2]
    found = {}
    for name, shape in restricted_as_drawn(plan.spec, plan.partition, plan.labelling).items():
        if name in moves and len(points):
            found[name] = nearest(plan, name, shape, clocks_s, points)
            continue
        # Where the vehicle stood still, older versions of GEOS divide 0 by 0 in passing.
        with np.errstate(invalid="ignore"):
            ends = shapely.get_coordinates(shapely.shortest_line(line, shape))
            found[name] = ends, float(shapely.distance(line, shape))
    return found
