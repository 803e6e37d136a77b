"""Generalised automata and lasso words by chance, from a seed, and acceptance straight from its definition."""

from random import Random

from mission.logic.automata.automaton import GeneralisedBuchi, MarkedEdge
from mission.logic.automata.guards import Guard
from mission.logic.formula.word import LassoWord, Letter

NAMES = ("a", "b")
LETTERS: tuple[Letter, ...] = (frozenset(), frozenset("a"), frozenset("b"), frozenset("ab"))


def random_automaton(random: Random, size: int, sets: int, degree: float, letters: int) -> GeneralisedBuchi:
    read: dict[tuple[int, int, tuple[int, ...]], list[tuple[int, int]]] = {}
    for source in range(size):
        for target in range(size):
            for letter in range(letters):
                if random.random() < degree / size:
                    marks = tuple(k for k in range(sets) if random.random() < 0.35)
                    read.setdefault((source, target, marks), []).append((letter, 3 ^ letter))
    edges = tuple(MarkedEdge(s, Guard(NAMES, tuple(read[s, t, m])), t, m) for s, t, m in sorted(read))
    initial = tuple(sorted({0, random.randrange(size) if random.random() < 0.3 else 0}))
    return GeneralisedBuchi(NAMES, size, initial, sets, edges)


def accepts(automaton: GeneralisedBuchi, word: LassoWord) -> bool:
    """Whether some run meets every set in each of endlessly many rounds of the loop: reachability, and no more."""
    letters = word.prefix + word.suffix
    moves: dict[tuple[int, int], list[tuple[tuple[int, int], frozenset[int]]]] = {}
    for place, letter in enumerate(letters):
        after = place + 1 if place + 1 < len(letters) else len(word.prefix)
        for edge in automaton.edges:
            if edge.guard.allows(letter):
                moves.setdefault((place, edge.source), []).append(((after, edge.target), frozenset(edge.marks)))

    def reached(start: tuple[int, int]) -> set[tuple[tuple[int, int], frozenset[int]]]:
        """Places that lie ahead, each with what can be met on the way there."""
        found = {((start), frozenset[int]())}
        pending = list(found)
        result: set[tuple[tuple[int, int], frozenset[int]]] = set()
        while pending:
            place, met = pending.pop()
            for target, marks in moves.get(place, []):
                entry = (target, met | marks)
                if entry not in result:
                    result.add(entry)
                    pending.append(entry)
        return result

    everything = frozenset(range(automaton.sets))
    starts = {(0, q) for q in automaton.initial}
    places = starts | {place for start in starts for place, _ in reached(start)}
    return any((place, everything) in reached(place) for place in places)


def random_lasso(random: Random, letters: int) -> LassoWord:
    prefix = tuple(LETTERS[random.randrange(letters)] for _ in range(random.randrange(4)))
    return LassoWord(prefix, tuple(LETTERS[random.randrange(letters)] for _ in range(random.randint(1, 5))))
