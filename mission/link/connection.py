"""From the first byte to a vehicle that is known and talks: find it, identify it, ask it for telemetry."""

from collections import deque
from typing import Final

from mission.errors import VehicleError
from mission.link.ardupilot import ARDUPILOT
from mission.link.autopilot import Autopilot
from mission.link.messages import (
    AUTOPILOT_COMPONENT,
    AUTOPILOT_NONE,
    MULTICOPTERS,
    Stream,
    autopilot_name,
    request_message,
    set_message_interval,
    vehicle_type_name,
)
from mission.link.px4 import PX4
from mission.link.values import (
    Attitude,
    Battery,
    Body,
    Command,
    EstimatorReport,
    Fix,
    GlobalPosition,
    Health,
    Heartbeat,
    Landing,
    LocalPosition,
    Origin,
    Received,
    Version,
)

AUTOPILOTS: Final = {kind.number: kind for kind in (ARDUPILOT, PX4)}
_BODIES: Final[dict[Stream, type[Body]]] = {
    Stream.SYS_STATUS: Health,
    Stream.ATTITUDE: Attitude,
    Stream.LOCAL_POSITION_NED: LocalPosition,
    Stream.GLOBAL_POSITION_INT: GlobalPosition,
    Stream.GPS_GLOBAL_ORIGIN: Origin,
    Stream.BATTERY_STATUS: Battery,
    Stream.EKF_STATUS_REPORT: EstimatorReport,
    Stream.ESTIMATOR_STATUS: EstimatorReport,
    Stream.EXTENDED_SYS_STATE: Landing,
    Stream.AUTOPILOT_VERSION: Version,
    Stream.GPS_RAW_INT: Fix,
}
_NOT_ALWAYS: Final = frozenset((Stream.WIND, Stream.WIND_COV, Stream.SIMSTATE))
"""What makes no estimate of the wind, or is no simulator, sends none, however often it is asked."""

_SPARE: Final = (Stream.SIMSTATE,)
"""No flight waits for these: they are asked for after all others, while the vehicle becomes ready."""


def is_vehicle(received: Received) -> bool:
    """Whether a message is the heartbeat of an autopilot, and not of a ground station, a camera or a companion."""
    body = received.body
    return (
        isinstance(body, Heartbeat)
        and received.component_id == AUTOPILOT_COMPONENT
        and body.autopilot != AUTOPILOT_NONE
        and received.system_id != 0
    )


def autopilot_of(heartbeat: Heartbeat) -> Autopilot:
    """The autopilot that a heartbeat comes from.

    Raises:
        VehicleError: It is one that is not known here, or no multicopter.
    """
    kind = AUTOPILOTS.get(heartbeat.autopilot)
    if kind is None:
        known = " and ".join(autopilot.name for autopilot in AUTOPILOTS.values())
        raise VehicleError(
            f"the vehicle's autopilot is {autopilot_name(heartbeat.autopilot)}; how to bring it into offboard flight "
            f"is known of {known} only"
        )
    if heartbeat.vehicle_type not in MULTICOPTERS:
        raise VehicleError(f"the vehicle is a {vehicle_type_name(heartbeat.vehicle_type)}, not a multicopter")
    return kind


class StreamRequests:
    """Asks for each message at its rate, and again for those that do not come.

    A rate that was accepted may bring nothing: PX4 sends the origin when it changes and when it is asked for, no more.
    """

    def __init__(self, autopilot: Autopilot) -> None:
        """Ask for what this autopilot sends."""
        self._rates_hz = autopilot.rates_hz
        self._turn = 0
        self._spare = [stream for stream in _SPARE if stream in autopilot.rates_hz]
        self._round = deque(
            (
                *(
                    set_message_interval(stream, rate)
                    for stream, rate in autopilot.rates_hz.items()
                    if stream not in _SPARE
                ),
                request_message(Stream.GPS_GLOBAL_ORIGIN),
                request_message(Stream.AUTOPILOT_VERSION),
                request_message(Stream.HOME_POSITION),
            )
        )

    def next(self) -> Command | None:
        """The next command of this round; None after it."""
        return self._round.popleft() if self._round else None

    def begin_again(self, heard: set[type[Body]]) -> None:
        """Begin a round for what has not come though it was asked for: at its rate, and once."""
        for stream, rate_hz in self._rates_hz.items():
            if stream not in _NOT_ALWAYS and _BODIES[stream] not in heard:
                self._round += (set_message_interval(stream, rate_hz), request_message(stream))
        self._round += [set_message_interval(stream, self._rates_hz[stream]) for stream in self._spare]
        self._spare.clear()

    def renewal(self, bodies: tuple[type[Body], ...]) -> Command:
        """The command of one of these messages, in turn; each is one that this autopilot is asked for."""
        streams = [stream for stream in self._rates_hz if _BODIES.get(stream) in bodies]
        self._turn += 1
        stream = streams[self._turn % len(streams)]
        return set_message_interval(stream, self._rates_hz[stream])
