"""The bounds in seconds that a plan claims to keep, judged on the pieces of its certificate and the time of each."""

import math
from fractions import Fraction

import numpy as np

from mission.decimals import count
from mission.logic.formula.word import Letter
from mission.logic.timed.behaviour import Behaviour, Piece, behaviour_of, from_to, staying
from mission.logic.timed.margins import STEP_S, margin_s
from mission.spec.air_time import air_s, longest_text
from mission.spec.model import UNTIL_STOPPED
from mission.verify.plans.proof import ended_in, landed_in
from mission.verify.plans.written import Proof, Verdict, Written

_LEAST_S = 0.05
"""What a bound has to spare, s: a flight keeps to the clock of its trajectory to no less."""

_ROUNDING_S = 2.0 * float(STEP_S)


def bounds_kept(plan: Written) -> Verdict:
    """Each formula with bounds holds on every flight within the tube, with the margin that is claimed."""
    asked, longest_s = plan.specification.timed, plan.spec.flight.longest_s
    flown = _behaviour(plan, plan.proofs[0]) if asked else None
    found = [(str(formula), margin_s(flown, formula), _LEAST_S) for formula in asked if flown is not None]
    if longest_s is not None:
        found.append((longest_text(longest_s), longest_s - air_s(plan.spec.flight.altitude_m, _duration_s(plan)), 0.0))
    claimed = plan.data.get("bounds", [])
    if [name for name, *_ in found] != [each["formula"] for each in claimed]:
        return "`bounds` are not those that its mission asks for", ""
    if not found:
        return None, "none is asked for"
    least_s = np.inf
    for (formula, margin, enough_s), claim in zip(found, claimed, strict=True):
        told = np.inf if claim["margin_s"] is None else float(claim["margin_s"])
        if not margin >= enough_s - _ROUNDING_S:
            return f"a flight within the tube may violate {formula}", ""
        if not (margin == told or abs(margin - told) <= _ROUNDING_S):
            return f"{formula} is kept with {margin:.3f} s to spare, and not {told:.3f} s", ""
        least_s = min(least_s, margin)
    spare = "whatever time it takes" if least_s == np.inf else f"{least_s:.2f} s to spare at least"
    return None, f"{count(len(found), 'bound')}, {spare}"


def _duration_s(plan: Written) -> float:
    """How long the trajectory takes with all its laps; infinite where nobody says how many there are."""
    laps = plan.spec.flight.laps
    times = [1 if leg != plan.lap else math.inf if laps == UNTIL_STOPPED else laps for leg in range(len(plan.laws))]
    return sum(often * law.duration_s for often, law in zip(times, plan.laws, strict=True))


def _behaviour(plan: Written, proof: Proof) -> Behaviour:
    """What every flight does that is in one of the triangles of a piece while that is flown."""
    times = [_time_s(plan, s) for s in proof.knots_s.tolist()]
    last_s = times[-1]
    pieces = [
        Piece(from_to(begin, end, closed=True), *_letters(plan, each))
        for begin, end, each in zip(times, times[1:], proof.sets, strict=False)
    ]
    if plan.lap is None:
        at_rest = Piece(from_to(last_s, last_s, closed=True), *_letters(plan, ended_in(plan, proof).tolist()))
        landed = Piece(from_to(last_s, last_s + 1, closed=True), *_letters(plan, landed_in(plan, proof).tolist()))
        return staying([*pieces, at_rest, landed])
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
