"""From formulas to small Büchi automata."""

from collections.abc import Iterator
from itertools import islice, permutations

from mission.logic.automaton import BuchiAutomaton
from mission.logic.degeneralisation import degeneralised, with_few_mixed_states
from mission.logic.deterministic import accepting_like
from mission.logic.diagrams import Diagram, Diagrams
from mission.logic.formula import Formula, negation, proposition_order
from mission.logic.progression import Progression
from mission.logic.rewriting import simplified
from mission.logic.simulation import reduced
from mission.logic.structure import Structure, pruned, state_based
from mission.logic.tableau import Tableau, TooLargeError
from mission.logic.weak import is_obligation, refined, weak_structure


def translate(formula: Formula) -> BuchiAutomaton:
    """A Büchi automaton that accepts exactly the words that satisfy ``formula``."""
    short = simplified(formula)
    names = proposition_order(formula)
    diagrams = Diagrams()
    if is_obligation(short):
        progression = Progression(diagrams, names)
        return state_based(pruned(weak_structure(progression, diagrams, names, short, 100_000)))
    return _general(short, names, diagrams)


def _general(short: Formula, names: tuple[str, ...], diagrams: Diagrams) -> BuchiAutomaton:
    tableau = Tableau(diagrams, names)
    positive = reduced(tableau.structure(short, 100_000))
    candidates = [positive]
    try:
        negative = reduced(Tableau(diagrams, names).structure(simplified(negation(short)), 2000))
        progression = Progression(diagrams, names)
        states, rows = progression.explore(progression.state(short), 1000)
    except TooLargeError:
        pass
    else:
        for guess in _guesses(progression, diagrams, states, rows):
            found = accepting_like(guess, positive, negative, 10000)
            if found is not None:
                candidates.append(reduced(found))
                break
    best = [state_based(small) for candidate in candidates for small in _state_based_forms(candidate)]
    return min(best, key=lambda automaton: (automaton.size, not automaton.deterministic, automaton.edge_count))


def _guesses(
    progression: Progression, diagrams: Diagrams, states: list[Diagram], rows: list[Diagram]
) -> Iterator[list[Diagram]]:
    """Deterministic structures, from small to large, whose states may be the languages that can remain."""
    letters = sorted({cube[0] for row in rows for cube, _ in islice(diagrams.paths(row), 64)})[:64]
    singles = [(letter,) for letter in letters]
    pairs = list(islice(permutations(letters, 2), 256))
    previous = 0
    for cycles in (singles, singles + pairs, None):
        if cycles is None:
            classes = list(range(len(states)))
        else:
            truths = [progression.truth_on_cycle(cycle) for cycle in cycles]
            classes = refined(
                diagrams, rows, [tuple(diagrams.evaluate(state, truth) for truth in truths) for state in states]
            )
        size = len(set(classes))
        if size > previous:
            previous = size
            known: dict[Diagram, Diagram] = {}
            first: dict[int, int] = {}
            for state, number in enumerate(classes):
                first.setdefault(number, state)
            yield [diagrams.transform(rows[state], classes.__getitem__, known) for state in first.values()]


def _state_based_forms(structure: Structure) -> Iterator[Structure]:
    for order in islice(permutations(range(structure.sets)), 6):
        current = structure
        if structure.sets != 1:
            current = reduced(degeneralised(structure, order))
            yield current
        if current.sets == 1:
            for light in (range(current.size), range(current.size)[::-1]):
                yield reduced(degeneralised(with_few_mixed_states(current, light), (0,)))
