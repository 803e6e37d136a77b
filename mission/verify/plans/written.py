"""A plan file as the checker reads it: the mission in it with all that follows, and the curves and laws of its legs."""

from collections.abc import Mapping
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import BuchiAutomaton, CompiledAutomaton
from mission.logic.automata.combination import union
from mission.logic.automata.complement import complement
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.determined import part_of, parts_of
from mission.logic.automata.refutation import refutation
from mission.logic.automata.safety import safety_of
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import TRUE, Formula, conjunction
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.model import MissionSpec
from mission.spec.tasks import task_formula
from mission.verify.plans.law import Law
from mission.verify.plans.patches import Patches, in_a_row, patches_of
from mission.verify.plans.tube import Ground


class Written:
    """What a plan file holds; each part is made when it is asked for, and may raise as whatever makes it.

    Args:
        data: The file.
        spec: The mission in it.
    """

    def __init__(self, data: Mapping[str, Any], spec: MissionSpec) -> None:
        self.data, self.spec = data, spec

    @cached_property
    def _domain(self) -> tuple[Partition, Labelling]:
        return build_domain(self.spec)

    @property
    def partition(self) -> Partition:
        """The triangles that the mission's outlines make."""
        return self._domain[0]

    @property
    def labelling(self) -> Labelling:
        """Their labels."""
        return self._domain[1]

    @cached_property
    def restricted(self) -> BoolArray:
        """Shape (M,), the triangles that must not be met."""
        return restricted_triangles(self.spec, self.labelling)

    @cached_property
    def ground(self) -> Ground:
        """The triangles, to be asked what meets them."""
        return Ground(self.partition, self.restricted)

    @cached_property
    def formula(self) -> Formula:
        """The mission's formula and its tasks, but for those that were dropped."""
        spec, dropped = self.spec, {task["number"] for task in self.data.get("dropped", ())}
        own = [parse_formula(spec.formula, frozenset(each.name for each in spec.regions))] if spec.formula else []
        return conjunction(*own, *(task_formula(t, spec.regions) for i, t in enumerate(spec.tasks) if i not in dropped))

    @cached_property
    def refutation(self) -> BuchiAutomaton:
        """The words that violate the mission."""
        given = self.spec.automaton
        if given is None:
            return refutation(self.formula)
        outside = complement(given.automaton, self.labelling.letters)
        return outside if self.formula is TRUE else union(outside, refutation(self.formula))

    @property
    def bad_prefixes(self) -> CompiledAutomaton:
        """The words that violate the mission in finite time."""
        given, letters = self.spec.automaton, self.labelling.letters
        own = () if given is None else (part_of(given.automaton, letters),)
        return safety_of(Conjunction.of((*own, *parts_of(self.formula, letters))).whole).refutation()

    @cached_property
    def legs(self) -> tuple[Patches, ...]:
        """The curves."""
        return tuple(patches_of(leg["curve"]) for leg in self.data["trajectory"]["legs"])

    @cached_property
    def laws(self) -> tuple[Law, ...]:
        """Their time laws."""
        return tuple(Law(leg["law"]) for leg in self.data["trajectory"]["legs"])

    @cached_property
    def curve(self) -> Patches:
        """All legs, each once."""
        return in_a_row(list(self.legs))

    @cached_property
    def starts_s(self) -> FloatArray:
        """Where each leg begins on the curve, and the end."""
        return np.concatenate(([0.0], np.cumsum([leg.ends_s[-1] for leg in self.legs])))

    @property
    def lap(self) -> int | None:
        """Which leg is flown several times."""
        return None if (lap := self.data["trajectory"]["lap"]) is None else int(lap)

    @property
    def steered(self) -> bool:
        """Whether fields steer along the path; otherwise it is a polyline in a corridor."""
        return "segments" in self.data["path"]

    @property
    def segments(self) -> list[list[Mapping[str, Any]]]:
        """The segments of each leg of a path that fields steer."""
        path, lap = self.data["path"], self.data["path"]["lap"]
        cuts = sorted({0, *(lap or ()), len(path["segments"])})
        return [path["segments"][a:b] for a, b in pairwise(cuts)]

    @property
    def pieces(self) -> list[list[Mapping[str, Any]]]:
        """The smooth curves of each leg."""
        return [_pieces_of(leg["curve"]) for leg in self.data["trajectory"]["legs"]]

    def place(self, t_s: float) -> float:
        """Where on the curve the vehicle is at a time, of the first lap."""
        begins = 0.0
        for law, start in zip(self.laws, self.starts_s.tolist(), strict=False):
            if t_s <= begins + law.duration_s:
                return float(start + law.jet(np.array([t_s - begins]))[0][0])
            begins += law.duration_s
        return float("inf")


def _pieces_of(curve: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [piece for leg in curve["legs"] for piece in _pieces_of(leg)] if curve["kind"] == "joined" else [curve]
