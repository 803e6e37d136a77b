"""A plan file as the checker reads it: the mission in it with all that follows, its curves, laws and proofs."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.model import UNTIL_STOPPED, MissionSpec
from mission.spec.moving import moving_of
from mission.spec.specification import of_mission
from mission.verify.plans.motion import Law
from mission.verify.plans.moving import Leg, MovingGround
from mission.verify.plans.patches import Patches, in_a_row, patches_of
from mission.verify.plans.tube import Ground, Met

Verdict = tuple[str | None, str]
"""What is wrong, None where nothing is; and what was looked at, in numbers."""

_SAME = 1e-9


class Proof(NamedTuple):
    """A certificate, and the part of the curve that it is about.

    Attributes:
        curve: That part, from 0.
        knots_s: Shape (K + 1,), the ends of its pieces; a piece may be an instant.
        sets: K sets of triangles.
        data: All of it.
        legs: The numbers of the legs of that part.
    """

    curve: Patches
    knots_s: FloatArray
    sets: list[list[int]]
    data: Mapping[str, Any]
    legs: range


class Written:
    """What a plan file holds; raises whatever makes its parts, where they are none.

    Attributes:
        data: The file.
        spec: The mission in it.
        partition: The triangles that its outlines make.
        labelling: Their labels.
        restricted: Shape (M,), the triangles that must not be met.
        ground: The triangles, to be asked what meets them; where they move, as they are at first, and of those that
            must not be met the ones that stand.
        moving: The triangles as they move; None where all of them stand.
        specification: What the flight must satisfy.
        steered: Whether fields steer along the path; otherwise it is a polyline in a corridor.
        legs: The curves of the trajectory.
        laws: Their time laws.
        curve: All legs, each once.
        starts_s: Where each leg begins on the curve, and the end.
        lap: Which leg is flown several times; None where there is none.
        proofs: What is proved: up to the end of a lap, and the way back from there.
        knots_s: The ends of the pieces of all proofs, on the whole curve.
        sets: Their triangles.
    """

    def __init__(self, data: Mapping[str, Any], spec: MissionSpec) -> None:
        self.data, self.spec, trajectory = data, spec, data["trajectory"]
        self.partition, self.labelling = build_domain(spec)
        self.restricted = restricted_triangles(spec, self.labelling)
        moving = moving_of(spec, self.partition, self.labelling)
        self.moving = None if moving is None else MovingGround(moving, self.restricted)
        drift = False if moving is None else moving.moves[self.partition.triangles].any(axis=1)
        self.ground = Ground(self.partition, self.restricted & np.logical_not(drift))
        dropped = (task["number"] for task in data.get("dropped", ()))
        self.specification = of_mission(spec, self.labelling.letters, dropped)
        self.steered = "segments" in data["path"]
        self.legs = [patches_of(leg["curve"]) for leg in trajectory["legs"]]
        self.laws = [Law(leg["law"]) for leg in trajectory["legs"]]
        self.curve = in_a_row(self.legs)
        self.starts_s: FloatArray = np.cumsum([0.0, *(leg.ends_s[-1] for leg in self.legs)])
        self.lap: int | None = trajectory["lap"]
        if self.lap is not None and not 0 <= self.lap < len(self.legs):
            raise ValueError("`trajectory.lap` is the number of no leg")
        cut, back = len(self.legs) if self.lap is None else self.lap + 1, data["homeward"]
        if (back is not None) != (cut < len(self.legs)):
            raise ValueError("`homeward` and the legs after the laps belong together")
        parts = ((data, range(cut)), (back, range(cut, len(self.legs))))
        self.proofs = [_proof(of["certificate"], self.legs, numbers) for of, numbers in parts if numbers]
        self._begun_s = self._begins()
        runs = [each["run"][part] for each in (data, back) if each for part in ("prefix", "suffix")]
        steered = [[segment["triangle"] for segment in data["path"].get("segments", ())]]
        named = {t for proof in self.proofs for each in proof.sets for t in each}.union(*runs, *steered)
        if not all(isinstance(t, int) and 0 <= t < self.partition.size for t in named):
            raise ValueError(f"a triangle has a number from 0 to {self.partition.size - 1}")
        starts = np.cumsum([0.0, *(proof.knots_s[-1] for proof in self.proofs)])
        knots = [start + proof.knots_s[1:] for start, proof in zip(starts, self.proofs, strict=False)]
        self.knots_s: FloatArray = np.concatenate(([0.0], *knots))
        self.sets = [each for proof in self.proofs for each in proof.sets]

    def legs_of(self, proof: Proof) -> list[Leg]:
        """The legs of a proof, and when each is begun."""
        starts = self.starts_s - self.starts_s[proof.legs[0]]
        return [Leg(self.legs[k], self.laws[k], float(starts[k]), self._begun_s[k]) for k in proof.legs]

    def begin_met(self, proof: Proof, half_m: float) -> Met:
        """What a square meets where the curve of a proof begins, as it does."""
        begun = self._begun_s[proof.legs[0]]
        return self._met(proof.curve.at(np.zeros(1)), half_m, (begun[0], begun[-1]))

    def end_met(self, proof: Proof, half_m: float) -> Met:
        """What a square meets where the curve of a proof ends, as it does; where the flight ends there, ever after."""
        last = proof.legs[-1]
        first_s, last_s = (self._begun_s[last][i] + self.laws[last].duration_s for i in (0, -1))
        times = first_s, np.inf if proof is self.proofs[-1] else last_s
        return self._met(proof.curve.at(proof.curve.ends_s[-1:]), half_m, times)

    def stop_met(self, s: float, half_m: float) -> Met:
        """What a square meets at a place on the whole curve while the vehicle is there."""
        k = int(np.clip(np.searchsorted(self.starts_s, s, side="right") - 1, 0, len(self.legs) - 1))
        law, own = self.laws[k], s - self.starts_s[k]
        knot = law.knots_s[np.argmin(np.abs(law.knots_s - own))]
        own = np.array([knot if abs(knot - own) <= _SAME * law.place_s else own])
        reached, left = (float(law.times_s(own, leaving=leaving)[0]) for leaving in (False, True))
        return self._met(
            self.curve.at(np.array([s])), half_m, (self._begun_s[k][0] + reached, self._begun_s[k][-1] + left)
        )

    def _met(self, place_m: FloatArray, half_m: float, times_s: tuple[float, float]) -> Met:
        return (
            self.ground.met_at(place_m, half_m)
            if self.moving is None
            else self.moving.met_at(place_m, half_m, *times_s)
        )

    def _begins(self) -> list[list[float]]:
        """When each leg is begun: a lap again and again until all triangles stand, and what follows it after each."""
        lasts = [law.duration_s for law in self.laws]
        once = np.cumsum([0.0, *lasts])
        if self.moving is None or self.lap is None:
            return [[begin] for begin in once[:-1].tolist()]
        laps, lap_s = self.spec.flight.laps, lasts[self.lap]
        again = int(np.ceil(max(0.0, self.moving.moving.last_s - once[self.lap]) / lap_s)) + 1
        rounds = lap_s * np.arange(again if laps == UNTIL_STOPPED else min(again, laps))
        return [(begin + (rounds if k >= self.lap else rounds[:1])).tolist() for k, begin in enumerate(once[:-1])]

    def own(self, region: str) -> BoolArray:
        """Shape (M,), the triangles of a region."""
        return np.isin(np.arange(self.partition.size), self.labelling.triangles_of(region))

    def visits(self, regions: Iterable[str]) -> Iterator[tuple[str, float, float]]:
        """When the tube comes into a region and leaves it, by the pieces of the proofs; all of it is inside in between.

        To begin inside is no visit.
        """
        for name in sorted(regions):
            own = self.own(name)
            for inside, group in groupby(range(len(self.sets)), key=lambda k: bool(own[self.sets[k]].any())):
                first, *others = group
                if inside and first > 0 and any(own[self.sets[k]].all() for k in (first, *others)):
                    yield name, float(self.knots_s[first]), float(self.knots_s[[first, *others][-1] + 1])


def _proof(data: Mapping[str, Any], legs: list[Patches], numbers: range) -> Proof:
    curve = in_a_row([legs[k] for k in numbers])
    knots, sets = np.array(data["knots_s"], dtype=np.float64), data["possible"]
    if len(knots) != len(sets) + 1 or not all(sets) or (np.diff(knots) < 0.0).any():
        raise ValueError("`certificate.possible` names triangles for each piece, one after the other")
    if abs(knots[0]) > 0.0 or abs(knots[-1] - curve.ends_s[-1]) > 1e-9 * knots[-1]:
        raise ValueError("`certificate.knots_s` do not lead from where the curve begins to its end")
    return Proof(curve, knots, sets, data, numbers)
