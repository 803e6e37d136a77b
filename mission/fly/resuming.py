"""A flight that was left in the air, taken up again: its record is the only memory, and what is not in it was not done.

Between the last report of the record and where the vehicle is found it is taken to have moved straight, as between any
two reports; that is believed of a vehicle that hovers about as far away as braking takes it. What makes it another
flight by now, or one that must not go on, is refused.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from mission.errors import GeometryError, RecordError, VehicleError
from mission.fly.circumstances import FIRMWARE, GEOFENCE
from mission.fly.replanner import PlanRequest
from mission.geometry.geodesy import LatLon, enu_offset_m
from mission.link.autopilot import Autopilot
from mission.link.contact import Contact
from mission.link.ending import Ending
from mission.link.frames import Anchor, enu_from_ned
from mission.link.values import LandedState, LocalPosition
from mission.link.vehicle_state import VehicleState
from mission.logic.formula.word import Letter
from mission.monitor.legs import FlightLegs
from mission.plan import FlightPlan
from mission.plan.rest import Rest
from mission.report.reading import Record
from mission.report.replay import judged_again
from mission.spec.model import MissionSpec, Point

RETURNING: Final = "returning after this lap"
_NOT_BEGUN: Final = "this flight had not begun when it was left: fly its mission anew"

_BRAKING_M_S2: Final = 1.0
_DRIFT_M: Final = 10.0
"""How far a vehicle that nobody leads comes to rest from where it was heard last: by braking, and by wind meanwhile."""

_STILL_M_S: Final = 1.0
_AGREE_M: Final = 3.0
"""How far the vehicle's home may be from where this flight took off; another take-off is from another place."""


@dataclass(frozen=True, eq=False)
class Unfinished:
    """A flight whose record does not end on the ground.

    Attributes:
        record: As far as it goes.
        legs: What of it counts.
        mission: What was asked for last, all of it.
        anchor: Ties its domain to the vehicle's local frame; None where it had not begun, but set a geofence.
        last_s: Vehicle time of the last report.
        last_m: Where that was, ENU in the domain.
        speed_m_s: How fast the vehicle was then.
    """

    record: Record
    legs: FlightLegs
    mission: MissionSpec
    anchor: Anchor | None
    last_s: float
    last_m: Point
    speed_m_s: float

    @property
    def laps(self) -> tuple[int, tuple[Letter, ...] | None]:
        """How many laps are over, and what one that is under way has not met; None where none is."""
        leg = self.legs.now
        return leg.laps_at(leg.judged.monitor.known, leg.in_tube_until_s)

    @property
    def began_s(self) -> float:
        """Vehicle time at which its trajectory began; that of the last report where it had not."""
        flown = np.flatnonzero(np.isfinite(self.record.setpoints.trajectory_s))
        return float(self.record.setpoints.t_s[flown[0]]) if len(flown) else self.last_s

    def request(self, place_m: Point) -> PlanRequest:
        """What is to be planned for a vehicle that hovers at a place, which has been reported: what was not done."""
        leg, (laps, due) = self.legs.now, self.laps
        laps -= leg.laps_before
        rest = Rest(leg.judged.monitor.word, place_m, flown_s=leg.in_tube_until_s, laps=laps, due=due)
        amended, flight = None, leg.plan.spec.flight
        if leg.plan.run.recurrent and any(event.text == RETURNING for event in self.record.events):
            amended = replace(leg.plan.spec, flight=replace(flight, laps=laps + int(due is not None)))
        return PlanRequest(0, leg.plan, rest, amended=amended)

    @property
    def system_id(self) -> int:
        """That of its vehicle."""
        return int(self.record.vehicle.get("system_id", 0))

    def check_whose(self, contact: Contact) -> None:
        """Refuse another vehicle than that of this flight, by what it has told so far.

        Raises:
            VehicleError: It is another one.
        """
        kind, version, name = contact.autopilot, contact.vehicle.version, self.record.vehicle.get("autopilot")
        told = (event.values.get("board") for event in self.record.events if event.text == FIRMWARE)
        board = next(filter(None, told), "")
        if kind is not None and name != kind.name:
            raise VehicleError(f"the flight was one with {name}, and this vehicle flies with {kind.name}")
        if kind is not None and self.system_id != contact.system_id:
            raise VehicleError(
                f"the flight was one of system id {self.system_id}, and this vehicle has {contact.system_id}"
            )
        if version is not None and version.board and board and version.board != board:
            raise VehicleError("this is another vehicle than that of the flight: its board has another number")

    def checked(self, vehicle: VehicleState, kind: Autopilot) -> Anchor:
        """What ties the domain to the frame of a vehicle that is taken over, as it was left.

        Raises:
            VehicleError: It is in no mode that it is left in, moves, is elsewhere, or was restarted or flown since; or
                the flight had not begun.
        """
        if self.anchor is None:
            raise VehicleError(_NOT_BEGUN)
        newest_s, position = vehicle.clock.newest_s, vehicle.position
        if newest_s is None or position is None or vehicle.mode is None:
            raise VehicleError("the vehicle has not told where it is")
        if newest_s < self.last_s:
            raise VehicleError("the vehicle was restarted since; its flight cannot be taken up again")
        if vehicle.mode not in kind.left_modes:
            raise VehicleError(
                f"the vehicle is in {kind.mode_name(vehicle.mode)}: somebody else flies it, or a failsafe; put it into "
                f"{kind.mode_name(kind.hold_mode)} where it is to be taken over"
            )
        if vehicle.landed is LandedState.ON_GROUND:
            raise VehicleError("the vehicle has landed since; its flight is over")
        self._check_home(vehicle, self.anchor)
        if not is_still(position):
            speed_m_s = math.hypot(*position.velocity_ned_m_s[:2])
            raise VehicleError(f"the vehicle flies at {speed_m_s:.1f} m/s; wait until it hovers")
        here_m = self.anchor.to_domain(position.position_ned_m)[:2]
        off_m = math.dist(here_m, self.last_m)
        most_m = _DRIFT_M + self.speed_m_s**2 / (2.0 * _BRAKING_M_S2)
        if off_m > most_m:
            raise VehicleError(
                f"the vehicle is {off_m:.0f} m from where the record leaves it, farther than the {most_m:.0f} m in "
                "which it comes to rest: it was flown since, and where to is not known"
            )
        return self.anchor

    def _check_home(self, vehicle: VehicleState, anchor: Anchor) -> None:
        """Compare where it took off by its own word with where this flight did."""
        if vehicle.home is None or vehicle.origin is None:
            return
        frame = LatLon(vehicle.origin.latitude_deg, vehicle.origin.longitude_deg)
        try:
            home_m = enu_offset_m(frame, LatLon(vehicle.home.latitude_deg, vehicle.home.longitude_deg))
        except GeometryError:
            home_m = (math.inf, math.inf)
        start_m = self.legs.legs[0].plan.start_m
        began_m = enu_from_ned(anchor.to_vehicle((*start_m, 0.0)))[:2]
        off_m = math.dist(home_m, began_m)
        if off_m > _AGREE_M:
            raise VehicleError(
                f"the vehicle took off {off_m:.0f} m from where this flight did: it has flown another mission since"
            )


def is_still(position: LocalPosition) -> bool:
    """Whether a vehicle that reports this hovers."""
    return math.hypot(*position.velocity_ned_m_s[:2]) <= _STILL_M_S


def unfinished(plan: FlightPlan, record: Record, mission: MissionSpec | None = None) -> Unfinished:
    """What a record tells of a flight that did not come to its end.

    Args:
        plan: Its first plan, as it was flown.
        record: With its later plans.
        mission: As it was amended last; that of the first plan by default.

    Raises:
        RecordError: The flight has come to its end, or never began, or a value is none.
    """
    verdict = record.verdict
    if verdict is not None and verdict.get("ending") == Ending.LANDED.name.lower():
        raise RecordError(f"this flight has come to its end: {verdict.get('reason')}", line=0)
    ties = [event.values.get("origin_ned_m") for event in record.events if event.text == "anchored"]
    known = np.flatnonzero(np.isfinite(record.track.position_m[:, :2]).all(axis=1) & np.isfinite(record.track.t_s))
    asked = plan.spec if mission is None else mission
    if not ties or not len(known):
        if not any(event.text == GEOFENCE for event in record.events):
            raise RecordError(_NOT_BEGUN, line=0)
        return Unfinished(record, FlightLegs(plan), asked, None, -math.inf, plan.start_m, 0.0)
    last = int(known[-1])
    x, y = record.track.position_m[last, :2].tolist()
    speed = float(np.hypot(*record.track.velocity_m_s[last, :2]))
    try:
        north, east, down = map(float, ties[-1] or ())
    except (TypeError, ValueError, OverflowError) as error:
        raise RecordError("the record does not say where its flight took off", line=0) from error
    return Unfinished(
        record,
        judged_again(plan, record),
        asked,
        Anchor((north, east, down)),
        last_s=float(record.track.t_s[last]),
        last_m=(x, y),
        speed_m_s=speed if math.isfinite(speed) else 0.0,
    )
