"""Whether an automaton counts how often a letter is repeated."""

from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton, CompiledAutomaton, compile_to_alphabet
from mission.logic.automata.components import strong_components
from mission.logic.formula.word import Letter

MAX_STATES: Final = 100_000
"""States of the product of the two automata at which the question is too large."""

_State = tuple[int, int, int]


def tells_repeats_apart(automaton: BuchiAutomaton, outside: BuchiAutomaton, letters: tuple[Letter, ...]) -> bool:
    """Whether of two words that differ in repeats of letters alone, one is accepted and the other is not.

    Both can be stretched to one word by further repeats. So the automaton and its complement are run side by side on
    that word, and while either moves the other may stand and let repeats of its last letter pass. Source of the test:
    Michaud and Duret-Lutz, "Practical stutter-invariance checks for omega-regular languages" (2015).

    Args:
        automaton: Any automaton.
        outside: One of the words over ``letters`` that it does not accept.
        letters: Those that occur.

    Raises:
        AutomatonSizeError: The question is too large.
    """
    names = frozenset(automaton.propositions) | frozenset(outside.propositions)
    alphabet = tuple(dict.fromkeys(names & letter for letter in letters))
    pair = compile_to_alphabet(automaton, alphabet), compile_to_alphabet(outside, alphabet)
    queue, successors = _explored(pair[0], pair[1], len(alphabet))
    for part in strong_components(successors, range(len(queue))):
        if len(part) > 1 or part[0] in successors[part[0]]:
            states = [queue[index] for index in part]
            # What stands does not meet its accepting state again.
            inside = any(pair[0].accepting[a] for a, _, standing in states if standing <= 0)
            if inside and any(pair[1].accepting[b] for _, b, standing in states if standing >= 0):
                return True
    return False


def _explored(one: CompiledAutomaton, other: CompiledAutomaton, letters: int) -> tuple[list[_State], list[list[int]]]:
    """The states that can be reached, and the successors of each.

    A state is two states and what stands: 0 for none, n for the first after letter n - 1, -n for the second.
    """
    rows = _rows(one), _rows(other)
    queue: list[_State] = [(a, b, 0) for a in one.initial.tolist() for b in other.initial.tolist()]
    number = {state: index for index, state in enumerate(queue)}
    successors: list[list[int]] = []
    for a, b, standing in queue:
        found: list[_State] = []
        for letter in range(letters) if standing == 0 else (abs(standing) - 1,):
            firsts = [a] if standing > 0 else rows[0].get((a, letter), [])
            seconds = [b] if standing < 0 else rows[1].get((b, letter), [])
            kinds = (0, letter + 1, -letter - 1) if standing == 0 else (0, standing)
            found.extend((x, y, kind) for x in firsts for y in seconds for kind in kinds)
        for state in found:
            if state not in number:
                number[state] = len(queue)
                queue.append(state)
        successors.append(sorted({number[state] for state in found}))
        if len(queue) > MAX_STATES:
            raise AutomatonSizeError(f"whether the automaton counts triangles takes more than {MAX_STATES} states")
    return queue, successors


def _rows(compiled: CompiledAutomaton) -> dict[tuple[int, int], list[int]]:
    rows: dict[tuple[int, int], list[int]] = {}
    columns = (compiled.sources.tolist(), compiled.letters.tolist(), compiled.targets.tolist())
    for source, letter, target in zip(*columns, strict=True):
        rows.setdefault((source, letter), []).append(target)
    return rows
