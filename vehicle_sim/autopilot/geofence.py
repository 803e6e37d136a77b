"""Geofences as geometry: areas on earth that contain the vehicle or keep it out, and how far outside a point is.

Each area has a signed distance: the distance to its border, positive where the area forbids the point. An intersection
of what is allowed is the maximum of them, a union the minimum. All of these are Lipschitz with constant one: who is d
inside has to move by d before anything can be breached, so the border needs no looking at until then.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf

import numpy as np

from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.signals import Geodetic


@dataclass(frozen=True, slots=True)
class Polygon:
    """An area within straight edges; the last vertex joins the first. `contains`: stay in, else stay out."""

    contains: bool
    vertices: tuple[Geodetic, ...]


@dataclass(frozen=True, slots=True)
class Circle:
    """An area around a centre. `contains`: stay in, else stay out."""

    contains: bool
    centre: Geodetic
    radius_m: float


Area = Polygon | Circle


@dataclass(frozen=True, slots=True)
class FencePlan:
    """What was uploaded: areas, and the point to return to (ArduPilot; only planes fly there)."""

    areas: tuple[Area, ...] = ()
    return_point: Geodetic | None = None


class LocalFence:
    """The areas of a plan in the tangent plane of an origin: north and east in metres."""

    def __init__(self, areas: Iterable[Area], origin: Geodetic) -> None:
        """Project `areas`, E edges of P polygons and C circles in all."""
        starts, ends, firsts, holds = [], [], [], []
        circles = []
        edges = 0
        for area in areas:
            if isinstance(area, Circle):
                north, east, _ = ned_offset_m(origin, area.centre)
                circles.append((north, east, area.radius_m, 1.0 if area.contains else -1.0))
                continue
            ring = np.array([ned_offset_m(origin, vertex)[:2] for vertex in area.vertices])
            starts.append(ring)
            ends.append(np.roll(ring, -1, axis=0))
            firsts.append(edges)
            holds.append(area.contains)
            edges += len(ring)
        self._starts = np.concatenate(starts) if starts else np.empty((0, 2))
        self._ends = np.concatenate(ends) if ends else np.empty((0, 2))
        self._vectors = self._ends - self._starts
        squares = np.sum(self._vectors**2, axis=1)
        # An edge without length is its start.
        self._squares = np.where(squares > 0.0, squares, 1.0)
        self._firsts = np.array(firsts, dtype=np.intp)
        self._holds = np.array(holds, dtype=bool)
        self._circles = np.array(circles).reshape(-1, 4)

    def nearest_m(self, north: float, east: float) -> np.ndarray:
        """Return the offsets (E + C, 2) from a point to the nearest point of each edge and of each circle's rim."""
        point = np.array((north, east))
        along = np.sum((point - self._starts) * self._vectors, axis=1) / self._squares
        edges = self._starts + np.clip(along, 0.0, 1.0)[:, None] * self._vectors - point
        centres = self._circles[:, :2] - point
        reach = np.hypot(centres[:, 0], centres[:, 1])
        # From the very centre every direction is as good as any other.
        inwards = np.where(reach[:, None] > 0.0, centres, (1.0, 0.0)) / np.where(reach > 0.0, reach, 1.0)[:, None]
        return np.concatenate((edges, inwards * (reach - self._circles[:, 2])[:, None]))

    def excess_m(self, north: float, east: float, *, is_union: bool = False) -> float:
        """Return how far outside of what is allowed a point is; negative inside, minus infinity without areas.

        `is_union`: to be in one of the areas to stay in is enough.
        """
        nearest = self.nearest_m(north, east)
        distances = np.hypot(nearest[:, 0], nearest[:, 1])
        edges = len(self._starts)
        forbidding, holding = [], []
        if edges:
            # Crossings of the ray to the east: an odd number of them means inside.
            y, dy = self._starts[:, 0] - north, self._vectors[:, 0]
            straddles = (y > 0.0) != (self._ends[:, 0] - north > 0.0)
            x = self._starts[:, 1] - east - y * self._vectors[:, 1] / np.where(straddles, dy, 1.0)
            inside = np.add.reduceat((straddles & (x > 0.0)).astype(np.intp), self._firsts) % 2 == 1
            borders = np.minimum.reduceat(distances[:edges], self._firsts)
            signed = np.where(inside != self._holds, borders, -borders)
            forbidding.extend(signed[~self._holds])
            holding.extend(signed[self._holds])
        if len(self._circles):
            north_off, east_off, radius, sign = self._circles.T
            signed = sign * (np.hypot(north_off - north, east_off - east) - radius)
            forbidding.extend(signed[sign < 0.0])
            holding.extend(signed[sign > 0.0])
        inner = (min(holding) if is_union else max(holding)) if holding else -inf
        return float(max(inner, max(forbidding, default=-inf)))
