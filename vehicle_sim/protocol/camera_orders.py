"""What commands about the camera ask for, in messages as in missions: a table for each flavour.

ArduPilot `AP_Camera.cpp` (`handle_command`), PX4 `camera_trigger.cpp` and, for its missions, `navigator_main.cpp`.
"""

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Final

from vehicle_sim.autopilot import Outcome
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import mavlink
from vehicle_sim.signals import CameraOrder

Params = tuple[float, ...]
_Reader = Callable[[Params], CameraOrder | Outcome]

_PAUSE, _DISABLE = 0.0, -1.0


def _positive(value: float) -> float | None:
    return value if isfinite(value) and value > 0.0 else None


def _flag(value: float) -> bool | None:
    """Return what a parameter of 1 or 0 says; any other leaves things as they are."""
    return {1.0: True, 0.0: False}.get(value)


def _digicam(params: Params) -> CameraOrder:
    return CameraOrder(shoots=params[4] == 1.0)


def _nothing(_params: Params) -> CameraOrder:
    return CameraOrder()


def _ardupilot_distance(params: Params) -> CameraOrder:
    return CameraOrder(distance_m=_positive(params[0]) or 0.0, shoots=params[2] == 1.0)


def _ardupilot_images(params: Params) -> CameraOrder | Outcome:
    camera, interval_s, pictures = params[:3]
    if camera < 0.0:
        return Outcome.UNSUPPORTED
    if pictures == 1.0 or interval_s == pictures == 0.0:
        order = CameraOrder(shoots=True)
    elif (lasts_s := _positive(interval_s)) is None or not isfinite(pictures):
        return Outcome.FAILED
    else:
        order = CameraOrder(interval_s=lasts_s, pictures=int(pictures) or -1)
    return order if camera in (0.0, 1.0) else Outcome.FAILED


def _ardupilot_stop(params: Params) -> CameraOrder | Outcome:
    return CameraOrder(pictures=0) if params[0] in (0.0, 1.0) else Outcome.UNSUPPORTED


def _no_video(_params: Params) -> Outcome:
    return Outcome.FAILED


def _px4_distance(params: Params) -> CameraOrder:
    distance_m, shoots = _positive(params[0]), params[2] > 0.0
    if distance_m is not None:
        return CameraOrder(distance_m=distance_m, enabled=True, paused=False, shoots=shoots)
    return CameraOrder(
        paused=True if params[0] == _PAUSE else None, enabled=False if params[0] == _DISABLE else None, shoots=shoots
    )


def _px4_interval(params: Params) -> CameraOrder:
    lasts_ms = _positive(params[0])
    return CameraOrder(interval_s=None if lasts_ms is None else lasts_ms / 1000.0)


def _px4_control(params: Params) -> CameraOrder:
    return CameraOrder(enabled=_flag(params[0]), restarts=params[1] == 1.0, paused=_flag(params[2]))


def _px4_images(params: Params) -> CameraOrder:
    """Read an item of a mission; a series is the business of cameras with a link of their own."""
    return CameraOrder(shoots=params[2] == 1.0)


def _numbered(readers: Mapping[str, _Reader]) -> Mapping[int, _Reader]:
    return {getattr(mavlink, f"MAV_CMD_{name}"): reader for name, reader in readers.items()}


_PX4: Final = _numbered(
    {
        "DO_DIGICAM_CONTROL": _digicam,
        "DO_SET_CAM_TRIGG_DIST": _px4_distance,
        "DO_SET_CAM_TRIGG_INTERVAL": _px4_interval,
        "DO_TRIGGER_CONTROL": _px4_control,
    }
)
_ARDUPILOT: Final = _numbered(
    {
        "DO_DIGICAM_CONFIGURE": _nothing,
        "DO_DIGICAM_CONTROL": _digicam,
        "DO_SET_CAM_TRIGG_DIST": _ardupilot_distance,
        "IMAGE_START_CAPTURE": _ardupilot_images,
        "IMAGE_STOP_CAPTURE": _ardupilot_stop,
        "VIDEO_START_CAPTURE": _no_video,
        "VIDEO_STOP_CAPTURE": _no_video,
    }
)

COMMANDS: Final[Mapping[Flavour, Mapping[int, _Reader]]] = {Flavour.ARDUPILOT: _ARDUPILOT, Flavour.PX4: _PX4}
"""What commands to the autopilot ask of its camera, or why they are refused, whatever the camera is."""

_ITEMS: Final[Mapping[Flavour, Mapping[int, _Reader]]] = {
    Flavour.ARDUPILOT: _ARDUPILOT,
    Flavour.PX4: {**_PX4, mavlink.MAV_CMD_IMAGE_START_CAPTURE: _px4_images},
}


def order_of_item(flavour: Flavour, command: int, params: Params) -> CameraOrder | None:
    """Return what an item of a mission asks of the camera; None where that is nothing."""
    reader = _ITEMS[flavour].get(command)
    order = None if reader is None else reader(params)
    return order if isinstance(order, CameraOrder) else None
