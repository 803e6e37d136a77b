"""What a flight must satisfy, and the automata that plan and judge it.

A mission gives a formula or names an automaton, and tasks beside either. A word satisfies it if the automaton accepts
it, where there is one, and it satisfies the formula that everything else makes together. What has bounds in seconds is
asked of the flight in time beside it: the word satisfies what of that can be said without seconds.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton, GeneralisedBuchi
from mission.logic.automata.combination import intersection, union
from mission.logic.automata.complement import complement
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.conversion import with_accepting_states
from mission.logic.automata.determined import part_of, parts_of
from mission.logic.automata.refutation import refutation
from mission.logic.automata.translate import GLANCE, translate, translate_generalised
from mission.logic.formula.conjuncts import conjuncts, separated
from mission.logic.formula.operators import Operator
from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import TRUE, Formula, conjunction
from mission.logic.formula.word import LassoWord, Letter, satisfies
from mission.logic.timed.rewriting import untimed
from mission.spec.model import MissionSpec, NamedAutomaton
from mission.spec.tasks import task_formula, timed_formula
from mission.spec.windows import as_there, kept_out_of

_REMEMBERED: Final = 8

_translated = lru_cache(maxsize=_REMEMBERED)(translate)
"""Automata for readers, which most plans of a flight have in common."""


@dataclass(frozen=True)
class Specification:
    """What a flight must satisfy. Its automata are built when they are asked for; each may raise AutomatonSizeError.

    Attributes:
        formula: The mission's formula and its tasks; TRUE where there is nothing of the kind.
        given: The automaton that the mission names; None without one.
        letters: The observations of the map; an automaton that is given is complemented over these.
        timed: Formulas with bounds in seconds, all of which the flight satisfies in time.
    """

    formula: Formula
    given: NamedAutomaton | None = None
    letters: tuple[Letter, ...] = ()
    timed: tuple[Formula, ...] = ()

    @cached_property
    def automaton(self) -> BuchiAutomaton:
        """A Büchi automaton of the words that satisfy all of it."""
        return automaton_of(self.formula, self.given)

    @cached_property
    def automata(self) -> tuple[BuchiAutomaton, ...]:
        """Büchi automata of its conjuncts, at least one: a word satisfies it if all of them accept it."""
        given = () if self.given is None else (with_accepting_states(self.given.automaton),)
        return (*given, *map(translate, separated(self.formula))) or (translate(TRUE),)

    @cached_property
    def shown(self) -> tuple[BuchiAutomaton, ...]:
        """For readers: the automaton of all of it, or where that is large, those of its conjuncts."""
        if len(self.automata) == 1:
            return self.automata
        try:
            return (automaton_of(self.formula, self.given) if self.given else _translated(self.formula, GLANCE),)
        except AutomatonSizeError:
            return self.automata

    @cached_property
    def outside(self) -> BuchiAutomaton | None:
        """One of the words over the letters of the map that the given automaton does not accept; None without one."""
        return None if self.given is None else complement(self.given.automaton, self.letters)

    @cached_property
    def refutation(self) -> BuchiAutomaton:
        """One of the words that do not satisfy it; with a given automaton, among those over the letters of the map."""
        if self.outside is None:
            return refutation(self.formula)
        return self.outside if self.formula is TRUE else union(self.outside, refutation(self.formula))

    def satisfied_by(self, word: LassoWord) -> bool:
        """Whether a word satisfies it: by the definition of LTL and by the automaton that was given, as they are."""
        return satisfies(word, self.formula) and (self.given is None or accepts(self.given, word))

    def __str__(self) -> str:
        return described(self.given, conjunction(*(each for each in (self.formula, *self.timed) if each is not TRUE)))


def formula_of(spec: MissionSpec, dropped: Iterable[int] = ()) -> Formula:
    """The mission's formula and its tasks, all at once, and as far as that can be said without seconds.

    Args:
        spec: The mission.
        dropped: Tasks that are left out, by their places in the file.

    Raises:
        FormulaSyntaxError: If the mission's own formula is none.
    """
    return of_mission(spec, (), dropped).formula


def timed_of(spec: MissionSpec, dropped: Iterable[int] = ()) -> tuple[Formula, ...]:
    """What a mission asks of a flight in time: the conjuncts of its formula that have bounds, and those of its tasks.

    What speaks of a region that is there for a time only has bounds, and such a region may be restricted.

    Args:
        spec: The mission.
        dropped: Tasks that are left out, by their places in the file.

    Raises:
        FormulaSyntaxError: If the mission's own formula is none.
    """
    return of_mission(spec, (), dropped).timed


def _own_parts(spec: MissionSpec) -> tuple[Formula, ...]:
    """The conjuncts of the mission's own formula."""
    if not spec.formula:
        return ()
    parsed = parse_timed_formula(spec.formula, frozenset(region.name for region in spec.regions))
    parsed = as_there(parsed, spec.regions)
    return parsed.operands if parsed.operator is Operator.AND else (parsed,)


def of_mission(spec: MissionSpec, letters: tuple[Letter, ...], dropped: Iterable[int] = ()) -> Specification:
    """The specification of a mission.

    Args:
        spec: The mission.
        letters: The observations of its map.
        dropped: Tasks that are left out, by their places in the file.

    Raises:
        FormulaSyntaxError: If the mission's own formula is none.
    """
    left_out, own = frozenset(dropped), _own_parts(spec)
    tasks = [task for number, task in enumerate(spec.tasks) if number not in left_out]
    of_own = (untimed(part) if part.timed else part for part in own)
    in_words = (*of_own, *(task_formula(task, spec.regions) for task in tasks))
    formula = conjunction(*(part for part in in_words if part is not TRUE))
    of_tasks = (each for task in tasks if (each := timed_formula(task, spec.regions)) is not None)
    of_own_in_time = (part for part in own if part.timed)
    timed = tuple(dict.fromkeys((*kept_out_of(spec.regions), *of_own_in_time, *conjuncts(conjunction(*of_tasks)))))
    return Specification(formula, spec.automaton, letters, timed)


def deterministic_of(formula: Formula, given: NamedAutomaton | None, letters: tuple[Letter, ...]) -> Conjunction:
    """Deterministic automata, over the numbers of ``letters``, of a formula's conjuncts and of a given automaton.

    Raises:
        AutomatonSizeError: One of them, or all together, would be too large.
    """
    of_given = () if given is None else (part_of(given.automaton, letters),)
    return Conjunction.of((*of_given, *parts_of(formula, letters)))


def automaton_of(formula: Formula, given: NamedAutomaton | None) -> BuchiAutomaton:
    """An automaton of the words that satisfy a formula and are accepted by a given automaton, if there is one.

    Raises:
        AutomatonSizeError: It is too large to be built.
    """
    return translate(formula) if given is None else with_accepting_states(generalised_of(formula, given))


def generalised_of(formula: Formula, given: NamedAutomaton) -> GeneralisedBuchi:
    """The same with a given automaton as one with marked transitions; without a formula it is the given one.

    Raises:
        AutomatonSizeError: It is too large to be built.
    """
    return given.automaton if formula is TRUE else intersection(given.automaton, translate_generalised(formula))


def accepts(given: NamedAutomaton, word: LassoWord) -> bool:
    """Whether a mission's automaton accepts a word."""
    return with_accepting_states(given.automaton).accepts(word)


def described(given: NamedAutomaton | None, formula: Formula) -> str:
    """A formula beside a given automaton, as text."""
    if given is None:
        return str(formula)
    return f"automaton {given.file}" + ("" if formula is TRUE else f", and {formula}")
