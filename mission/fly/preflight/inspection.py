"""The check without a flight: listen to a vehicle, read its parameters, and arm or change nothing."""

import contextlib
from typing import Final

from mission.clock import Clock
from mission.errors import VehicleError
from mission.fly.preflight.known import asked_of, told_of
from mission.fly.preflight.table import PARAMETERS, Findings, judged
from mission.link.contact import Contact
from mission.link.identity import LinkOptions
from mission.link.transport import Transport
from mission.plan import FlightPlan

_LISTEN_S: Final = 0.05
_MOST_RESTARTS: Final = 3
_PATIENCE_S: Final = 30.0
"""On the clock here: what a vehicle has not told by then is not known, and what it lacks is what it lacks."""


def inspect(
    plan: FlightPlan,
    transport: Transport,
    clock: Clock,
    *,
    link: LinkOptions | None = None,
) -> Findings:
    """Judge a vehicle for a plan; it is asked for telemetry and for parameters, and nothing else.

    Args:
        plan: What is to be flown.
        transport: The link to the vehicle; it is left open.
        clock: Paces repetitions on the link.
        link: Ids and patience on the link.

    Raises:
        LinkError: The vehicle could not be found, or was lost.
        VehicleError: It is none that can be flown from here, or was restarted again and again.
    """
    options = link or LinkOptions()
    for _ in range(_MOST_RESTARTS):
        with contextlib.suppress(_RestartedError):
            return _inspected(plan, transport, clock, options)
    raise VehicleError(f"the vehicle was restarted {_MOST_RESTARTS} times while it was asked")


class _RestartedError(Exception):
    """What the vehicle has told was before it was restarted, and so is what it was asked for."""


def _inspected(plan: FlightPlan, transport: Transport, clock: Clock, options: LinkOptions) -> Findings:
    absolute = plan.spec.origin is not None
    contact = Contact(options, needs_origin=absolute)
    contact.parameters.wanted = PARAMETERS
    vehicle, met_s = contact.vehicle, None
    while True:
        for data in transport.receive(_LISTEN_S):
            for body in contact.receive(data, clock.now_s()):
                contact.take(body, clock.now_s())
        now_s = clock.now_s()
        contact.advance(now_s)
        if vehicle.clock.restarted:
            raise _RestartedError
        if trouble := contact.trouble(now_s, departed=False):
            raise trouble
        asked = contact.ask_for_streams(now_s)
        contact.send_command(now_s)
        for frame in contact.outgoing():
            transport.send(frame)
        if contact.autopilot is not None:
            met_s = now_s if met_s is None else met_s
            ready = asked and contact.parameters.complete and (vehicle.armed or not vehicle.unready(absolute=absolute))
            if ready or now_s - met_s > _PATIENCE_S:
                return judged(asked_of(plan, options), told_of(contact, plan))
