"""Why a mission has no plan: the smallest set of its parts that cannot be met, and what stands against them.

The parts are the conjuncts of the formula, the automaton that the mission names, if it does, and, for each restricted
region, that it is never entered. A smallest set of
them that no flight meets is explained by the weakest assumption that suffices: the parts contradict themselves; they
ask for regions together, or apart, that are not so on the map; the start violates them; a region cannot be reached; or
they contradict the map in another way.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Final

import numpy as np

from mission.errors import AutomatonSizeError
from mission.geometry.arrays import BoolArray
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD, Rabin, everything
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import (
    TRUE,
    Formula,
    always,
    conjunction,
    negation,
    postorder,
    proposition,
    proposition_order,
)
from mission.logic.formula.word import LassoWord, Letter, satisfies
from mission.plan.coarse_map import CoarseMap
from mission.plan.core import Core, smallest_core
from mission.plan.missing_letters import (
    Missing,
    accepts_nothing,
    accepts_something,
    missing_letter,
)
from mission.planning.product import Product
from mission.planning.refusal import refusal
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import NamedAutomaton, Semantics
from mission.spec.specification import accepts, automaton_of, described, deterministic_of

MAX_WORK: Final = 5_000_000
"""Transitions that are looked at for all questions together: states of automata times edges of the map."""


class Cause(StrEnum):
    """What the parts of the specification contradict."""

    THEMSELVES = "themselves"
    LABELS = "labels"
    START = "start"
    UNREACHABLE = "unreachable"
    MAP = "map"
    CLEARANCE = "clearance"


@dataclass(frozen=True)
class Diagnosis:
    """Why there is no plan.

    Attributes:
        cause: What stands against the parts.
        conjuncts: The conjuncts that cannot be met together, as text.
        restricted: The restricted regions that have a part in it.
        regions: The regions that cannot be reached (UNREACHABLE) or not together (LABELS).
        smallest: Whether no smaller set of parts is impossible.
        text: The explanation, in lines.
    """

    cause: Cause
    conjuncts: tuple[str, ...]
    restricted: tuple[str, ...]
    regions: tuple[str, ...]
    smallest: bool
    text: str


@dataclass(frozen=True)
class Part:
    """A part of the specification.

    Attributes:
        formula: What it asks for; TRUE where that is an automaton.
        restricted: The region that it keeps the vehicle out of because of its kind; empty for a conjunct.
        origin: Where a conjunct comes from, if not from the formula; may be empty.
        given: The automaton that it asks for; None for a formula.
    """

    formula: Formula
    restricted: str = ""
    origin: str = ""
    given: NamedAutomaton | None = None

    @property
    def barrier(self) -> str:
        """The region that the vehicle is kept out of, whatever it does; empty where the part does not say that."""
        if self.formula.operator is Operator.ALWAYS and self.formula.operands[0].operator is Operator.NOT:
            return self.formula.operands[0].operands[0].name
        return ""

    def met_by(self, word: LassoWord) -> bool:
        """Whether a word is as it asks for."""
        return satisfies(word, self.formula) if self.given is None else accepts(self.given, word)

    @property
    def written(self) -> str:
        """What it asks for, as text."""
        return described(self.given, self.formula)

    @property
    def quoted(self) -> str:
        """A conjunct within a sentence."""
        if self.given is not None:
            return f"the {self.written}"
        return f"`{self.written}`" + (f" ({self.origin})" if self.origin else "")

    def __str__(self) -> str:
        if self.restricted:
            return f"{self.restricted} is restricted: it is never entered"
        return f"{self.written}" + (f"  ({self.origin})" if self.origin else "")


def parts_of(
    formula: Formula, restricted: Iterable[str], origins: Mapping[Formula, str], given: NamedAutomaton | None = None
) -> tuple[Part, ...]:
    """The automaton, the conjuncts, then the restricted regions that no conjunct keeps the vehicle out of already."""
    automata = () if given is None else (Part(TRUE, given=given),)
    written = conjuncts(formula)
    kept_out = {name: always(negation(proposition(name))) for name in restricted}
    implicit = (Part(avoidance, name) for name, avoidance in kept_out.items() if avoidance not in written)
    return (*automata, *(Part(conjunct, origin=origins.get(conjunct, "")) for conjunct in written), *implicit)


def diagnose(
    formula: Formula,
    system: TransitionSystem,
    restricted: Iterable[str],
    start: int,
    semantics: Semantics,
    *,
    given: NamedAutomaton | None = None,
    origins: Mapping[Formula, str] | None = None,
) -> Diagnosis | None:
    """Explain why no run satisfies a specification.

    Args:
        formula: The specification, or what it asks for beside the automaton.
        system: T with every facet open, those of restricted triangles too.
        restricted: Names of the restricted regions.
        start: The start triangle, in none of them.
        semantics: Whether the label of the start is read.
        given: The automaton that the mission names; None without one.
        origins: Where conjuncts come from, in words, of those that the user did not write so.

    Returns:
        None where a run exists, or the question is too large.
    """
    question = _Question(parts_of(formula, restricted, origins or {}, given), system, start, semantics)
    core = smallest_core(len(question.parts), question.met_with)
    if core is None:
        return None
    return _Explanation(question, core).diagnosis()


class _Question:
    """Which parts can be met together on a map."""

    def __init__(self, parts: tuple[Part, ...], system: TransitionSystem, start: int, semantics: Semantics) -> None:
        self.parts, self.system, self.start, self.semantics = parts, system, start, semantics
        # An automaton, too, may count triangles.
        counts = any(
            part.given is not None or node.operator is Operator.NEXT
            for part in parts
            for node in postorder(part.formula)
        )
        self.map = CoarseMap.of(system, start, keeps_triangles=counts)
        self._work = 0

    def met_with(self, members: tuple[int, ...]) -> int | None:
        """The parts that a flight meets which meets ``members``, as bits; None where there is no such flight.

        Raises:
            AutomatonSizeError: The question, with those that were asked before, is too much work.
        """
        chosen = [self.parts[member] for member in members]
        asked = (rabin for member in members for rabin in self._automata[member])
        whole = Conjunction.of([*asked] or [everything(len(self.map.letters))]).whole
        self._work += self.map.edges(whole)
        if self._work > MAX_WORK:
            raise AutomatonSizeError(f"to say why takes more than {MAX_WORK:,} transitions")
        word = self.map.word(whole, self.closed(chosen), self.semantics)
        if word is None:
            return None
        return sum(1 << i for i, part in enumerate(self.parts) if part.met_by(word))

    def closed(self, parts: Sequence[Part]) -> BoolArray:
        """(N,) the nodes of the map that restricted regions among ``parts`` close."""
        return self.map.closed(frozenset(part.restricted for part in parts))

    @cached_property
    def _automata(self) -> tuple[tuple[Rabin, ...], ...]:
        """Deterministic automata of each part over the letters of the map; none of a region that closes triangles."""
        return tuple(
            () if part.restricted else deterministic_of(part.formula, part.given, self.map.letters).parts
            for part in self.parts
        )


def _required(parts: Iterable[Part]) -> tuple[Formula, NamedAutomaton | None]:
    """What all parts ask for: a formula, and an automaton if one of them is."""
    chosen = tuple(parts)
    given = next((part.given for part in chosen if part.given is not None), None)
    return conjunction(*(part.formula for part in chosen)), given


class _Explanation:
    """What to say of a core."""

    def __init__(self, question: _Question, core: Core) -> None:
        self._question, self._core = question, core
        self._parts = [question.parts[member] for member in core.members]

    def diagnosis(self) -> Diagnosis:
        if self._whole.initial == DEAD:
            return self._on_any_map()
        if self._violated_at_start():
            alone = f"is already violated where the flight starts, in {self._place}"
            together = f"cannot all be met by a flight that starts in {self._place}"
            return self._of(Cause.START, self._said(alone, together))
        if self._cut_off:
            return self._of(Cause.UNREACHABLE, self._unreachable(), self._cut_off)
        return self._on_this_map()

    def _on_any_map(self) -> Diagnosis:
        """What is wrong whatever lies beside what, with the labels that there are."""
        formula, given = _required(self._parts)
        names = tuple(dict.fromkeys((*(given.automaton.propositions if given else ()), *proposition_order(formula))))
        nothing = accepts_nothing(self._over, names)
        if nothing is None:
            return self._on_this_map()
        if nothing:
            text = self._said("contradicts itself: no flight whatever satisfies it", "contradict each other")
            return self._of(Cause.THEMSELVES, text)
        missing = missing_letter(self._over, names, self._question.map.letters)
        return self._of(Cause.LABELS, self._labels(missing), missing.regions)

    def _on_this_map(self) -> Diagnosis:
        alone = f"contradicts the map: no flight from {self._place} satisfies it"
        said = self._said(alone, f"contradict the map: no flight from {self._place} meets them all")
        return self._of(Cause.MAP, f"{said}\n{self._how_far()}")

    @cached_property
    def _whole(self) -> Rabin:
        return self._over(self._question.map.letters)

    def _over(self, letters: tuple[Letter, ...]) -> Rabin:
        """A deterministic automaton of the parts."""
        return deterministic_of(*_required(self._parts), letters).whole

    def _of(self, cause: Cause, text: str, regions: tuple[str, ...] = ()) -> Diagnosis:
        written = tuple(part.written for part in self._parts if not part.restricted)
        restricted = tuple(part.restricted for part in self._parts if part.restricted)
        return Diagnosis(cause, written, restricted, regions, self._core.smallest, text)

    @cached_property
    def _place(self) -> str:
        system, start = self._question.system, self._question.start
        names = ", ".join(sorted(system.letters[int(system.letter_of[start])]))
        return f"triangle {start} ({names or 'no region'})"

    @cached_property
    def _cut_off(self) -> tuple[str, ...]:
        """Regions of the map that the parts ask for, and that no way leads to which keeps out of the others."""
        barriers = frozenset(part.barrier for part in self._parts) - {""}
        asked = frozenset[str]().union(*(self._asked_for(part) for part in self._parts))
        reached = self._question.map.reached(self._question.map.closed(barriers))
        return tuple(sorted(asked - reached - barriers))

    def _asked_for(self, part: Part) -> frozenset[str]:
        """The regions that a part may ask for; those that it cannot do without, where it is an automaton."""
        if part.given is None:
            return _asked_for(part.formula)
        automaton, letters = automaton_of(part.formula, part.given), self._question.map.letters
        return frozenset(
            name
            for name in automaton.propositions
            if not accepts_something(automaton, tuple(letter for letter in letters if name not in letter))
        )

    def _violated_at_start(self) -> bool:
        question = self._question
        if question.semantics is Semantics.PAPER:
            return False
        start = question.system.letter_of[question.start]
        return int(self._whole.targets[self._whole.initial, start]) == DEAD

    def _said(self, alone: str, together: str) -> str:
        if len(self._parts) == 1:
            return f"{self._parts[0].quoted} {alone}"
        return self._listed(f"these {together}")

    def _listed(self, head: str) -> str:
        kind = "" if self._core.smallest else " (perhaps fewer of them do)"
        return "\n".join((f"{head}{kind}:", *(f"    {part}" for part in self._parts)))

    def _labels(self, missing: Missing) -> str:
        if len(self._parts) == 1:
            return f"{self._parts[0].quoted} asks for {missing.asked}, but {missing.lacking}"
        return self._listed(f"these together ask for {missing.asked}, but {missing.lacking}")

    def _unreachable(self) -> str:
        barriers = [part.barrier for part in self._parts if part.barrier]
        them = "it" if len(self._cut_off) == 1 else "them"
        way = f"no way leads to {them}"
        if barriers:
            way = f"{_and(barriers)} {'cuts' if len(barriers) == 1 else 'cut'} {them} off"
        if others := self._other_barriers(barriers):
            way = f"{way}, and so {'does' if len(others) == 1 else 'do'} {_and(others)}"
        return self._listed(f"{_and(self._cut_off)} cannot be reached from {self._place}: {way}")

    def _other_barriers(self, known: Sequence[str]) -> list[str]:
        """Regions beside ``known`` that the whole mission keeps out of, each enough to cut off the same regions."""
        names = dict.fromkeys(part.barrier for part in self._question.parts if part.barrier)
        area = self._question.map
        cuts = {name: set(self._cut_off).isdisjoint(area.reached(area.closed(frozenset({name})))) for name in names}
        return [name for name in names if cuts[name] and name not in known]

    def _how_far(self) -> str:
        """What the refusal of the search says of the core alone."""
        question = self._question
        names = {part.restricted for part in self._parts}
        blocked = np.array([bool(names & letter) for letter in question.system.letters])[question.system.letter_of]
        successors = question.system.successors
        open_ones = np.where((successors >= 0) & ~blocked[successors], successors, -1)
        system = TransitionSystem(open_ones, question.system.letter_of, question.system.letters)
        automaton = deterministic_of(*_required(self._parts), system.letters)
        return refusal(Product(system, automaton, question.start, question.semantics))


def _and(names: Sequence[str]) -> str:
    return " and ".join(part for part in (", ".join(names[:-1]), names[-1]) if part)


def _asked_for(formula: Formula) -> frozenset[str]:
    """The propositions that stand under an even number of negations."""
    pending, seen = [(formula, True)], set[tuple[Formula, bool]]()
    while pending:
        node, positive = pending.pop()
        if (node, positive) in seen:
            continue
        seen.add((node, positive))
        if node.operator is Operator.NOT:
            pending.append((node.operands[0], not positive))
        elif node.operator is Operator.IMPLIES:
            pending.extend(((node.operands[0], not positive), (node.operands[1], positive)))
        elif node.operator is Operator.IFF:
            pending.extend((operand, either) for operand in node.operands for either in (True, False))
        else:
            pending.extend((operand, positive) for operand in node.operands)
    return frozenset(node.name for node, positive in seen if positive and node.name)
