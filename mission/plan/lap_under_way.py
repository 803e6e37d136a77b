"""What is left of a lap that is under way when a flight is planned anew: each visit once, none twice.

A lap is what its regions are to the automaton of the mission: labels that leave it as it is, as the bare ground does,
are no part of it. What the lap has not met is visited before the laps that are left; what it has met already is kept
out of until then, but where the vehicle is in it, if there is such a way.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from mission.logic.formula.syntax import Formula, conjunction, eventually, negation, proposition, propositions, until
from mission.logic.formula.word import Letter
from mission.plan.flight_plan import FlightPlan


def visits_due(plan: FlightPlan, due: Sequence[Letter], under_way: Sequence[str]) -> tuple[frozenset[str], ...]:
    """The visits that a lap still lacks, each as the regions in which the vehicle is at once.

    Args:
        plan: Whose lap it is.
        due: The labels that the lap has not met.
        under_way: Regions that are not yet covered, or stood in, as they ask to be.
    """
    asked = _asked(plan)
    visits = [asked[label] for label in due if asked.get(label)]
    visits += [frozenset((name,)) for name in under_way if not any(name in visit for visit in visits)]
    return tuple(dict.fromkeys(visits))


def done_first(plan: FlightPlan, visits: Sequence[frozenset[str]]) -> Iterator[Formula]:
    """That the visits of a lap that are due come, and before those none that it had already."""
    others = frozenset().union(*_asked(plan).values()).difference(*visits)
    for visit in visits:
        there = conjunction(*map(proposition, sorted(visit)))
        yield eventually(there)
        for name in sorted(others):
            once = proposition(name)
            yield until(once, until(negation(once), there))


def come(visits: Sequence[frozenset[str]]) -> Iterator[Formula]:
    """That visits come, in any order."""
    return (eventually(conjunction(*map(proposition, sorted(visit)))) for visit in visits)


def _asked(plan: FlightPlan) -> dict[Letter, frozenset[str]]:
    """The labels of a plan's loop that do something to its automaton, with the regions that this asks for."""
    letters, whole, given = plan.labelling.letters, plan.deterministic, plan.required.given
    asked = propositions(plan.required.formula).union(() if given is None else given.automaton.propositions)
    does = np.concatenate((whole.targets, whole.marks))
    bare = does[:, [letters.index(frozenset())]] if frozenset() in letters else np.full((len(does), 1), -2)
    found = np.unique(plan.labelling.letter_of[list(plan.run.suffix)])
    return {letters[number]: letters[number] & asked for number in found if (does[:, [number]] != bare).any()}
