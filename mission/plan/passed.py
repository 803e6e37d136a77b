"""The run of T that a curve really flies: the triangles that it passes, one beside the other, in order.

The search knows a run through which there is a short way. What is flown is a curve in the corridor of that way, whose
lap may begin elsewhere, and which passes other triangles where the letters are the same.
"""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.geometry.location import Locator
from mission.planning.run import Run
from mission.steering.joined import Curve, JoinedCurve

_FEWEST: Final = 64  # samples of a piece
_FINE: Final = 1e-5  # of the extent of the domain: corners of triangles that are cut off by less do not count


def run_along(legs: Iterable[Curve], locator: Locator, *, lap: bool = False) -> Run:
    """The run along some legs, to stay at the end of the last one or, where it is a lap, to repeat that.

    Args:
        legs: One after the other.
        locator: Of the triangles.
        lap: Whether the last leg is flown for ever.
    """
    *before, last = (_points(leg, _FINE * locator.partition.extent_m) for leg in legs)
    head = _passed(locator, np.concatenate([*before, last[:1]] if lap else [*before, last]))
    return _run(locator, head, _passed(locator, last)[:-1] if lap else ())


def run_through(points_m: FloatArray, locator: Locator) -> Run:
    """The run along a line through points (K, 2), to stay at its end."""
    return _run(locator, _passed(locator, points_m), ())


def _run(locator: Locator, head: tuple[int, ...], loop: tuple[int, ...]) -> Run:
    every = (*head, *loop[1:], head[-1])
    across = locator.partition.neighbours.tolist()
    controls = (0 if here == there else 1 + across[here].index(there) for here, there in pairwise(every))
    return Run(head[:-1], loop or head[-1:], tuple(controls))


def _points(leg: Curve, fine_m: float) -> FloatArray:
    """Points of a curve (K, 2), between which it is nearly straight: by its second derivative."""
    found = []
    for piece in leg.pieces if isinstance(leg, JoinedCurve) else (leg,):
        knots = piece.sampled(_FEWEST).knots_s
        lasts = np.diff(knots)
        parts = np.ceil(lasts * np.sqrt(piece.norm_bounds(knots, 2) / (4.0 * fine_m))).astype(np.int64).clip(1)
        cell = np.repeat(np.arange(len(parts)), parts)
        within = (np.arange(len(cell)) - (np.cumsum(parts) - parts)[cell]) / parts[cell]
        found.append(piece.position(np.append(knots[cell] + within * lasts[cell], knots[-1])))
    return np.concatenate(found)


def _passed(locator: Locator, points_m: FloatArray) -> tuple[int, ...]:
    """The triangles on a line through points (K, 2), that of the first and that of the last one at its ends."""
    at = locator.triangle_at(points_m)
    passed = [int(at[0])]
    steps = np.flatnonzero(np.diff(at))
    plain = locator.straight_over(at[steps], at[steps + 1], points_m[steps], points_m[steps + 1])
    for k, over in zip(steps.tolist(), plain.tolist(), strict=True):
        if over:
            passed.append(int(at[k + 1]))
            continue
        (px, py), (qx, qy) = points_m[k : k + 2].tolist()
        crossed = locator.crossed((px, py), (qx, qy), likely=int(at[k]))
        for triangle, share in (*crossed, (int(at[k + 1]), 1.0)):
            if triangle != passed[-1]:
                passed.extend(_round(locator, passed[-1], triangle, (px + share * (qx - px), py + share * (qy - py))))
    return tuple(passed)


def _round(locator: Locator, here: int, there: int, place_m: tuple[float, float]) -> Iterator[int]:
    """The triangles after one and up to another that touch the place at which the line goes over: neighbours."""
    if there in locator.partition.neighbours[here].tolist():  # nearly always, and without a search
        return iter((there,))
    around = {*locator.triangles_touching(place_m).tolist(), there}
    ways = [[here]]
    while ways[0][-1] != there:
        way = ways.pop(0)
        beyond = around.intersection(locator.partition.neighbours[way[-1]].tolist())
        around -= beyond
        ways += [[*way, triangle] for triangle in sorted(beyond)]
    return iter(ways[0][1:])
