"""The lanes of QGroundControl's survey and corridor items, in the forms that its versions have written.

Since version 4 of the item they stand in ``TransectStyleComplexItem.CameraCalc``; before, in ``grid`` and ``camera``
(https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html). Overlaps are per cent.
"""

from collections.abc import Mapping
from typing import Any, Final

from mission.interchange.features import Camera, Lanes
from mission.interchange.json_text import Json
from mission.interchange.rings import number

_WHOLE: Final = 100.0
_NAMES: Final = {
    "SensorWidth": "sensorWidth",
    "SensorHeight": "sensorHeight",
    "FocalLength": "focalLength",
    "FrontalOverlap": "imageFrontalOverlap",
    "SideOverlap": "imageSideOverlap",
    "Landscape": "orientationLandscape",
}
"""Keys of today's form, with those of the older one."""


def lanes_of(item: Mapping[str, Json]) -> tuple[Lanes | None, float | None]:
    """The lanes of an item and the height that it is flown at, m; None for what it does not tell."""
    today = _object(_object(item, "TransectStyleComplexItem") or item, "CameraCalc")
    grid, camera = _object(item, "grid"), today
    if not today:
        older = _object(item, "camera")
        camera = {key: older.get(name) for key, name in _NAMES.items()}
    spacing_m = _positive(today.get("AdjustedFootprintSide")) or _positive(grid.get("spacing"))
    height_m = _positive(today.get("DistanceToSurface")) or _positive(grid.get("altitude"))
    heading = number(item.get("angle")) if "angle" in item else number(grid.get("angle"))
    return (None if spacing_m is None else Lanes(spacing_m, heading, _camera(camera))), height_m


def _camera(values: Mapping[str, Json]) -> Camera | None:
    """The camera, its image as wide across the lanes as it is held; None for one that is not described."""
    width, height, focal_mm = (_positive(values.get(key)) for key in ("SensorWidth", "SensorHeight", "FocalLength"))
    if width is None or height is None or focal_mm is None:
        return None
    across, along = (height, width) if values.get("Landscape") is False else (width, height)
    overlap, sidelap = (number(values.get(key)) for key in ("FrontalOverlap", "SideOverlap"))
    return Camera(None, (across, along), focal_mm, _share(overlap), _share(sidelap))


def _object(value: Mapping[str, Json], key: str) -> Mapping[str, Json]:
    inner = value.get(key)
    return inner if isinstance(inner, dict) else {}


def _positive(value: Any) -> float | None:  # noqa: ANN401 - any JSON value
    found = number(value)
    return found if found is not None and found > 0.0 else None


def _share(per_cent: float | None) -> float | None:
    return None if per_cent is None or not 0.0 <= per_cent < _WHOLE else per_cent / _WHOLE
