"""Regions and boundaries that a mission takes from files: their shapes, in the place of the names of these."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np

from mission.decimals import decimal
from mission.errors import SpecError
from mission.geometry.places import enu_offsets_m
from mission.interchange.features import Drawing, Feature, Line, Point, Polygon, Spot
from mission.interchange.reading import read_drawing
from mission.spec.finding import Finding, Path, listed, nearest, shortened
from mission.spec.geography import Data, beyond_the_plane, in_degrees, origin_of
from mission.spec.named_files import Reader, UnreadableError
from mission.spec.shape_schema import MAX_COORDINATE_M, MOST_CORNERS, MOST_PARTS

MOST_FILES: Final = 50


class _Refused(Exception):  # noqa: N818 - it never leaves this module
    """Why a shape cannot be had."""

    def __init__(self, key: str, message: str, hint: str) -> None:
        self.key, self.message, self.hint = key, message, hint
        super().__init__(message)


def with_drawn_shapes(data: Data, read: Reader) -> tuple[Data, list[Finding]]:
    """The data with the shapes that files draw written out, and what is wrong with those that cannot be had.

    They are in degrees where the mission is, in metres of its plane elsewhere.
    """
    drawings = _Drawings(data, read)
    findings: list[Finding] = []

    def drawn(value: Any, path: Path) -> Any:  # noqa: ANN401 - any JSON value
        if not isinstance(value, dict) or not isinstance(value.get("file"), str):
            return value
        try:
            shape, found = drawings.shape(value, path)
        except _Refused as refused:
            shape, found = value, [Finding((*path, refused.key), refused.message, refused.hint)]
        findings.extend(found)
        return shape

    domain, regions = data.get("domain"), data.get("regions")
    if isinstance(domain, dict) and "boundary" in domain:
        data = {**data, "domain": {**domain, "boundary": drawn(domain["boundary"], ("domain", "boundary"))}}
    if isinstance(regions, dict):
        data = {**data, "regions": {name: drawn(region, ("regions", name)) for name, region in regions.items()}}
    return data, findings


def drawn_files(data: Data) -> tuple[str, ...]:
    """The files that the shapes of a mission are taken from, as its data name them, each once."""
    domain, regions = data.get("domain"), data.get("regions")
    values = [
        *([domain.get("boundary")] if isinstance(domain, dict) else []),
        *(regions.values() if isinstance(regions, dict) else []),
    ]
    files = (value.get("file") for value in values if isinstance(value, dict))
    return tuple(dict.fromkeys(file for file in files if isinstance(file, str)))


class _Drawings:
    """The files of a mission, each read once."""

    def __init__(self, data: Data, read: Reader) -> None:
        self._read = read
        self._degrees = in_degrees(data)
        self._origin = origin_of(data)
        self._known: dict[str, Drawing | _Refused] = {}

    def shape(self, value: Data, path: Path) -> tuple[Data, list[Finding]]:
        """A region or a boundary, with the keys of a shape in the place of those of its file."""
        drawing = self._drawing(value["file"])
        feature = _feature(drawing, value)
        kept = {key: each for key, each in value.items() if key not in ("file", "feature")}
        points = [point for shape in feature.shapes for point in _points(shape)]
        findings: list[Finding] = []
        if self._origin is not None and drawing.in_degrees:
            places = np.array(points, dtype=np.float64)[:, ::-1]
            findings = [
                Finding((*path, "file"), f"{shortened(value['file'])}: {each.message}", each.hint)
                for each in beyond_the_plane(self._origin, places, ())
            ]
        elif drawing.in_degrees and not self._degrees:
            message = f"{shortened(value['file'])} is in degrees, and the mission has no origin"
            hint = "give origin, or write corners: latitude_longitude in domain"
            raise _Refused("file", message, hint)
        return {**kept, **self._keys(feature, kept, drawing)}, findings

    def _drawing(self, file: str) -> Drawing:
        if file not in self._known:
            self._known[file] = self._read_drawing(file)
        known = self._known[file]
        if isinstance(known, _Refused):
            raise known
        return known

    def _read_drawing(self, file: str) -> Drawing | _Refused:
        if len(self._known) >= MOST_FILES:
            return _Refused("file", f"the mission names more than {MOST_FILES} files", "put several areas in one file")
        try:
            drawing = read_drawing(self._read(file))
        except UnreadableError as error:
            hint = "name a GeoJSON or KML file, by its path relative to the mission file"
            return _Refused("file", f"{shortened(file)}: {error.message}", hint)
        except SpecError as error:
            fault = error.faults[0]
            where = [f"line {fault.line}"] * bool(fault.line) + [fault.path] * bool(fault.path)
            message = f"{', '.join([shortened(file), *where])}: {fault.message}"
            return _Refused("file", message, fault.hint)
        if self._degrees and not drawing.in_degrees:
            message = f"{shortened(file)} is in metres, and the mission in degrees"
            return _Refused("file", message, "write the mission in metres, or the file in degrees")
        return drawing

    def _keys(self, feature: Feature, given: Data, drawing: Drawing) -> Data:
        """The keys of a feature's shape; a width or a radius that the mission gives goes before that of the file."""
        shapes = feature.shapes
        if max(len(shapes), *(len(shape.holes) for shape in shapes if isinstance(shape, Polygon)), 0) > MOST_PARTS:
            message = f"the feature has more than {MOST_PARTS} parts, or holes in one"
            raise _Refused("feature", message, "make several features of it in the file")
        if all(isinstance(shape, Polygon) for shape in shapes):
            if given.keys() & {"width_m", "radius_m"}:
                raise _Refused(
                    "feature", "the feature is a polygon: it has neither width nor radius", "take these away"
                )
            parts = [self._polygon(shape, drawing) for shape in shapes if isinstance(shape, Polygon)]
            return parts[0] if len(parts) == 1 else {"polygons": parts}
        (shape, *others) = shapes
        if others:
            several = listed(type(each).__name__.lower() for each in shapes)
            raise _Refused("feature", f"the feature has several parts: {several}", "make a feature of each in the file")
        if isinstance(shape, Line):
            return {"line": self._places(shape.points, drawing), **_measure("width_m", given, shape.width_m, "line")}
        if isinstance(shape, Spot):
            (centre,) = self._places([shape.centre], drawing)
            return {"centre": centre, **_measure("radius_m", given, shape.radius_m, "place")}
        raise AssertionError("a shape is a polygon, a line or a spot")

    def _polygon(self, polygon: Polygon, drawing: Drawing) -> Data:
        holes = [self._places(hole, drawing) for hole in polygon.holes]
        return {"polygon": self._places(polygon.outline, drawing), **({"holes": holes} if holes else {})}

    def _places(self, points: Sequence[Point], drawing: Drawing) -> list[list[float]]:
        if len(points) > MOST_CORNERS:
            message = f"an outline of the feature has {len(points)} corners, more than {MOST_CORNERS}"
            raise _Refused("feature", message, "simplify it in the program that drew it")
        places = np.array(points, dtype=np.float64)
        if drawing.in_degrees:
            places = places[:, ::-1]
            if not self._degrees and self._origin is not None:
                places = enu_offsets_m(self._origin, places)[0]
        elif np.abs(places).max() > MAX_COORDINATE_M:
            message = (
                f"coordinates are farther than {decimal(MAX_COORDINATE_M)} m from [0, 0], as those of a projection"
            )
            raise _Refused("file", message, "save the file in degrees, WGS 84 (EPSG:4326)")
        rows: list[list[float]] = places.tolist()
        return rows


def _points(shape: Polygon | Line | Spot) -> Iterator[Point]:
    if isinstance(shape, Spot):
        yield shape.centre
    else:
        yield from shape.points if isinstance(shape, Line) else shape.outline


def _measure(key: str, given: Data, drawn: float | None, what: str) -> Data:
    value = given.get(key, drawn)
    if value is None:
        raise _Refused("feature", f"the feature is a {what}, and the file gives it no {key[:-2]}", f"add {key} here")
    return {key: value}


def _feature(drawing: Drawing, value: Data) -> Feature:
    """The feature that is meant, by name or by index from 0; where the file has only one, it need not be named."""
    wanted, features = value.get("feature"), drawing.features
    names = [feature.name for feature in features]
    choice = listed(f"{i} ({shortened(name, 30)})" if name else str(i) for i, name in enumerate(names))
    if wanted is None:
        if len(features) == 1:
            return features[0]
        raise _Refused(
            "file", f"the file draws {len(features)} features", f"add feature: with a name or one of {choice}"
        )
    if isinstance(wanted, int):
        if 0 <= wanted < len(features):
            return features[wanted]
        raise _Refused("feature", f"there is no feature {wanted}", f"the features are {choice}")
    same = [i for i, name in enumerate(names) if name == wanted]
    if len(same) == 1:
        return features[same[0]]
    if same:
        message = f"{len(same)} features have the name {shortened(wanted)!r}"
        raise _Refused("feature", message, f"write its index, one of {listed(same)}")
    close = nearest(str(wanted), [name for name in names if name])
    hint = f"did you mean {close!r}?" if close else f"the features are {choice}"
    raise _Refused("feature", f"no feature has the name {shortened(str(wanted))!r}", hint)
