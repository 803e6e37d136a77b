"""Bounds in seconds, proved of a plan: each piece of its certificate has its time by the time law.

While a piece is flown the vehicle is in one of its triangles, wherever it is in the tube: what all of them have holds
for certain, and what one of them has may hold. So a bound is judged on intervals of time, and its margin is one of
every flight within the tube that keeps to the clock of the trajectory.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from typing import Any, Final

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.location import Locator
from mission.geometry.moving import MovingPartition
from mission.geometry.regions import Labelling
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import Formula, seconds_text
from mission.logic.formula.word import Letter
from mission.logic.timed.behaviour import Behaviour, Piece, behaviour_of, from_to, staying
from mission.logic.timed.margins import margin_s
from mission.steering.certificate import Certificate
from mission.steering.touched import MovingTouched, Timing
from mission.steering.trajectory import Trajectory

Met = Callable[[float], IntArray]
"""The triangles that a square of some half width touches."""

FOLLOWED_S: Final = 0.05
"""A flight keeps to the clock of its trajectory to so much, s: setpoints are for moments. A bound has this to spare."""


@dataclass(frozen=True)
class TimeBound:
    """A formula with bounds, and by how much a plan keeps it.

    Attributes:
        formula: The formula.
        margin_s: By how much all its bounds could be tightened at once; below 0, by how much they would have to be
            wider; infinite where time makes no difference.
    """

    formula: Formula
    margin_s: float

    @property
    def short_s(self) -> float:
        """By how much it fails; not above 0 where it is kept."""
        return FOLLOWED_S - self.margin_s

    @property
    def kept(self) -> bool:
        """Whether it is kept for certain."""
        return self.margin_s >= FOLLOWED_S

    @property
    def is_deadline(self) -> bool:
        """Whether something is to come by a time, and may be at any time before."""
        formula = self.formula
        return formula.operator is Operator.EVENTUALLY and formula.bounds is not None and formula.bounds[0] == 0

    @property
    def text(self) -> str:
        """How it fares, in words."""
        if self.margin_s == math.inf:
            return f"{self.formula} is kept, however long it takes"
        if self.kept:
            return f"{self.formula} is kept with {self.margin_s:.2f} s to spare"
        if self.margin_s == -math.inf:
            return f"{self.formula} is not kept, whatever its bounds"
        soonest = f"; the soonest of the plans tried is {_soonest(self.formula, self.short_s)} s" * self.is_deadline
        return f"{self.formula} fails by {self.short_s:.2f} s{soonest}"

    def to_json(self) -> dict[str, Any]:
        """The bound as JSON values; a margin without end is null."""
        return {"formula": str(self.formula), "margin_s": self.margin_s if math.isfinite(self.margin_s) else None}


def followed(trajectory: Trajectory, late_s: float = 0.0) -> Timing:
    """From when to when a flight that keeps to the clock of its trajectory, or is late, may be on a part of its curve.

    Args:
        trajectory: What is flown.
        late_s: By how much it may be late at any time.
    """

    def between(begins: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
        last_s = trajectory.time_at(ends, leaving=True) + FOLLOWED_S + late_s
        return np.maximum(0.0, trajectory.time_at(begins) - FOLLOWED_S), last_s

    return between


def met_at_rest(
    trajectory: Trajectory, certificate: Certificate, locator: Locator, moving: MovingPartition | None = None
) -> Met:
    """What is touched, of a domain that stands or moves, by a square where the proof of a trajectory ends."""
    place_m = trajectory.curve.position(certificate.knots_s[-1:])

    def met(half_m: float) -> IntArray:
        if moving is None:
            (x, y), half = place_m[0], half_m
            return locator.meeting(shapely.box(x - half, y - half, x + half, y + half))
        timing, nowhere = followed(trajectory), np.zeros(moving.fixed.size, dtype=np.bool_)
        from_s, _ = timing(certificate.knots_s[-1:], certificate.knots_s[-1:])
        return MovingTouched(moving, nowhere, half_m, timing).rest(place_m, half_m, from_s).triangles

    return met


def bounds_of(
    formulas: Sequence[Formula],
    trajectory: Trajectory,
    certificate: Certificate,
    met: Met,
    labelling: Labelling,
    *,
    later_s: float = 0.0,
) -> tuple[TimeBound, ...]:
    """What becomes of formulas with bounds on every flight within the tube.

    Args:
        formulas: The formulas.
        trajectory: What is flown.
        certificate: Of it, as far as it repeats or stays.
        met: What is touched where it comes to rest, as from ``met_at_rest``.
        labelling: The labels of the domain.
        later_s: By how much later all of it is flown, for the vehicle waits where it begins.
    """
    if not formulas:
        return ()
    flown = behaviour_flown(trajectory, certificate, met, labelling, Fraction(later_s))
    return tuple(TimeBound(formula, margin_s(flown, formula)) for formula in formulas)


def behaviour_flown(
    trajectory: Trajectory,
    certificate: Certificate,
    met: Met,
    labelling: Labelling,
    later_s: Fraction = Fraction(0),
) -> Behaviour:
    """When every flight within the tube is in a region for certain, and when one of them may be; as ``bounds_of``."""
    times = [later_s + Fraction(t_s) for t_s in trajectory.time_at(certificate.knots_s).tolist()]
    times[0] = Fraction(0)
    letters = [_letters(labelling, possible) for possible in certificate.possible]
    if trajectory.lap is not None:
        lap = trajectory.legs[trajectory.lap]
        loop_s = later_s + Fraction(float(trajectory.time_at(trajectory.curve.starts_s[[trajectory.lap]])[0]))
        return behaviour_of(_pieces(times, letters), loop_s, loop_s + Fraction(lap.duration_s))
    # Where it comes to rest it is in the tube for a moment at least; it lands there, and may drift meanwhile.
    widths_m = certificate.tube_m, certificate.tube_m + certificate.landing_m
    letters += [_letters(labelling, met(half_m).tolist()) for half_m in widths_m]
    times[-1] = max(times[-1], later_s + Fraction(trajectory.duration_s))
    return staying(_pieces([*times, times[-1], times[-1] + 1], letters))


def _letters(labelling: Labelling, triangles: Sequence[int]) -> tuple[Letter, Letter]:
    """What all of some triangles have, and what one of them has."""
    labels = [labelling.label(triangle) for triangle in triangles]
    return frozenset.intersection(*labels), frozenset.union(*labels)


def _pieces(times: Sequence[Fraction], letters: Sequence[tuple[Letter, Letter]]) -> list[Piece]:
    """A piece between each two times, both included, for each is about places; alike ones that follow are one."""
    spans = zip(letters, times[:-1], times[1:], strict=True)
    groups = [(known, list(group)) for known, group in groupby(spans, key=lambda each: each[0])]
    return [Piece(from_to(group[0][1], group[-1][2], closed=True), *known) for known, group in groups]


def _soonest(formula: Formula, short_s: float) -> str:
    last_s = formula.bounds[1] if formula.bounds else Fraction(0)
    return seconds_text(last_s + Fraction(math.ceil(short_s * 100), 100))
