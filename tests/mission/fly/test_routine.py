"""What is routine in a record takes few words, and nothing is lost that is judged or drawn."""

import io
import math
from collections.abc import Iterator

import numpy as np
import pytest

from mission.fly.recording import Routine
from mission.link.course import Reference
from mission.link.events import Moved, SetpointSent
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.report.tracking import tracking_of

PERIOD_S = 0.03
PAUSE_S = (20.0, 24.0)
SLOW_S = 30.0
"""The trajectory pauses, and from then on goes at half its pace."""


def trajectory_s(t_s: float) -> float:
    paused_s = min(max(t_s - PAUSE_S[0], 0.0), PAUSE_S[1] - PAUSE_S[0])
    return t_s - paused_s - 0.5 * max(t_s - SLOW_S, 0.0)


def planned(at_s: float, rate: float) -> Reference:
    """A curve of metres and seconds, with accelerations of up to 2.4 m/s^2."""
    x, y = 8.0 * math.sin(0.5 * at_s), 3.0 * math.cos(0.9 * at_s)
    vx, vy = 4.0 * math.cos(0.5 * at_s), -2.7 * math.sin(0.9 * at_s)
    return Reference(
        (x, y, 5.0),
        (rate * vx, rate * vy, 0.0),
        (-(rate**2) * 0.25 * x, -(rate**2) * 0.81 * y, 0.0),
    )


def events() -> Iterator[Moved | SetpointSent]:
    """A flight of 40 s: setpoints at first off the trajectory, then along it, and reports of a vehicle near it."""
    for k in range(round(40.0 / PERIOD_S)):
        t_s = k * PERIOD_S
        if not PAUSE_S[0] < t_s < PAUSE_S[1]:
            on_it = None if t_s < 2.0 else trajectory_s(t_s)
            yield SetpointSent(t_s, planned(trajectory_s(t_s), 0.5 if t_s > SLOW_S else 1.0), 0.1, on_it, None)
        t_s += 0.011
        rate = 0.5 if t_s > SLOW_S else 0.0 if PAUSE_S[0] < t_s < PAUSE_S[1] else 1.0
        (x, y, z), velocity, _ = asked = planned(trajectory_s(t_s), rate)
        place = (x + 0.1 * math.sin(t_s), y + 0.1 * math.cos(t_s), z)
        yaw = math.remainder(3.0 + 0.1 * t_s, math.tau)
        yield Moved(t_s, place, velocity, (0.1, -0.05, yaw), *asked[:2], None if t_s < 2.0 else trajectory_s(t_s))


def recorded(*, every: bool) -> tuple[Record, bytes]:
    """The record of that flight; ``every`` line of it, or what is usual."""
    sink = io.BytesIO()
    routine = Routine(FlightRecord(sink, mission="m"), everything=every)
    for event in events():
        if isinstance(event, Moved):
            routine.moved(event)
        else:
            routine.sent(event)
    routine.settle()
    return parse_record(sink.getvalue()), sink.getvalue()


def test_what_is_left_out_of_a_record_follows_from_what_is_there() -> None:
    (usual, few), (every, many) = recorded(every=False), recorded(every=True)
    assert len(few) < len(many) / 3
    assert len(few) < 40.0 * 2700
    np.testing.assert_array_equal(usual.track.t_s, every.track.t_s)
    np.testing.assert_array_equal(usual.track.position_m[:, :2], every.track.position_m[:, :2])
    np.testing.assert_allclose(usual.track.position_m[:, 2], every.track.position_m[:, 2], atol=1e-3)
    leaps = np.abs(usual.track.t_s[:, None] - [*PAUSE_S, SLOW_S]).min(axis=1) < 0.3  # as no vehicle's velocity does
    np.testing.assert_allclose(usual.track.velocity_m_s[~leaps], every.track.velocity_m_s[~leaps], atol=0.2)
    turned = np.remainder(usual.track.attitude_rad - every.track.attitude_rad + np.pi, 2 * np.pi) - np.pi
    np.testing.assert_allclose(turned, 0.0, atol=0.03)
    one, other = tracking_of(usual), tracking_of(every)
    np.testing.assert_array_equal(one.t_s, other.t_s)
    assert len(one.t_s) > 1000
    led = (one.t_s < PAUSE_S[0]) | (one.t_s > PAUSE_S[1])  # in between nobody leads
    np.testing.assert_allclose(one.trajectory_s[led], other.trajectory_s[led], atol=2e-3)
    np.testing.assert_allclose(one.asked_position_m[led], other.asked_position_m[led], atol=5e-3)
    np.testing.assert_allclose(one.asked_velocity_m_s[led], other.asked_velocity_m_s[led], atol=0.05)


def test_a_record_of_before_that_was_so_is_read() -> None:
    every, data = recorded(every=True)
    assert b'"kind":"at"' not in data
    old = parse_record(data.replace(b'"schema":2', b'"schema":1'))
    np.testing.assert_array_equal(old.track.position_m, every.track.position_m)
    np.testing.assert_array_equal(old.setpoints.trajectory_s, every.setpoints.trajectory_s)


def test_a_program_that_is_killed_loses_no_place() -> None:
    _, data = recorded(every=False)
    sink = io.BytesIO()
    routine = Routine(FlightRecord(sink, mission="m"))
    for event in events():
        if isinstance(event, Moved):
            told = routine.moved(event)
            assert told.position_m[:2] == pytest.approx(event.position_m[:2], abs=1e-4)
            last = sink.getvalue().splitlines()[-1]
            assert f"[{told.position_m[0]!r},{told.position_m[1]!r}".encode() in last
        else:
            routine.sent(event)
        if event.t_s > 3.0:
            break
    assert data.startswith(sink.getvalue())
