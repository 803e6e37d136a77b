"""From formulas to small Büchi automata.

Of each formula there are candidates: the tableau made small by simulation, and a deterministic automaton. An obligation
has a smallest one, which is found directly; for every other formula it is looked for on the structure of what can
remain of the formula. Each candidate is brought to accepting states in several ways, and the smallest result wins;
among those of one size a deterministic one, then the one with fewest edges. Nothing depends on chance, on hashes or on
time.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice, permutations
from typing import Final, TypeVar

from mission.errors import AutomatonSizeError
from mission.logic.automata.anticipation import anticipated
from mission.logic.automata.automaton import BuchiAutomaton, GeneralisedBuchi
from mission.logic.automata.degeneralisation import degeneralised, with_few_mixed_states
from mission.logic.automata.deterministic import accepting_like
from mission.logic.automata.diagrams import Diagram, Diagrams, TooLargeError
from mission.logic.automata.progression import Progression
from mission.logic.automata.simulation import reduced
from mission.logic.automata.structure import Structure, pruned, state_based, transition_based
from mission.logic.automata.tableau import Tableau
from mission.logic.automata.weak import cycles_disagree, is_obligation, is_persistence, refined, renamed, weak_structure
from mission.logic.formula.rewriting import simplified
from mission.logic.formula.syntax import Formula, negation, proposition_order

MAX_STATES: Final = 20_000
"""States of an automaton under construction at which the translation gives up."""

MAX_DEPTH: Final = 200
"""Depth of a formula that is translated."""

MAX_PROPOSITIONS: Final = 100
"""Propositions of a formula that is translated."""

_GROWTH_OF_EXTRAS: Final = 200_000  # and for each attempt at something smaller
_WORK_OF_EXTRAS: Final = 2_000_000
_LIMIT_OF_EXTRAS: Final = 1_000  # states of automata that serve only to find a smaller one
_LIMIT_OF_PRODUCTS: Final = 10_000
_LARGE: Final = 16  # states from which on only what is sure to be worth while is tried
_SMALL: Final = 3  # states of a minimal automaton up to which a nondeterministic one is not tried
_CYCLES: Final = 400
_FEW_SETS: Final = 3  # acceptance sets of which all orders are tried

_T = TypeVar("_T")


@dataclass(frozen=True)
class Bounds:
    """At what a translation gives up.

    Attributes:
        states: States of an automaton under construction.
        edges: Pairs of states with a transition from the one to the other, likewise.
        growth: Nodes of diagrams for what is necessary.
        work: Comparisons of clauses in a tableau that is necessary.
    """

    states: int
    edges: int
    growth: int
    work: int


FULL: Final = Bounds(MAX_STATES, 1_000_000, 1_000_000, 20_000_000)
"""For an automaton that is needed."""

SHOWN: Final = replace(FULL, edges=50_000, growth=300_000)
"""For one that a person waits for."""

GLANCE: Final = Bounds(200, 10_000, 20_000, 300_000)
"""For one that is good to have where it costs little."""


def translate(formula: Formula, bounds: Bounds = FULL) -> BuchiAutomaton:
    """A Büchi automaton that accepts exactly the words that satisfy ``formula``.

    Raises:
        AutomatonSizeError: The formula or its automaton is too large to be built.
    """
    return _Translation(formula, bounds).state_based()


def translate_generalised(formula: Formula, bounds: Bounds = FULL) -> GeneralisedBuchi:
    """The same as a generalised Büchi automaton with marked transitions, often much smaller.

    Raises:
        AutomatonSizeError: The formula or its automaton is too large to be built.
    """
    return _Translation(formula, bounds).generalised()


@dataclass
class _Translation:
    """The translation of one formula, over one pool of diagrams."""

    formula: Formula
    bounds: Bounds = FULL

    def __post_init__(self) -> None:
        self._names = proposition_order(self.formula)
        if self.formula.depth > MAX_DEPTH:
            raise AutomatonSizeError(f"the formula is nested deeper than {MAX_DEPTH}")
        if len(self._names) > MAX_PROPOSITIONS:
            raise AutomatonSizeError(f"the formula has more than {MAX_PROPOSITIONS} propositions")
        self._short = simplified(self.formula)

    def state_based(self) -> BuchiAutomaton:
        best: tuple[tuple[int, bool, int], Structure] | None = None
        for candidate in self._candidates():
            if best is not None and candidate.size > best[0][0]:
                continue
            candidate.diagrams.allow(self.bounds.growth)
            with suppress(TooLargeError):
                for form in _state_based_forms(candidate, self.bounds.edges):
                    rank = (form.size, not form.deterministic, form.edge_count)
                    if best is None or rank < best[0]:
                        best = rank, form
        if best is None:
            raise self._too_large()
        try:
            best[1].diagrams.allow(self.bounds.growth)
            return state_based(best[1])
        except TooLargeError as error:
            raise self._too_large() from error

    def generalised(self) -> GeneralisedBuchi:
        candidates = self._candidates()
        if not candidates:
            raise self._too_large()
        best = min(candidates, key=lambda candidate: (candidate.size, candidate.sets, candidate.edge_count))
        try:
            best.diagrams.allow(self.bounds.growth)
            return transition_based(best)
        except TooLargeError as error:
            raise self._too_large() from error

    def _too_large(self) -> AutomatonSizeError:
        most = f"{self.bounds.states:,} states, {self.bounds.edges:,} edges or too many letters"
        return AutomatonSizeError(f"the automaton of the formula has more than {most}")

    def _candidates(self) -> list[Structure]:
        """Small generalised automata of the formula, smallest first; none where all would be too large."""
        found = self._obligation() if is_obligation(self._short) else self._general()
        return sorted(found, key=lambda structure: structure.size)

    def _obligation(self) -> Iterator[Structure]:
        diagrams = Diagrams()
        diagrams.allow(self.bounds.growth)
        limit = self.bounds.states
        with suppress(TooLargeError):
            progression = Progression(diagrams, self._names)
            minimal = pruned(weak_structure(progression, diagrams, self._names, self._short, self.bounds.states))
            yield minimal
            if minimal.size <= _SMALL:
                return
            limit = max(minimal.size // 2, 4 * _LARGE)
        # A nondeterministic automaton can be smaller, even exponentially, as for F (a & X X X X b).
        diagrams = Diagrams()
        diagrams.allow(_GROWTH_OF_EXTRAS)
        with suppress(TooLargeError):
            yield self._tableau(diagrams, self._short, limit, _WORK_OF_EXTRAS)

    def _general(self) -> Iterator[Structure]:
        diagrams = Diagrams()
        diagrams.allow(self.bounds.growth)
        with suppress(TooLargeError):
            positive = self._tableau(diagrams, self._short, self.bounds.states, self.bounds.work)
            yield positive
            if positive.size > 1:
                diagrams.allow(_GROWTH_OF_EXTRAS)
                deterministic = self._deterministic(positive)
                if deterministic is not None:
                    yield deterministic

    def _tableau(self, diagrams: Diagrams, formula: Formula, limit: int, work: int) -> Structure:
        found = reduced(Tableau(diagrams, self._names, work).structure(formula, limit, self.bounds.edges))
        changed = anticipated(found)
        if changed.moves == found.moves:
            return found
        return min(found, reduced(changed), key=lambda structure: structure.size)

    def _deterministic(self, positive: Structure) -> Structure | None:
        """A deterministic automaton on a structure of what can remain of the formula, if one is found."""
        diagrams = positive.diagrams
        progression = Progression(diagrams, self._names)
        start = progression.state(self._short)
        if is_persistence(self._short):
            everything = (1 << len(self._names)) - 1
            ones = [1 << bit for bit in range(len(self._names))]
            letters = [0, everything, *_spread([letter ^ other for letter in ones for other in (0, everything)], 64)]
            if cycles_disagree(progression, diagrams, start, letters, _CYCLES):
                return None  # it is no obligation, and so there is none
        negative = self._tableau(diagrams, simplified(negation(self._short)), _LIMIT_OF_EXTRAS, _WORK_OF_EXTRAS)
        states, rows = progression.explore(start, _LIMIT_OF_EXTRAS)
        for classes in _guesses(progression, diagrams, states, rows):
            first: dict[int, int] = {}
            for state, number in enumerate(classes):
                first.setdefault(number, state)
            if positive.deterministic and len(first) >= max(positive.size, _LARGE):
                return None  # what was found is as small, and the more states the more this costs
            merged = renamed(diagrams, [rows[state] for state in first.values()], classes)
            found = accepting_like(merged, positive, negative, _LIMIT_OF_PRODUCTS)
            if found is not None:
                return reduced(found)
        return None


def _guesses(
    progression: Progression, diagrams: Diagrams, states: Sequence[Diagram], rows: Sequence[Diagram]
) -> Iterator[list[int]]:
    """Classes of states that may be of one language each, from few to many.

    States of one class agree on all words that repeat some short cycles, whatever comes before these.
    """
    letters = list(dict.fromkeys(cube[0] for row in rows for cube, _ in islice(diagrams.paths(row), _CYCLES)))
    budget = max(8, min(_CYCLES, 100_000 // len(states)))
    singles = [(letter,) for letter in _spread(letters, budget)]
    pairs = list(permutations(_spread(letters, 16), 2))
    known = 0
    for cycles in (singles, singles + _spread(pairs, budget)):
        truths = [progression.truth_on_cycle(cycle) for cycle in cycles]
        agreed = [tuple(diagrams.evaluate(state, truth) for truth in truths) for state in states]
        classes = refined(diagrams, rows, agreed)
        if max(classes) > known:
            known = max(classes)
            yield classes
    if len(states) > known + 1:
        yield list(range(len(states)))


def _spread(values: Sequence[_T], number: int) -> list[_T]:
    """At most ``number`` of the values, evenly spread over them."""
    step = max(1, -(-len(values) // number))
    return list(values[::step])


def _bounded(structure: Structure, edges: int) -> Structure:
    if structure.edge_count > edges:
        raise TooLargeError
    return structure


def _state_based_forms(structure: Structure, edges: int) -> Iterator[Structure]:
    """Equivalent structures whose states accept, found in several ways.

    Raises:
        TooLargeError: One has more than ``edges`` edges.
    """
    if _bounded(structure, edges).accepting_by_state:
        yield structure
        if structure.deterministic:
            return
    ascending = tuple(range(structure.sets))
    orders = [ascending]
    if structure.size < _LARGE:
        orders = list(permutations(ascending)) if structure.sets <= _FEW_SETS else [ascending, ascending[::-1]]
    for order in orders:
        current = structure
        if structure.sets != 1:
            current = reduced(_bounded(degeneralised(structure, order), edges))
            yield current
        if current.sets == 1:
            states = range(current.size)
            for chosen in (states, states[::-1]) if current.size < _LARGE else (states,):
                yield reduced(degeneralised(with_few_mixed_states(current, chosen), (0,)))
