"""Regions that are there for a time only, in planning: what is passed when they are gone, and ways round them."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

from mission.errors import AutomatonSizeError, NoPlanError, SearchSizeError
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import LONGEST_S, Formula, always, conjunction, negation, postorder, proposition
from mission.logic.timed.behaviour import Behaviour
from mission.logic.timed.rewriting import positive
from mission.plan.steered import Steering
from mission.spec.specification import Specification


def shunned(formulas: Sequence[Formula]) -> tuple[Formula, ...]:
    """The propositions that count for a time only and are denied somewhere in formulas, each once."""
    nodes = (node for formula in formulas for node in postorder(positive(formula)))
    denied = (node.operands[0] for node in nodes if node.operator is Operator.NOT)
    return tuple(dict.fromkeys(each for each in denied if each.bounds is not None))


def waits_s(formulas: Sequence[Formula], flown: Behaviour) -> tuple[Fraction, ...]:
    """After which waits a flight meets a shunned region, where it does at all, only when that is there no more, s.

    Args:
        formulas: What is asked for in time.
        flown: The flight without a wait.
    """
    found = set()
    for node in shunned(formulas):
        end_s = node.bounds[1] if node.bounds else Fraction(0)
        met = (Fraction(span[0][0]) for span in flown.of(node.name).may)
        found |= {end_s - met_s for met_s in met if met_s <= end_s < LONGEST_S}
    return tuple(sorted(found))


def around(steering: Steering) -> Iterator[Steering]:
    """The best runs that never come into what is shunned for a time, all of it or one region."""
    if not steering.free:
        return
    names = tuple(dict.fromkeys(node.name for node in shunned(steering.specification.timed)))
    for chosen in dict.fromkeys((names, *combinations(names, 1))) if names else ():
        keeping_out = [always(negation(proposition(name))) for name in chosen]
        safe = best_of(steering, asking_also(steering.specification, keeping_out))
        if safe is not None:
            yield safe


def asking_also(specification: Specification, more: Iterable[Formula]) -> Specification:
    """A specification that asks for some formulas more."""
    return replace(specification, formula=conjunction(specification.formula, *more))


def best_of(steering: Steering, specification: Specification) -> Steering | None:
    """The best runs that satisfy another specification; None where there are none."""
    try:
        found = steering.search.best(specification)
    except (NoPlanError, AutomatonSizeError, SearchSizeError):
        return None
    return replace(steering, specification=specification, found=found, index=0)
