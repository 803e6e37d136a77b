"""A plan file as the checker reads it: the mission in it with all that follows, its curves, laws and proofs."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.model import MissionSpec
from mission.spec.specification import of_mission
from mission.verify.plans.motion import Law
from mission.verify.plans.patches import Patches, in_a_row, patches_of
from mission.verify.plans.tube import Ground

Verdict = tuple[str | None, str]
"""What is wrong, None where nothing is; and what was looked at, in numbers."""


class Proof(NamedTuple):
    """A certificate, and the part of the curve that it is about.

    Attributes:
        curve: That part, from 0.
        knots_s: Shape (K + 1,), the ends of its pieces; a piece may be an instant.
        sets: K sets of triangles.
        data: All of it.
    """

    curve: Patches
    knots_s: FloatArray
    sets: list[list[int]]
    data: Mapping[str, Any]


class Written:
    """What a plan file holds; raises whatever makes its parts, where they are none.

    Attributes:
        data: The file.
        spec: The mission in it.
        partition: The triangles that its outlines make.
        labelling: Their labels.
        restricted: Shape (M,), the triangles that must not be met.
        ground: The triangles, to be asked what meets them.
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
        self.ground = Ground(self.partition, self.restricted)
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
        parts = ((data, self.legs[:cut]), (back, self.legs[cut:]))
        self.proofs = [_proof(of["certificate"], in_a_row(legs)) for of, legs in parts if legs]
        runs = [each["run"][part] for each in (data, back) if each for part in ("prefix", "suffix")]
        steered = [[segment["triangle"] for segment in data["path"].get("segments", ())]]
        named = {t for proof in self.proofs for each in proof.sets for t in each}.union(*runs, *steered)
        if not all(isinstance(t, int) and 0 <= t < self.partition.size for t in named):
            raise ValueError(f"a triangle has a number from 0 to {self.partition.size - 1}")
        starts = np.cumsum([0.0, *(proof.knots_s[-1] for proof in self.proofs)])
        knots = [start + proof.knots_s[1:] for start, proof in zip(starts, self.proofs, strict=False)]
        self.knots_s: FloatArray = np.concatenate(([0.0], *knots))
        self.sets = [each for proof in self.proofs for each in proof.sets]

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


def _proof(data: Mapping[str, Any], curve: Patches) -> Proof:
    knots, sets = np.array(data["knots_s"], dtype=np.float64), data["possible"]
    if len(knots) != len(sets) + 1 or not all(sets) or (np.diff(knots) < 0.0).any():
        raise ValueError("`certificate.possible` names triangles for each piece, one after the other")
    if abs(knots[0]) > 0.0 or abs(knots[-1] - curve.ends_s[-1]) > 1e-9 * knots[-1]:
        raise ValueError("`certificate.knots_s` do not lead from where the curve begins to its end")
    return Proof(curve, knots, sets, data)
