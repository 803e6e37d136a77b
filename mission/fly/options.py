"""How a flight is conducted."""

from dataclasses import dataclass, field

from mission.fly.preflight import Checks
from mission.link.identity import LinkOptions

_STRAY_M = 10.0


@dataclass(frozen=True)
class FlightOptions:
    """How a flight is conducted.

    Attributes:
        link: Ids and patience on the link.
        land_when_stopped: Whether a flight that is given up in the air ends with a landing on the spot. Otherwise the
            vehicle is left holding, for its pilot to decide: what lies under a real one is not known here.
        fence: Whether the vehicle's own geofence is set to keep it where the plan allows it to be, and put back at the
            end. Nothing of the vehicle is changed unless that is asked for.
        keep_fence: Whether that fence stays after the flight.
        resume_when_handed_back: Whether a flight that a pilot has taken over waits to be handed back, and goes on.
        stray_m: A vehicle that is farther from its trajectory than this for some seconds does not follow it.
        record_all: Whether each report and setpoint is recorded whole, as it takes to measure a vehicle by them; the
            record of an hour then has some 40 MB instead of 8.
        checks: What is checked before the vehicle is armed, and what of it does not count.
    """

    link: LinkOptions = field(default_factory=LinkOptions)
    land_when_stopped: bool = False
    resume_when_handed_back: bool = False
    fence: bool = False
    keep_fence: bool = False
    stray_m: float = _STRAY_M
    record_all: bool = False
    checks: Checks = field(default_factory=Checks)
