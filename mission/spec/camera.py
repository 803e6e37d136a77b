"""How far apart lanes and photographs are, for a camera that looks straight down."""

from dataclasses import dataclass

import numpy as np

from mission.errors import GeometryError
from mission.spec.model import Camera, Cover


@dataclass(frozen=True)
class Lens:
    """What a camera sees, as the size of its picture at a distance of one; the picture's width lies across the lanes.

    Attributes:
        width: Metres across for each metre above ground, positive.
        height: Metres along for each metre above ground, positive.
    """

    width: float
    height: float

    @classmethod
    def of_view(cls, across_deg: float, along_deg: float) -> "Lens":
        """From the whole angles of view, each between 0 and 180 degrees."""
        _positive(**{"an angle of view": min(across_deg, along_deg)})
        if max(across_deg, along_deg) >= 180.0:  # noqa: PLR2004 - a flat camera sees half of everything at most
            raise GeometryError("an angle of view must be less than 180 degrees")
        width, height = 2.0 * np.tan(np.radians([across_deg, along_deg]) / 2.0)
        return cls(float(width), float(height))

    @classmethod
    def of_sensor(cls, width_mm: float, height_mm: float, focal_length_mm: float) -> "Lens":
        """From the size of the sensor and the focal length: true ones, not those of an equivalent in small format."""
        _positive(**{"a side of the sensor": min(width_mm, height_mm), "the focal length": focal_length_mm})
        return cls(width_mm / focal_length_mm, height_mm / focal_length_mm)


def lane_spacing_m(lens: Lens, altitude_m: float, sidelap: float) -> float:
    """Distance of lanes at which pictures of neighbours share a part of their width.

    Args:
        lens: What the camera sees.
        altitude_m: Above the ground, positive.
        sidelap: The part, 0 <= sidelap < 1.

    Raises:
        GeometryError: An argument is none of these.
    """
    return _step_m(lens.width, altitude_m, sidelap, "sidelap")


def trigger_distance_m(lens: Lens, altitude_m: float, overlap: float) -> float:
    """Distance flown from a picture to the next at which they share a part of their height.

    Args:
        lens: What the camera sees.
        altitude_m: Above the ground, positive.
        overlap: The part, 0 <= overlap < 1.

    Raises:
        GeometryError: An argument is none of these.
    """
    return _step_m(lens.height, altitude_m, overlap, "overlap")


def _step_m(size: float, altitude_m: float, shared: float, name: str) -> float:
    _positive(**{"the altitude above ground": altitude_m})
    if not 0.0 <= shared < 1.0:
        raise GeometryError(f"{name} must be at least 0 and less than 1, and is {shared:.4g}")
    return size * altitude_m * (1.0 - shared)


def _positive(**values: float) -> None:
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0.0):
            raise GeometryError(f"{name} must be positive, and is {value:.4g}")


def spacing_of(cover: Cover, altitude_m: float) -> float:
    """Distance between lanes at a height above the ground."""
    if cover.camera is not None:
        return lane_spacing_m(_lens(cover.camera), altitude_m, cover.camera.sidelap)
    return cover.spacing_m or 0.0


def trigger_of(cover: Cover, altitude_m: float) -> float | None:
    """Distance between images in a lane at a height above the ground; None without a camera."""
    camera = cover.camera
    return None if camera is None else trigger_distance_m(_lens(camera), altitude_m, camera.overlap)


def _lens(camera: Camera) -> Lens:
    if camera.field_of_view_deg is not None:
        return Lens.of_view(*camera.field_of_view_deg)
    return Lens.of_sensor(*(camera.sensor_mm or (0.0, 0.0)), camera.focal_length_mm or 0.0)
