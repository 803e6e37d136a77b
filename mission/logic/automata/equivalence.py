"""Whether two automata accept the same words, and a word that tells them apart where they do not."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton, GeneralisedBuchi, compile_to_alphabet
from mission.logic.automata.combination import intersection, over
from mission.logic.automata.complement import complement
from mission.logic.automata.conversion import with_accepting_states, with_marked_transitions
from mission.logic.automata.diagrams import Diagram, Diagrams, TooLargeError
from mission.logic.automata.translate import translate_generalised
from mission.logic.formula.syntax import Formula, negation
from mission.logic.formula.word import LassoWord, Letter

MAX_LETTERS: Final = 4096
"""Letters that the labels of two automata tell apart."""

_GROWTH: Final = 1_000_000  # nodes of diagrams for the labels


@dataclass(frozen=True)
class Language:
    """A set of words by an automaton, and the rest by another one.

    Attributes:
        inside: Accepts exactly these words.
        outside: From letters to an automaton of the other words over these.
    """

    inside: GeneralisedBuchi
    outside: Callable[[tuple[Letter, ...]], GeneralisedBuchi]

    @staticmethod
    def of_formula(formula: Formula) -> "Language":
        """The words that satisfy a formula."""
        return Language(translate_generalised(formula), lambda _: translate_generalised(negation(formula)))

    @staticmethod
    def of_automaton(automaton: GeneralisedBuchi) -> "Language":
        """The words that an automaton accepts."""
        return Language(automaton, lambda letters: with_marked_transitions(complement(automaton, letters)))


def telling_word(one: Language, other: Language) -> LassoWord | None:
    """A word that is in one of two languages and not in the other; None where they are the same.

    Raises:
        AutomatonSizeError: The question is too large.
    """
    letters = told_apart((one.inside, other.inside))
    for left, right in ((one, other), (other, one)):
        both = intersection(left.inside, right.outside(letters))
        word = _accepted(with_accepting_states(both), letters)
        if word is not None:
            return word
    return None


def told_apart(automata: Iterable[GeneralisedBuchi]) -> tuple[Letter, ...]:
    """One letter for each class of letters that the guards of automata do not tell from each other.

    Raises:
        AutomatonSizeError: They are more than ``MAX_LETTERS``.
    """
    machines = tuple(automata)
    names = tuple(dict.fromkeys(name for machine in machines for name in machine.propositions))
    diagrams = Diagrams()
    diagrams.allow(_GROWTH)
    classes: list[Diagram] = [diagrams.true]
    try:
        for guard in dict.fromkeys(edge.guard for machine in machines for edge in machine.edges):
            allowed = diagrams.any_of(map(diagrams.cube, over(names, guard).cubes))
            halves = [diagrams.both(part, half) for part in classes for half in (allowed, diagrams.neither(allowed))]
            classes = [half for half in halves if half != diagrams.false]
            if len(classes) > MAX_LETTERS:
                raise _too_large()
    except TooLargeError as error:
        raise _too_large() from error
    return tuple(
        frozenset(name for bit, name in enumerate(names) if holds >> bit & 1)
        for holds in (
            next(holds for (holds, _), end in diagrams.paths(part) if end == diagrams.true) for part in classes
        )
    )


def _too_large() -> AutomatonSizeError:
    return AutomatonSizeError(f"the labels of the two tell more than {MAX_LETTERS} letters apart")


def _accepted(automaton: BuchiAutomaton, letters: tuple[Letter, ...]) -> LassoWord | None:
    """A short word over some letters that an automaton accepts; None where there is none."""
    compiled = compile_to_alphabet(automaton, letters)
    steps: list[list[tuple[int, int]]] = [[] for _ in range(compiled.states)]
    for source, letter, target in zip(
        compiled.sources.tolist(), compiled.letters.tolist(), compiled.targets.tolist(), strict=True
    ):
        steps[source].append((letter, target))
    ways = _ways(steps, compiled.initial.tolist())
    for state, prefix in ways.items():  # the nearest first
        if compiled.accepting[state]:
            for letter, target in steps[state]:
                rest = _ways(steps, [target]).get(state)
                if rest is not None:
                    return _shortest([letters[i] for i in prefix], [letters[i] for i in (letter, *rest)])
    return None


def _ways(steps: Sequence[Sequence[tuple[int, int]]], sources: Iterable[int]) -> dict[int, tuple[int, ...]]:
    """The letters of a shortest way from the sources to each state that they reach, the nearest states first."""
    found: dict[int, tuple[int, ...]] = dict.fromkeys(sources, ())
    queue = list(found)
    for state in queue:
        for letter, target in steps[state]:
            if target not in found:
                found[target] = (*found[state], letter)
                queue.append(target)
    return found


def _shortest(prefix: list[Letter], suffix: list[Letter]) -> LassoWord:
    """The word without letters that are written twice."""
    while prefix and prefix[-1] == suffix[-1]:
        suffix.insert(0, suffix.pop())
        prefix.pop()
    lengths = (length for length in range(1, len(suffix) + 1) if len(suffix) % length == 0)
    length = next(length for length in lengths if suffix == suffix[:length] * (len(suffix) // length))
    return LassoWord(tuple(prefix), tuple(suffix[:length]))
