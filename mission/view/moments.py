"""A moment of a flight as values for a page: where the vehicle is, in figures, and what it does, in words."""

import math
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any, Final

from mission.fly.result import Progress
from mission.logic.automata.automaton import BuchiAutomaton
from mission.monitor.stage import Stage
from mission.monitor.verdict import Verdict
from mission.plan import FlightPlan
from mission.printable import printable

Moment = Mapping[str, Any]
"""As ``Narrator.moment`` makes it; what is not known is None."""

_MOST_SAID: Final = 200


class Narrator:
    """Tells one moment after the other; it remembers where in the automaton the flight is.

    Attributes:
        plans: What was to be flown up to the last moment; where the mission has a place, one is made anew before it is.
    """

    def __init__(self, plan: FlightPlan) -> None:
        """Begin with a plan, before its word."""
        self.plans = [plan]
        self._states, self._read = frozenset(plan.shown_automaton.initial), 0

    @property
    def plan(self) -> FlightPlan:
        """What is flown, as of the last moment."""
        return self.plans[-1]

    def moment(self, now: Progress) -> Moment:
        """The values of a moment, all of them for JSON.

        ``t`` s of the vehicle, ``clock`` s since the trajectory began, by which regions move, ``x`` and ``y`` m,
        ``heading`` degrees clockwise from north, ``height`` m, ``speed`` m/s, ``error`` m, ``battery`` per cent,
        ``near`` m from the restricted region ``nearest``, ``left`` s, ``states`` of the shown automaton of the ``plan``
        with this number; ``doing``, ``still``, ``ahead`` are words.
        """
        if now.plan is not None and now.plan is not self.plan:
            self.plans.append(now.plan)
            self._states, self._read = frozenset(self.plan.shown_automaton.initial), 0
        for letter in now.word[self._read :]:
            self._states = _after(self.plan.shown_automaton, self._states, letter)
        self._read = len(now.word)
        east, north = now.place_m or (None, None)
        nearest, near_m = now.nearest or (None, None)
        return {
            "t": _rounded(now.t_s, 2),
            "clock": _rounded(now.since_s, 2),
            "x": _rounded(east, 3),
            "y": _rounded(north, 3),
            "heading": _rounded(None if now.heading_rad is None else math.degrees(now.heading_rad) % 360.0, 1),
            "height": _rounded(now.altitude_m, 2),
            "speed": _rounded(now.speed_m_s, 2),
            "error": _rounded(now.error_m, 3),
            "battery": _rounded(now.battery_percent, 0),
            "near": _rounded(near_m, 2),
            "nearest": None if nearest is None else printable(nearest),
            "left": _rounded(now.left_s, 0) if now.stage is Stage.FLY else None,
            "states": sorted(self._states),
            "doing": printable(doing(now, self.plan)),
            "still": printable(still(now, self.plan)),
            "ahead": printable(" → ".join(_ahead(now, self.plan)[:8])),
            "plan": len(self.plans),
        }


def doing(now: Progress, plan: FlightPlan) -> str:
    """What the vehicle does, in words."""
    if now.stage is not Stage.FLY:
        return f"{now.stage}: {now.waiting_for}"[:_MOST_SAID] if now.waiting_for else now.stage.value
    here = ", ".join(sorted(now.word[-1])) if now.word and now.word[-1] else ""
    where = f"in {here}" if here else "over open ground"
    if now.held:
        return f"holding, as was asked, {where}"
    ahead = _ahead(now, plan)
    lap = " on the last lap" if now.returning and plan.run.recurrent else ""
    return f"{where}, on the way to {ahead[0]}{lap}" if ahead else f"{where}, on the way to where it ends{lap}"


def still(now: Progress, plan: FlightPlan) -> str:
    """What the flight must still do, in words."""
    missed = [bound.text(now.since_s) for bound in now.bounds if bound.met is False]
    if missed:
        return f"in vain: {'; '.join(missed)}"
    left = [bound.text(now.since_s) for bound in now.bounds if bound.met is None]
    return "; ".join((_of_the_word(now, plan), *left))


def _of_the_word(now: Progress, plan: FlightPlan) -> str:
    """What the word must still have."""
    if now.verdict is Verdict.TRUE:
        return "nothing more: whatever follows, the mission is satisfied"
    if now.verdict is Verdict.FALSE:
        return "in vain: what was flown violates the mission"
    # Those of laps begin anew with each.
    steps = f" ({now.done} of {now.total} steps are done)" if now.total and not plan.run.recurrent else ""
    asked = "as many laps as wanted" if now.laps_asked is None else f"{now.laps_asked} laps"
    laps = f"; {now.laps} of {asked} are flown" if plan.run.recurrent else ""
    if now.awaited and now.done < now.total:
        return f"come to {' or '.join(now.awaited)}{steps}{laps}"
    return f"break no rule up to the end{steps}{laps}"


def _ahead(now: Progress, plan: FlightPlan) -> list[str]:
    """The regions that the plan still leads to, in their order; of laps, those of one from here on."""
    flown = _stops(now.word)
    loop = _stops([plan.labelling.label(triangle) for triangle in plan.run.suffix]) if plan.run.recurrent else []
    loop = loop[:-1] if len(loop) > 1 and loop[0] == loop[-1] else loop
    if flown and flown[-1] in loop:
        if now.laps_asked is not None and now.laps >= now.laps_asked:
            return []
        here = loop.index(flown[-1]) + 1
        return [*loop[here:], *loop[:here]]
    return _stops(plan.certificate.word)[len(flown) :]


def _stops(word: Sequence[frozenset[str]]) -> list[str]:
    """The labels that a word has one after the other, without open ground."""
    return [", ".join(sorted(letter)) for letter, _ in groupby(word) if letter]


def _after(automaton: BuchiAutomaton, states: frozenset[int], letter: frozenset[str]) -> frozenset[int]:
    """Where an automaton, which may guess, can be after one letter more."""
    steps = (edge.target for state in states for edge in automaton.outgoing[state] if edge.guard.allows(letter))
    return frozenset(steps)


def _rounded(value: float | None, digits: int) -> float | None:
    """A value for JSON, which knows no infinity."""
    return None if value is None or not math.isfinite(value) else round(float(value), digits)
