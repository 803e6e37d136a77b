"""What an autopilot has to be told of its geofence, beside where it is: one value for each kind that can be flown."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mission.plan.guarding import Room


@dataclass(frozen=True, kw_only=True)
class FenceRules:
    """The geofence of one kind of autopilot.

    Attributes:
        switch: The parameter that turns it on and off.
        off: The value with which it does nothing.
        on: The value with which it stops the vehicle.
        parameters: The others that matter, in the order in which they are set.
        optional: Those of them that not every version has.
        wanted: What the others have to be, from what all were and from a ceiling above home (m). Limits that the
            vehicle was watching stay where they are, or get tighter.
        room: What it keeps corners in.
        sphere_m: The radius of the sphere on which it turns degrees into metres.
    """

    switch: str
    off: float
    on: float
    parameters: tuple[str, ...]
    optional: frozenset[str]
    wanted: Callable[[Mapping[str, float], float], Mapping[str, float]]
    room: Room
    sphere_m: float
