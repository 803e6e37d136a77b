"""Cameras that files tell of, as mission files have them."""

from typing import Final

from mission.decimals import decimal
from mission.interchange.features import Camera
from mission.spec.camera import Lens, lane_spacing_m
from mission.spec.cover_schema import DEFAULT_OVERLAP, DEFAULT_SIDELAP

ALTITUDE_M: Final = 30.0
"""Of flights whose file gives none."""

_SAME: Final = 0.02
_MOST_SHARED: Final = 0.95
_RANGES: Final = {"field_of_view_deg": (1.0, 170.0), "sensor_mm": (0.1, 1_000.0), "focal_length_mm": (0.1, 10_000.0)}


def camera_keys(camera: Camera) -> str:
    """The value of the key ``camera`` of a mission file."""
    values = {"field_of_view_deg": camera.field_of_view_deg, "sensor_mm": camera.sensor_mm}
    keys = {name: f"[{decimal(pair[0])}, {decimal(pair[1])}]" for name, pair in values.items() if pair is not None}
    if camera.focal_length_mm is not None:
        keys["focal_length_mm"] = decimal(camera.focal_length_mm)
    keys |= {"overlap": decimal(_overlap(camera)), "sidelap": decimal(_sidelap(camera))}
    return "{" + ", ".join(f"{key}: {value}" for key, value in keys.items()) + "}"


def agrees(camera: Camera, spacing_m: float | None, altitude_m: float) -> bool:
    """Whether a mission can have a camera, and it gives lanes as far apart as they are from the altitude."""
    pairs = {"field_of_view_deg": camera.field_of_view_deg, "sensor_mm": camera.sensor_mm}
    focal_mm = camera.focal_length_mm
    given = {name: pair for name, pair in pairs.items() if pair is not None}
    given |= {} if focal_mm is None else {"focal_length_mm": (focal_mm, focal_mm)}
    if not all(_RANGES[name][0] <= min(pair) and max(pair) <= _RANGES[name][1] for name, pair in given.items()):
        return False
    if camera.field_of_view_deg is not None:
        lens = Lens.of_view(*camera.field_of_view_deg)
    elif camera.sensor_mm is not None and focal_mm is not None:
        lens = Lens.of_sensor(*camera.sensor_mm, focal_mm)
    else:
        return False
    wide_m = lane_spacing_m(lens, altitude_m, _sidelap(camera))
    return spacing_m is None or abs(wide_m - spacing_m) <= _SAME * spacing_m


def _overlap(camera: Camera) -> float:
    return DEFAULT_OVERLAP if camera.overlap is None else min(camera.overlap, _MOST_SHARED)


def _sidelap(camera: Camera) -> float:
    return DEFAULT_SIDELAP if camera.sidelap is None else min(camera.sidelap, _MOST_SHARED)
