"""From formulas to small deterministic automata over the letters that really occur, one for each conjunct.

Each kind of property has the automaton that its place in the hierarchy allows (Manna and Pnueli, "A hierarchy of
temporal properties", 1990): obligations a weak one, recurrence a Büchi, persistence a co-Büchi automaton, and Boolean
combinations of these a product. Only what is left is made deterministic by way of trees (``determinisation``).
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

import numpy as np

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import CompiledGeneralised, GeneralisedBuchi, compile_generalised
from mission.logic.automata.conversion import with_accepting_states, with_marked_transitions
from mission.logic.automata.determinisation import determinised
from mission.logic.automata.diagrams import Diagrams, TooLargeError
from mission.logic.automata.lettered import Alphabet, Lettered
from mission.logic.automata.progression import Progression
from mission.logic.automata.rabin import DEAD, IntArray, Pair, Rabin, both, nothing
from mission.logic.automata.translate import MAX_DEPTH, translate_generalised
from mission.logic.automata.weak import is_obligation, weak_structure
from mission.logic.formula.conjuncts import separated
from mission.logic.formula.operators import Operator
from mission.logic.formula.rewriting import simplified
from mission.logic.formula.syntax import TRUE, Formula, negation, proposition_order
from mission.logic.formula.word import Letter

MAX_STATES: Final = 2_000
"""States of the automaton of one conjunct at which its construction gives up."""

MAX_PAIRS: Final = 64
"""Pairs of its condition likewise."""

_GROWTH: Final = 300_000  # nodes of diagrams
_MOST_MARKS: Final = 62  # bits of an integer


def parts_of(formula: Formula, letters: Sequence[Letter]) -> tuple[Rabin, ...]:
    """An automaton for each conjunct of a formula, over the numbers of ``letters``.

    Raises:
        AutomatonSizeError: One of them would be too large.
    """
    if formula.depth > MAX_DEPTH:
        raise AutomatonSizeError(f"the formula is nested deeper than {MAX_DEPTH}")
    # One by one: simplified together, conjuncts could become one formula again.
    small = (piece for part in separated(formula) for piece in separated(simplified(part)))
    conjuncts = dict.fromkeys(map(simplified, small)) or (TRUE,)
    return tuple(_checked(conjunct, partial(_of_formula, conjunct, letters)) for conjunct in conjuncts)


def part_of(automaton: GeneralisedBuchi, letters: Sequence[Letter]) -> Rabin:
    """A deterministic automaton of the words over ``letters`` that any automaton accepts.

    Raises:
        AutomatonSizeError: It would be too large.
    """
    return _checked("the mission's automaton", partial(_of_automaton, automaton, letters))


def _checked(what: object, make: Callable[[], Rabin]) -> Rabin:
    try:
        return make().reduced()
    except TooLargeError as error:
        name = f"`{what}`" if isinstance(what, Formula) else what
        raise AutomatonSizeError(
            f"the search for best runs needs a deterministic automaton of {name}, which has more than {MAX_STATES} "
            f"states or {MAX_PAIRS} pairs of acceptance sets; write it as a conjunction of smaller formulas, or give a "
            "smaller automaton, or a deterministic one"
        ) from error


def _of_formula(formula: Formula, letters: Sequence[Letter]) -> Rabin:
    """A deterministic automaton of a formula in negation normal form."""
    if is_obligation(formula):
        return _of_obligation(formula, letters)
    if formula.operator in (Operator.AND, Operator.OR):
        operands = [_of_formula(operand, letters).reduced() for operand in formula.operands]
        return _combined(operands, every=formula.operator is Operator.AND)
    automaton = translate_generalised(formula)
    if not automaton.deterministic:
        negated = translate_generalised(negation(formula))
        if negated.deterministic:
            return _outside(_of_table(compile_generalised(negated, tuple(letters)), len(letters)))
    return _of_automaton(automaton, letters)


def _of_obligation(formula: Formula, letters: Sequence[Letter]) -> Rabin:
    """A weak automaton: what must come finitely often are transitions of states that do not accept."""
    diagrams, names = Diagrams(), proposition_order(formula)
    diagrams.allow(_GROWTH)
    found = weak_structure(Progression(diagrams, names), diagrams, names, formula, MAX_STATES)
    holding = [sum(1 << bit for bit, name in enumerate(names) if name in letter) for letter in letters]
    table = np.array([[diagrams.evaluate(row, holds) for holds in holding] for row in found.moves], dtype=np.int64)
    table = table.reshape(found.size, len(letters), 2)  # one move for each letter: target and mark
    return Rabin(table[..., 0], 1 - table[..., 1], ((1, 0),), counter_free=True)


def _of_automaton(automaton: GeneralisedBuchi, letters: Sequence[Letter]) -> Rabin:
    compiled = compile_generalised(automaton, tuple(letters))
    keys = compiled.sources * len(letters) + compiled.letters
    if len(compiled.initial) == 1 and len(np.unique(keys)) == len(keys):
        return _of_table(compiled, len(letters))
    alphabet = Alphabet.of(automaton.propositions, letters)
    machine = Lettered.of(with_marked_transitions(with_accepting_states(automaton)), alphabet)
    parity = determinised(machine, alphabet.size, MAX_STATES)
    table = np.array(parity.moves, dtype=np.int64)
    highest = int(table[..., 1].max())
    if highest >= _MOST_MARKS:
        raise TooLargeError
    pairs = tuple(((1 << even) - 1, 1 << even) for even in range(2, highest + 1, 2))
    number = {letter: index for index, letter in enumerate(alphabet.letters)}
    names = frozenset(automaton.propositions)
    classes = np.array([number[names & letter] for letter in letters])
    return Rabin(table[..., 0], np.int64(1) << table[..., 1], pairs).over(classes)


def _of_table(compiled: CompiledGeneralised, letters: int) -> Rabin:
    """A generalised Büchi automaton that is deterministic already."""
    shape = (compiled.states, letters)
    targets, marks = np.full(shape, DEAD, dtype=np.int64), np.zeros(shape, dtype=np.int64)
    targets[compiled.sources, compiled.letters] = compiled.targets
    bits = np.int64(1) << np.arange(compiled.sets, dtype=np.int64)
    marks[compiled.sources, compiled.letters] = compiled.marks @ bits
    # Where every run is accepting, there is a set that is never met and must not be.
    pair = (0, (1 << compiled.sets) - 1) if compiled.sets else (1, 0)
    return Rabin(targets, marks, (pair,), int(compiled.initial[0]))


def _outside(buchi: Rabin) -> Rabin:
    """The complement of a deterministic Büchi automaton: one of its sets comes finitely often, or its run ends."""
    ((_, inf),) = buchi.pairs
    sets = inf.bit_length()  # none where every run is accepting
    targets = np.vstack((buchi.targets, np.full(buchi.targets.shape[1], DEAD)))
    targets[targets == DEAD] = buchi.size
    marks = np.vstack((buchi.marks, np.zeros(buchi.targets.shape[1], dtype=np.int64)))
    if not sets:
        marks[:-1] = 1
    return Rabin(targets, marks, tuple((1 << k, 0) for k in range(max(1, sets))), buchi.initial)


def _combined(parts: Sequence[Rabin], *, every: bool) -> Rabin:
    """The words that every part accepts, or some part does."""
    letters = parts[0].targets.shape[1]
    start = tuple(part.initial for part in parts)
    shifts = np.cumsum([0, *(_width(part) for part in parts)]).tolist()
    pairs = [
        [(fin << shift, inf << shift) for fin, inf in part.pairs] for part, shift in zip(parts, shifts, strict=False)
    ]
    found: list[Pair] = list(both(pairs)) if every else [pair for of_part in pairs for pair in of_part]
    if len(found) > MAX_PAIRS or shifts[-1] > _MOST_MARKS:
        raise TooLargeError
    lost = any if every else all
    if lost(state == DEAD for state in start):
        return nothing(letters)
    # A part that has lost, beside one that has not, meets none of its marks: one of its own stands for that.
    rows = [(part.targets.tolist(), (part.marks << shift).tolist()) for part, shift in zip(parts, shifts, strict=False)]
    ended = [0 if every else _ended(of_part) for of_part in pairs]
    number, queue = {start: 0}, [start]
    targets: list[list[int]] = []
    marks: list[list[int]] = []
    for state in queue:
        entered, borne = [], []
        for letter in range(letters):
            after = tuple(row[q][letter] if q != DEAD else DEAD for (row, _), q in zip(rows, state, strict=True))
            if lost(q == DEAD for q in after):
                entered.append(DEAD)
                borne.append(0)
                continue
            if after not in number:
                number[after] = len(queue)
                queue.append(after)
            entered.append(number[after])
            met = (
                bits[q][letter] if DEAD not in (q, end) else lost_bits
                for (_, bits), q, end, lost_bits in zip(rows, state, after, ended, strict=True)
            )
            borne.append(sum(met))
        targets.append(entered)
        marks.append(borne)
        if len(queue) > MAX_STATES:
            raise TooLargeError
    return Rabin(_array(targets), _array(marks), tuple(found))


def _ended(pairs: Sequence[Pair]) -> int:
    """Marks with which none of the pairs is satisfied."""
    return sum({fin & -fin for fin, _ in pairs})


def _width(part: Rabin) -> int:
    return max((max(fin, inf).bit_length() for fin, inf in part.pairs), default=0)


def _array(rows: list[list[int]]) -> IntArray:
    return np.array(rows, dtype=np.int64)
