"""Drives a session against a transport that is its own clock, until it ends."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Self

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.link.course import Course
from mission.link.frames import Anchor, Vector
from mission.link.session import Session
from mission.monitor.stage import Stage
from tests.support.scripted_vehicle import ScriptedVehicle

if TYPE_CHECKING:
    from mission.link.events import Event

ALTITUDE_M = 5.0
DURATION_S = 12.0
START_M = (10.0, 20.0)
END_M = (18.0, 14.0)


class Straight:
    """From START_M to END_M on a line, at rest at both ends."""

    duration_s = DURATION_S
    altitude_m = ALTITUDE_M
    laps: int | None = 1
    laps_end_s = 0.0

    def first_lap_s(self, t_s: float) -> float:
        return t_s

    def ended_after(self, _t_s: float) -> Self:
        return self

    def state(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        u = np.clip(np.asarray(t_s) / DURATION_S, 0.0, 1.0)[:, None]
        way = np.array(END_M) - np.array(START_M)
        place = 10 * u**3 - 15 * u**4 + 6 * u**5
        rate = (30 * u**2 - 60 * u**3 + 30 * u**4) / DURATION_S
        growth = (60 * u - 180 * u**2 + 120 * u**3) / DURATION_S**2
        return np.array(START_M) + place * way, rate * way, growth * way


def anchor_at_start(vehicle_ned_m: Vector) -> Anchor:
    return Anchor.between(vehicle_ned_m, (*START_M, 0.0))


def course() -> Course:
    """That line with the heading that the scripted vehicle has."""
    return Course(Straight(), 0.5)


class Driven:
    """A session on a scripted vehicle, with everything that it has told."""

    def __init__(
        self, vehicle: ScriptedVehicle, session: Session | None = None, flown: Callable[[], Course] = course
    ) -> None:
        self.vehicle = vehicle
        self.flown = flown
        self.session = session or Session(needs_origin=False)
        self.events: list[Event] = []
        self.stages: list[Stage] = []

    def turn(self) -> None:
        session, vehicle = self.session, self.vehicle
        for data in vehicle.receive(session.wait_s(vehicle.now_s())):
            session.receive(data, vehicle.now_s())
        session.advance(vehicle.now_s())
        if session.stage is Stage.STANDBY:
            session.depart(self.flown(), anchor_at_start)
        for frame in session.outgoing():
            vehicle.send(frame)
        self.events += session.events()
        if not self.stages or self.stages[-1] is not session.stage:
            self.stages.append(session.stage)

    def until(self, stage: Stage, within_s: float = 200.0) -> None:
        """Go on until a stage is entered."""
        limit = self.vehicle.now_s() + within_s
        while self.session.stage is not stage:
            self.turn()
            if self.vehicle.now_s() > limit:
                raise AssertionError(f"{stage} not reached; {self.session.stage}, {self.session.waiting_for!r}")

    def fly(self, within_s: float = 200.0) -> None:
        """Go on until the session has ended."""
        self.until(Stage.DONE, within_s)
