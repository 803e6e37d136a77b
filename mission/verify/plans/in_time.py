"""The bounds in seconds that a plan claims to keep, judged on the pieces of its certificate and the time of each."""

from fractions import Fraction

import numpy as np

from mission.decimals import count
from mission.logic.formula.word import Letter
from mission.logic.timed.behaviour import Behaviour, Piece, behaviour_of, from_to, staying
from mission.logic.timed.margins import STEP_S, margin_s
from mission.verify.plans.proof import landed_in
from mission.verify.plans.written import Proof, Verdict, Written

_LEAST_S = 0.05
"""What a bound has to spare, s: a flight keeps to the clock of its trajectory to no less."""

_ROUNDING_S = 2.0 * float(STEP_S)


def bounds_kept(plan: Written) -> Verdict:
    """Each formula with bounds holds on every flight within the tube, with the margin that is claimed."""
    asked, claimed = plan.specification.timed, plan.data.get("bounds", [])
    if [str(each) for each in asked] != [each["formula"] for each in claimed]:
        return "`bounds` are not those that its mission asks for", ""
    if not asked:
        return None, "none is asked for"
    flown, least_s = _behaviour(plan, plan.proofs[0]), np.inf
    for formula, claim in zip(asked, claimed, strict=True):
        margin = margin_s(flown, formula)
        told = np.inf if claim["margin_s"] is None else float(claim["margin_s"])
        if not margin >= _LEAST_S - _ROUNDING_S:
            return f"a flight within the tube may violate {formula}", ""
        if not (margin == told or abs(margin - told) <= _ROUNDING_S):
            return f"{formula} is kept with {margin:.3f} s to spare, and not {told:.3f} s", ""
        least_s = min(least_s, margin)
    spare = "whatever time it takes" if least_s == np.inf else f"{least_s:.2f} s to spare at least"
    return None, f"{count(len(asked), 'bound')}, {spare}"


def _behaviour(plan: Written, proof: Proof) -> Behaviour:
    """What every flight does that is in one of the triangles of a piece while that is flown."""
    times = [_time_s(plan, s) for s in proof.knots_s.tolist()]
    last_s = times[-1]
    pieces = [
        Piece(from_to(begin, end, closed=True), *_letters(plan, each))
        for begin, end, each in zip(times, times[1:], proof.sets, strict=False)
    ]
    if plan.lap is None:
        landed = Piece(from_to(last_s, last_s + 1, closed=True), *_letters(plan, landed_in(plan, proof).tolist()))
        return staying([*pieces, landed])
    loop_s = _time_s(plan, float(plan.starts_s[plan.lap]), after=True)
    return behaviour_of(pieces, loop_s, loop_s + Fraction(plan.laws[plan.lap].duration_s))


def _time_s(plan: Written, s: float, *, after: bool = False) -> Fraction:
    """When a place on the curve is reached, with one lap; where two legs meet, by the one that ``after`` says."""
    begun = plan.starts_s <= s if after else plan.starts_s < s
    leg = int(np.clip(np.count_nonzero(begun) - 1, 0, len(plan.laws) - 1))
    before_s = sum((Fraction(law.duration_s) for law in plan.laws[:leg]), Fraction(0))
    own = min(max(s - float(plan.starts_s[leg]), 0.0), plan.laws[leg].place_s)
    return before_s + (Fraction(float(plan.laws[leg].times_s(np.array([own]))[0])) if own else 0)


def _letters(plan: Written, triangles: list[int]) -> tuple[Letter, Letter]:
    """The propositions of all of some triangles, and of one of them."""
    labels = [plan.labelling.label(triangle) for triangle in triangles]
    return frozenset.intersection(*labels), frozenset.union(*labels)
