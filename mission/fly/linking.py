"""The link to what is flown: a vehicle at an address, or the bundled one, started for it and flown in lock-step."""

import errno
import socket
from contextlib import ExitStack
from typing import Final

from mission.clock import Clock, WallClock
from mission.errors import LinkError, reason
from mission.fly.vehicle_process import BundledVehicle, VehicleOptions
from mission.link.identity import LinkOptions
from mission.link.lockstep import LockstepLink
from mission.link.transport import Transport, open_transport

_HINTS: Final = {
    errno.ECONNREFUSED: "start the vehicle or its simulator first, and check the port",
    errno.EADDRINUSE: "another program, such as a ground station, listens there: close it, or take another port",
    errno.EADDRNOTAVAIL: "listen at an address of this machine, such as 0.0.0.0; to call the vehicle use udpout:",
    errno.ENOENT: "check the name of the device, such as /dev/ttyUSB0 or /dev/ttyACM0",
    errno.EACCES: "this user may not use it: for a serial line join its group, for a port below 1024 take a higher one",
    errno.ETIMEDOUT: "check the address, and that no firewall is in between",
    errno.EHOSTUNREACH: "check the address, and the network between here and there",
    errno.ENETUNREACH: "check the address, and the network between here and there",
}


def linked(
    address: str | VehicleOptions, link: LinkOptions, stack: ExitStack
) -> tuple[BundledVehicle | None, Transport, Clock]:
    """The bundled vehicle, if that is to be flown, the link to what is, and the clock to fly by.

    Args:
        address: Where the vehicle is, or how the bundled one is started.
        link: Whom to fly, and with which key.
        stack: Ends what is begun here.

    Raises:
        LinkError: The link cannot be opened, or the bundled vehicle does not start.
    """
    if isinstance(address, str):
        transport = open_link(address, link)
        stack.callback(transport.close)
        return None, transport, WallClock()
    vehicle = stack.enter_context(BundledVehicle(address))
    transport = open_link(vehicle.address, link)
    stack.callback(transport.close)
    lockstep = LockstepLink(transport, WallClock())
    return vehicle, lockstep, lockstep


def open_link(address: str, link: LinkOptions) -> Transport:
    """The link at an address.

    Raises:
        LinkError: It cannot be opened; with what to do.
    """
    try:
        return open_transport(address, None if link.signatures is None else link.signatures.is_genuine)
    except LinkError as error:
        cause = error.__cause__
        if not isinstance(cause, OSError):
            raise
        if isinstance(cause, socket.gaierror):
            hint = "check the name of the host"
        else:
            hint = _HINTS.get(cause.errno or 0, "check the address")
        raise LinkError(f"cannot open {address}: {reason(cause)}; {hint}") from error
