"""The certificate: that the triangles it names hold the tube, and what a flight among them can spell."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.logic.automata.automaton import compile_to_alphabet
from mission.spec.model import Semantics
from mission.verify.plans.patches import Patches, in_a_row
from mission.verify.plans.tube import far_enough, stray
from mission.verify.plans.words import Layers, spells
from mission.verify.plans.written import Written

Verdict = tuple[str | None, str]
"""What is wrong, None where nothing is; and what was looked at, in numbers."""

Sets = list[list[int]]


def certified(plan: Written) -> list[tuple[Patches, Mapping[str, Any]]]:
    """The curves that are proved, each with its certificate: up to the end of a lap, and the way back from there."""
    end = len(plan.legs) if plan.lap is None else plan.lap + 1
    found = [(in_a_row(list(plan.legs[:end])), plan.data["certificate"])]
    if (plan.data["homeward"] is not None) != (end < len(plan.legs)):
        raise ValueError("`homeward` and the legs after the laps belong together")
    if plan.data["homeward"] is not None:
        found.append((in_a_row(list(plan.legs[end:])), plan.data["homeward"]["certificate"]))
    return found


def tube_holds(plan: Written) -> Verdict:
    """No triangle is met but those that are named, none of which is restricted, and the domain is not left."""
    pieces = 0
    for what, (curve, proof) in zip(("the tube", "the tube of the way back"), certified(plan), strict=False):
        knots, sets = pieces_of(proof)
        if abs(knots[0]) > 0.0 or abs(knots[-1] - curve.ends_s[-1]) > 1e-9 * knots[-1]:
            return "`certificate.knots_s` do not lead from the beginning of the curve to its end", ""
        closed = [t for each in sets for t in each if plan.restricted[t]]
        if closed:
            names = sorted({name for t in closed for name in plan.labelling.label(t)})
            return f"its pieces name triangles of {' and '.join(names)}, which must not be entered", ""
        fault = stray(plan.ground, curve, plan.spec.flight.tube_m, knots, sets)
        if fault:
            return f"{what} {fault}", ""
        pieces += len(sets)
    return None, f"{pieces} pieces, {plan.spec.flight.tube_m:g} m on each side"


def words_satisfy(plan: Written) -> Verdict:
    """Every word that can be spelled satisfies the mission, and with the way back, none violates it."""
    (curve, proof), *back = certified(plan)
    sets, lap = _layers(plan, curve, proof)
    arguments = (plan.partition, plan.labelling.letter_of)
    letters, first = plan.labelling.letters, plan.spec.semantics is Semantics.STANDARD
    compiled = compile_to_alphabet(plan.refutation, letters)
    if spells(Layers(sets, lap), *arguments, compiled, reads_first=first):
        return "a flight within the tube may spell a word that violates the mission", ""
    for onward, its_proof in back:
        later, _ = _layers(plan, onward, its_proof, alone=True)
        if spells(Layers([*sets, *later], lap), *arguments, plan.bad_prefixes, reads_first=first):
            return "the way back may violate the mission", ""
    return None, f"{len(sets)} layers, {compiled.states} states of the automaton of what is forbidden"


def figures_hold(plan: Written) -> Verdict:
    """The distance from what is restricted, and the word that is surely spelled."""
    told = []
    for curve, proof in certified(plan):
        claimed = proof["clearance_m"]
        if (claimed is None) == bool(plan.restricted.any()):
            return "`certificate.clearance_m` is a number where something is restricted", ""
        fault = None if claimed is None else far_enough(plan.ground, curve, float(claimed))
        if fault:
            return f"`certificate.clearance_m` {fault}", ""
        sets, _ = _layers(plan, curve, proof, alone=True)
        letters = [{int(plan.labelling.letter_of[t]) for t in each} for each in sets]
        sure = [next(iter(each)) for each in letters if len(each) == 1]
        word = [sorted(plan.labelling.letters[letter]) for letter, _ in groupby(sure)]
        if word != proof["word"]:
            return f"`certificate.word` is not {word}", ""
        told.append("nothing restricted" if claimed is None else f"{claimed:.3f} m from what is restricted")
    return None, ", ".join(told)


def pieces_of(proof: Mapping[str, Any]) -> tuple[FloatArray, Sets]:
    """The ends of the pieces of a certificate, and their sets; a piece may be an instant."""
    knots, sets = np.array(proof["knots_s"], dtype=np.float64), proof["possible"]
    if len(knots) != len(sets) + 1 or not all(sets) or (np.diff(knots) < 0.0).any():
        raise ValueError("`certificate.possible` names triangles for each piece, one after the other")
    return knots, sets


def _layers(
    plan: Written, curve: Patches, proof: Mapping[str, Any], *, alone: bool = False
) -> tuple[Sets, tuple[int, int] | None]:
    """The sets of a proof with those of the place where the curve begins and of that where it ends; and its lap."""
    knots, sets = pieces_of(proof)
    half = plan.spec.flight.tube_m + plan.ground.slack_m
    ends = curve.at(np.array([0.0, curve.ends_s[-1]]))
    which, triangles, _ = plan.ground.met(shapely.box(*(ends - half).T, *(ends + half).T))
    begin, end = (sorted(set(triangles[which == i].tolist()) & set(each)) for i, each in ((0, sets[0]), (1, sets[-1])))
    if plan.lap is None or alone:
        return _merged([begin, *sets, end]), None
    lap_s = float(plan.starts_s[plan.lap])
    head = int(np.searchsorted(knots, lap_s * (1.0 + 1e-12), side="right")) - 1
    before = _merged([begin, *sets[: head + (abs(knots[head] - lap_s) > 1e-9 * knots[-1])]])
    after = _merged([*sets[head:], end])
    return [*before, *after], (len(before), len(before) + len(after))


def _merged(sets: Sequence[Sequence[int]]) -> Sets:
    """Equal sets that follow each other are one."""
    return [list(each) for each, _ in groupby(sorted(each) for each in sets)]
