"""Deterministic automata on a given structure: which acceptance, if any, makes it accept exactly a formula's words.

Whether a run is accepting depends on the transitions that it takes for ever. On a complete deterministic structure, the
words that violate the formula and stay within some transitions show in the product with an automaton of the negation:
each of its accepting components is a set of transitions that some such word takes for ever. Acceptance sets that are
their complements reject all these words, and it remains to be checked in the product with an automaton of the formula
that they reject no other. (Landweber's theorem and the typeness of Krishnan, Puri and Brayton, "Deterministic
omega-automata vis-a-vis deterministic Büchi automata", 1994, for generalised Büchi acceptance on transitions.)
"""

from collections.abc import Sequence
from functools import partial, reduce
from itertools import count

from mission.logic.automata.components import strong_components
from mission.logic.automata.diagrams import Diagram, Diagrams
from mission.logic.automata.structure import Moves, Structure

MAX_SETS = 10
"""Acceptance sets that are tried; a formula that needs more gets no deterministic automaton here."""


def accepting_like(rows: Sequence[Diagram], positive: Structure, negative: Structure, limit: int) -> Structure | None:
    """Acceptance sets for a deterministic structure that make it equivalent to a pair of automata.

    Args:
        rows: One diagram a state with the number of the next state on each leaf; state 0 is initial.
        positive: An automaton of the language.
        negative: An automaton of its complement, over the same pool.
        limit: States of a product at which to give up.

    Returns:
        The structure with these sets, or None where there are none or a limit was passed.
    """
    rejected = _lasting_letters(_Product(rows, negative, limit))
    if rejected is None or len(rejected) > MAX_SETS:
        return None
    product = _Product(rows, positive, limit)
    diagrams = positive.diagrams
    joined = [reduce(diagrams.either, letters, diagrams.false) for letters in zip(*rejected, strict=True)]
    if rejected and product.accepts_within(joined) is False:
        rejected = [joined]
    elif any(product.accepts_within(part) is not False for part in rejected):
        return None
    marked = [_with_marks(diagrams, row, [part[state] for part in rejected]) for state, row in enumerate(rows)]
    return Structure(diagrams, positive.propositions, 0, tuple(marked), len(rejected))


def _with_marks(diagrams: Diagrams, row: Diagram, rejected: list[Diagram]) -> Diagram:
    """The moves of a state: transition i of the sets is where ``rejected[i]`` does not hold."""
    result = diagrams.transform(row, lambda target: ((target, 0),), {})
    for index, letters in enumerate(rejected):
        added = diagrams.transform(result, partial(_marked, 1 << index), {})
        result = diagrams.choose(letters, result, added)
    return result


def _marked(bits: int, moves: Moves) -> Moves:
    return tuple((target, marks | bits) for target, marks in moves)


def _enters(members: frozenset[int], moves: Moves) -> bool:
    return any(target in members for target, _ in moves)


class _Product:
    """The product of a deterministic structure, as rows of states, with an automaton."""

    def __init__(self, rows: Sequence[Diagram], automaton: Structure, limit: int) -> None:
        self.rows = rows
        self.automaton = automaton
        self.diagrams = automaton.diagrams
        self.pairs: list[tuple[int, int]] = [(0, automaton.initial)]
        self.moves: list[Diagram] = []
        self.complete = self._explore(limit)

    def _explore(self, limit: int) -> bool:
        numbers = {self.pairs[0]: 0}
        fresh = count(1)
        known: dict[tuple[Diagram, Diagram], Diagram] = {}

        def joined(target: int, moves: Moves) -> Moves:
            found = []
            for state, marks in moves:
                pair = (target, state)
                if pair not in numbers:
                    numbers[pair] = next(fresh)
                    self.pairs.append(pair)
                found.append((numbers[pair], marks))
            return tuple(sorted(found))

        for state, other in self.pairs:
            if len(self.pairs) > limit:
                return False
            self.moves.append(self.diagrams.combine(self.rows[state], self.automaton.moves[other], joined, known))
        return True

    def accepting_components(self, moves: Sequence[Diagram]) -> list[list[int]]:
        """The components of the product with these moves in which some run is accepting."""
        value = self.diagrams.value
        transitions = [
            list(dict.fromkeys(move for leaf in self.diagrams.leaves(diagram) for move in value[leaf]))
            for diagram in moves
        ]
        successors = [list(dict.fromkeys(target for target, _ in found)) for found in transitions]
        everything = self.automaton.all_marks
        accepting = []
        for component in strong_components(successors, range(len(moves))):
            members = set(component)
            met = [marks for pair in component for target, marks in transitions[pair] if target in members]
            union = 0
            for marks in met:
                union |= marks
            if met and union == everything:
                accepting.append(component)
        return accepting

    def accepts_within(self, letters: Sequence[Diagram]) -> bool | None:
        """Whether a word that takes only these letters from each state, from some time on, is accepted by both."""
        if not self.complete:
            return None
        nothing = self.diagrams.leaf(())
        kept = [
            self.diagrams.choose(letters[state], moves, nothing)
            for (state, _), moves in zip(self.pairs, self.moves, strict=True)
        ]
        return bool(self.accepting_components(kept))


def _lasting_letters(product: _Product) -> list[list[Diagram]] | None:
    """For each largest accepting component, the letters that it takes from each state of the structure."""
    if not product.complete:
        return None
    diagrams = product.diagrams
    found: list[list[Diagram]] = []
    for component in product.accepting_components(product.moves):
        inside = partial(_enters, frozenset(component))
        letters = [diagrams.false] * len(product.rows)
        for pair in sorted(component):
            state = product.pairs[pair][0]
            letters[state] = diagrams.either(letters[state], diagrams.transform(product.moves[pair], inside, {}))
        if letters not in found:
            found.append(letters)
    return [part for part in found if not any(_within(diagrams, part, other) for other in found if other is not part)]


def _within(diagrams: Diagrams, part: list[Diagram], other: list[Diagram]) -> bool:
    return all(
        diagrams.both(inner, outer) == inner
        for inner, outer in zip(part, other, strict=True)
        if inner != diagrams.false
    )
