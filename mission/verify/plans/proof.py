"""The certificate: that the triangles it names hold the tube, and what a flight among them can spell."""

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from mission.decimals import count
from mission.geometry.arrays import IntArray
from mission.logic.automata.automaton import compile_to_alphabet
from mission.logic.automata.safety import safety_of
from mission.spec.model import Semantics
from mission.spec.specification import deterministic_of
from mission.verify.plans.moving import nearer_in_time, stray_in_time
from mission.verify.plans.tube import Met, far_enough, stray
from mission.verify.plans.words import Layers, spells
from mission.verify.plans.written import Proof, Verdict, Written

Sets = list[list[int]]


def tube_holds(plan: Written) -> Verdict:
    """No triangle is met but those that are named, none of which is restricted, and the domain is not left."""
    for what, proof in zip(("the tube", "the tube of the way back"), plan.proofs, strict=False):
        closed = [t for each in proof.sets for t in each if plan.restricted[t]]
        if closed:
            names = sorted({name for t in closed for name in plan.labelling.label(t)})
            return f"its pieces name triangles of {' and '.join(names)}, which must not be entered", ""
        claim = plan.spec.flight.tube_m, proof.knots_s, proof.sets
        if plan.moving is None:
            fault = stray(plan.ground, proof.curve, *claim)
        else:
            fault = stray_in_time(plan.moving, plan.legs_of(proof), *claim)
        if fault:
            return f"{what} {fault}", ""
        drift_m = float(proof.data["landing_m"])
        most_m = 0.0 if plan.lap is not None and proof is plan.proofs[0] else plan.spec.flight.landing_m
        if not 0.0 <= drift_m <= most_m:
            return f"`certificate.landing_m` is {drift_m:g}, not 0 to {most_m:g}", ""
        _, there, outside = _landing(plan, proof)
        if outside.any() or plan.restricted[there].any():
            return f"a landing that drifts by {drift_m:g} m may leave the domain, or meet what must not be entered", ""
    return None, f"{count(len(plan.sets), 'piece')}, {plan.spec.flight.tube_m:g} m on each side"


def words_satisfy(plan: Written) -> Verdict:
    """Every word that can be spelled satisfies the mission, and with the way back, none violates it."""
    (laps, *back), asked = plan.proofs, plan.specification
    sets, lap = layers_of(plan, laps)
    arguments = (plan.partition, plan.labelling.letter_of)
    first = plan.spec.semantics is Semantics.STANDARD
    compiled = compile_to_alphabet(asked.refutation, plan.labelling.letters)
    landed = [] if lap else [sorted(landed_in(plan, laps).tolist())]
    if spells(Layers([*sets, *landed], lap), *arguments, compiled, reads_first=first):
        return "a flight within the tube may spell a word that violates the mission", ""
    for proof in back:
        bad = safety_of(deterministic_of(asked.formula, asked.given, asked.letters).whole).refutation()
        onward = [*layers_of(plan, proof, alone=True)[0], sorted(_landing(plan, proof)[1].tolist())]
        if spells(Layers([*sets, *onward], lap), *arguments, bad, reads_first=first):
            return "the way back may violate the mission", ""
    return None, f"{count(len(sets), 'layer')}, {count(compiled.states, 'state')} of the automaton of what is forbidden"


def far_from_restricted(plan: Written) -> Verdict:
    """The distance of the curve from what is restricted."""
    told = []
    for proof in plan.proofs:
        claimed = proof.data["clearance_m"]
        if (claimed is None) == bool(plan.restricted.any()):
            return "`certificate.clearance_m` is a number where something is restricted", ""
        fault = None if claimed is None else _distance_fault(plan, proof, float(claimed))
        if fault:
            return f"`certificate.clearance_m` {fault}", ""
        told.append("nothing restricted" if claimed is None else f"{claimed:.3f} m from what is restricted")
    return None, ", ".join(told)


def _distance_fault(plan: Written, proof: Proof, claimed_m: float) -> str | None:
    """A bound that is told of triangles that move may be far from the truth: it is made of all that they sweep."""
    if plan.moving is None:
        return far_enough(plan.ground, proof.curve, claimed_m)
    return nearer_in_time(plan.moving, plan.legs_of(proof), claimed_m)


def layers_of(plan: Written, proof: Proof, *, alone: bool = False) -> tuple[Sets, tuple[int, int] | None]:
    """The sets of a proof with those of the place where the curve begins and of that where it ends; and its lap."""
    knots, sets, tube_m = proof.knots_s, proof.sets, plan.spec.flight.tube_m
    begin = sorted(set(plan.begin_met(proof, tube_m)[1].tolist()) & set(sets[0]))
    end = ended_in(plan, proof).tolist()
    repeats = plan.lap is not None and proof is plan.proofs[0]
    if plan.moving is None or repeats:  # else others may come there later
        end = sorted(set(end) & set(sets[-1]))
    if plan.lap is None or alone:
        return _merged([begin, *sets, end]), None
    lap_s = float(plan.starts_s[plan.lap])
    head = int(np.searchsorted(knots, lap_s * (1.0 + 1e-12), side="right")) - 1
    before = _merged([begin, *sets[: head + (abs(knots[head] - lap_s) > 1e-9 * knots[-1])]])
    after = _merged([*sets[head:], end])
    return [*before, *after], (len(before), len(before) + len(after))


def ended_in(plan: Written, proof: Proof) -> IntArray:
    """The triangles in which a vehicle may be that comes to rest where the curve of a proof ends."""
    return plan.end_met(proof, plan.spec.flight.tube_m)[1]


def landed_in(plan: Written, proof: Proof) -> IntArray:
    """The triangles in which a vehicle may be that lands where the curve of a proof ends."""
    return _landing(plan, proof)[1]


def _landing(plan: Written, proof: Proof) -> Met:
    """What is met where the curve of a proof ends while the vehicle lands there."""
    return plan.end_met(proof, plan.spec.flight.tube_m + float(proof.data["landing_m"]))


def _merged(sets: Sequence[Sequence[int]]) -> Sets:
    """Equal sets that follow each other are one."""
    return [list(each) for each, _ in groupby(sorted(each) for each in sets)]
