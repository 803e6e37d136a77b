"""Where the nose looks, as mission items: what ``flight.heading`` asks of an autopilot that flies a plan by itself.

Ahead is what both autopilots do by themselves (ArduCopter's WP_YAW_BEHAVIOR, PX4's MPC_YAW_MODE). PX4 takes a heading
from the waypoint that it flies to. ArduCopter leaves that out; it takes one from MAV_CMD_CONDITION_YAW, and keeps it up
to the next waypoint. A place to look at is the same to both. Where images are taken the nose looks along the lane.

https://mavlink.io/en/messages/common.html#mav_commands and
https://ardupilot.org/copter/docs/common-mavlink-mission-command-messages-mav_cmd.html
"""

import math
from dataclasses import dataclass

import numpy as np

from mission.export.placed_plan import PlacedPlan
from mission.interchange.autopilot_plan import AS_IT_IS, Command, Item
from mission.plan.heading import looked_toward
from mission.spec.heading import Look

_PX4 = "px4"


@dataclass(frozen=True)
class NoseItems:
    """What turns the nose.

    Attributes:
        turn: Goes before each waypoint; None where nothing does.
        look: Sets a place to look at; None where there is none.
        heading_deg: Of waypoints.
    """

    turn: Item | None = None
    look: Item | None = None
    heading_deg: float = AS_IT_IS

    def before(self, *, imaging: bool, imaged: bool | None) -> tuple[Item, ...]:
        """What goes before a waypoint, by whether images are taken on the way there, and were before; None: unknown."""
        if self.look is not None:
            return () if imaging is imaged else (_LOOK_AHEAD,) if imaging else (self.look,)
        return () if self.turn is None or imaging else (self.turn,)

    def after(self) -> tuple[Item, ...]:
        """What goes after all waypoints."""
        return () if self.look is None else (_LOOK_AHEAD,)


_LOOK_AHEAD = Item(Command.LOOK_AHEAD, (0.0, 0.0, 0.0, 0.0))


def nose_items(placed: PlacedPlan, firmware: str) -> NoseItems:
    """What turns the nose of a vehicle as a plan has it; ``firmware`` is a key of ``FIRMWARE``."""
    plan = placed.plan
    spec, heading = plan.spec, plan.spec.flight.heading
    if heading is not None and heading.look is Look.FIXED:
        fixed_deg = math.degrees(heading.fixed_rad) % 360.0
        if firmware == _PX4:
            return NoseItems(heading_deg=fixed_deg)
        rate_deg_s = math.degrees(spec.limits.yaw_rate_rad_s)
        return NoseItems(turn=Item(Command.TURN, (fixed_deg, rate_deg_s, 0.0, 0.0)))
    toward_m = looked_toward(spec, plan.partition, plan.labelling)
    if toward_m is None:
        return NoseItems()
    (place,) = placed.places(np.array([toward_m]))
    return NoseItems(look=Item(Command.LOOK_AT, (0.0, 0.0, 0.0, 0.0), place))
