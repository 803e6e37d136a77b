"""The way out of a flight that cannot go on, whatever has failed: the vehicle is told before it is left alone."""

import contextlib
from collections.abc import Callable
from typing import Final

from mission.clock import Clock
from mission.errors import MissionError
from mission.link.session import Session
from mission.link.transport import Transport
from mission.monitor.stage import Stage

_LONGEST_S: Final = 600.0
"""On the clock here; steps that wait for the vehicle have limits of their own, by its time."""

_MOST_FAULTS: Final = 50


def retreat(
    session: Session,
    transport: Transport,
    clock: Clock,
    error: MissionError,
    *,
    gone: Callable[[], str],
    turned: Callable[[], None],
) -> None:
    """Let the session hold, land or disarm the vehicle, as far as that still works.

    Args:
        session: The flight; it may be what has failed.
        transport: The link; it may be broken.
        clock: The clock here.
        error: Why.
        gone: Says why the vehicle can no longer be there, empty while it can.
        turned: Called after each turn.
    """
    faults, until_s = 0, clock.now_s() + _LONGEST_S
    with contextlib.suppress(MissionError):
        session.leave(error, clock.now_s())
        while session.stage is not Stage.DONE and clock.now_s() < until_s and not gone():
            try:
                speak(session, transport, clock)
                for data in transport.receive(session.wait_s(clock.now_s())):
                    session.receive(data, clock.now_s())
                turned()
            except MissionError:
                raise
            except Exception:  # noqa: BLE001 - what failed in flight may fail again, and the vehicle still flies
                faults += 1
                if faults > _MOST_FAULTS:
                    return
                for frame in session.last_words():
                    transport.send(frame)


def put_back(session: Session, transport: Transport, clock: Clock, gone: Callable[[], str]) -> None:
    """Switch the camera's trigger off, and let the vehicle have the geofence that it had, or find that in vain."""
    with contextlib.suppress(Exception):
        while session.contact.unfinished and not gone():
            session.tend(clock.now_s(), over=True)
            for frame in session.outgoing():
                transport.send(frame)
            for data in transport.receive(session.wait_s(clock.now_s())):
                session.receive(data, clock.now_s())


def speak(session: Session, transport: Transport, clock: Clock) -> None:
    """Let the session say what is due, without listening."""
    session.advance(clock.now_s())
    for frame in session.outgoing():
        transport.send(frame)
