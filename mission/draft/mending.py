"""Outlines with faults that have one meaning: they touch themselves, have spikes, or holes that lie outside."""

import re
from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely
from shapely.validation import explain_validity

from mission.draft.frame import Frame
from mission.errors import Fault, SpecError
from mission.interchange.features import Point, Polygon
from mission.printable import printable

_SAME: Final = 1e-9
"""Of an area: what rounding makes of it."""


def mended(name: str, polygons: Sequence[Polygon], frame: Frame) -> tuple[list[Polygon], list[str]]:
    """Polygons that are sound, and what was mended.

    What a ring goes round is beyond doubt where the areas of the parts that it touches itself between add up, with
    the sense in which it goes round each, to that of the whole.

    Raises:
        SpecError: A ring crosses itself, or has no width.
    """
    found: list[Polygon] = []
    said: list[str] = []
    for polygon in polygons:
        outline = shapely.Polygon(frame.metres(polygon.outline))
        areas = [shapely.Polygon(frame.metres(hole)) for hole in polygon.holes]
        inside = [shapely.intersects(outline if outline.is_valid else outline.buffer(0.0), area) for area in areas]
        if not all(inside):
            said.append("a hole that lies outside of it is left out")
        holes = tuple(hole for hole, here in zip(polygon.holes, inside, strict=True) if here)
        areas = [area for area, here in zip(areas, inside, strict=True) if here]
        if all(area.is_valid for area in (outline, *areas)):
            found.append(Polygon(polygon.outline, holes))
            continue
        parts = _parts(outline, areas)
        drawn = {
            tuple(at): point
            for ring in (polygon.outline, *holes)
            for at, point in zip(frame.metres(ring).tolist(), ring, strict=True)
        }
        rings = [[ring.coords[:-1] for ring in (part.exterior, *part.interiors)] for part in parts]
        if not parts or not all(tuple(at) in drawn for each in rings for ring in each for at in ring):
            raise _crossed(name, outline if not outline.is_valid else next(a for a in areas if not a.is_valid), frame)
        said.append("an outline that touched itself, or had a spike, was taken apart there")
        found += [Polygon(_ring(each[0], drawn), tuple(_ring(ring, drawn) for ring in each[1:])) for each in rings]
    return found, said


def _ring(places: Sequence[tuple[float, ...]], drawn: dict[tuple[float, ...], Point]) -> tuple[Point, ...]:
    return tuple(drawn[tuple(at)] for at in places)


def _parts(outline: shapely.Polygon, holes: Sequence[shapely.Polygon]) -> list[shapely.Polygon]:
    """The parts of an outline less its holes; none where it is not plain what is inside."""
    sound = [_sound(area) for area in (outline, *holes)]
    if not all(sound):
        return []
    whole = shapely.union_all(sound[0])
    left = shapely.difference(whole, shapely.union_all([part for parts in sound[1:] for part in parts]))
    return [part for part in shapely.get_parts(left) if isinstance(part, shapely.Polygon)]


def _sound(area: shapely.Polygon) -> list[shapely.Polygon]:
    """The parts that a ring goes round; none where that is not plain."""
    if area.is_valid:
        return [area]
    parts = [part for part in shapely.get_parts(shapely.make_valid(area)) if isinstance(part, shapely.Polygon)]
    # Of the ring this is the sum with signs: loops that go round the other way, or twice, make it another one.
    total = sum(float(part.area) for part in parts)
    return parts if parts and abs(total - area.area) <= _SAME * total else []


def _crossed(name: str, area: shapely.Polygon, frame: Frame) -> SpecError:
    found = re.findall(r"-?[0-9.]+(?:e-?[0-9]+)?", explain_validity(area))[:2]
    place = np.array(found, dtype=np.float64)
    near = f" near {frame.as_made(place)}" if len(found) > 1 else ""
    message = f'an outline of "{printable(name)}" crosses itself or has no width{near}'
    return SpecError((Fault(0, 0, "", message, "correct it in the program that drew it"),))
