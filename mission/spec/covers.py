"""``cover`` of a region between its two forms: the data of a file, and frozen values."""

from typing import Any

from mission.spec.cover_schema import DEFAULT_OVERLAP, DEFAULT_SHARE, DEFAULT_SIDELAP
from mission.spec.model import Camera, Cover, Point

Data = dict[str, Any]

_AUTO = "auto"


def cover_of(data: Data) -> Cover:
    """The values of data that fits the schema."""
    heading = data.get("heading_deg", _AUTO)
    return Cover(
        spacing_m=float(data["spacing_m"]) if "spacing_m" in data else None,
        camera=_camera_of(data["camera"]) if "camera" in data else None,
        heading_deg=None if heading == _AUTO else float(heading),
        share=float(data.get("share", DEFAULT_SHARE)),
    )


def cover_data(cover: Cover) -> Data:
    """The data that ``cover_of`` reads as these values."""
    camera = cover.camera
    return {
        **({} if cover.spacing_m is None else {"spacing_m": cover.spacing_m}),
        **({} if camera is None else {"camera": _camera_data(camera)}),
        "heading_deg": _AUTO if cover.heading_deg is None else cover.heading_deg,
        "share": cover.share,
    }


def _camera_of(data: Data) -> Camera:
    return Camera(
        field_of_view_deg=_pair(data.get("field_of_view_deg")),
        sensor_mm=_pair(data.get("sensor_mm")),
        focal_length_mm=float(data["focal_length_mm"]) if "focal_length_mm" in data else None,
        overlap=float(data.get("overlap", DEFAULT_OVERLAP)),
        sidelap=float(data.get("sidelap", DEFAULT_SIDELAP)),
    )


def _camera_data(camera: Camera) -> Data:
    lens = {
        "field_of_view_deg": camera.field_of_view_deg and list(camera.field_of_view_deg),
        "sensor_mm": camera.sensor_mm and list(camera.sensor_mm),
        "focal_length_mm": camera.focal_length_mm,
    }
    given = {key: value for key, value in lens.items() if value is not None}
    return {**given, "overlap": camera.overlap, "sidelap": camera.sidelap}


def _pair(values: list[float] | None) -> Point | None:
    return None if values is None else (float(values[0]), float(values[1]))
