"""What to do next satisfies the formula from every triangle and state from which it can be satisfied at all."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.determined import parts_of
from mission.logic.automata.rabin import DEAD
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.monitor.laps import RoundCounter
from mission.planning.policy import Policy
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from tests.support.drawn_cases import tried
from tests.support.products import random_system, weighted

LETTERS = tuple(frozenset({name}) for name in ("p0", "p1", "p2"))
STAYS = ("F (p0 & F G p1)", "!p2 U p0", "F p0 & F p1 & G !p2", "G (p0 -> F p1)", "F G p0 | F G p1", "F (p0 & X p1)")
LAPS = (
    "G F p0 & G F p1",
    "G F p0 & G F p1 & G (p2 -> X G !p2)",
    "(G F p0 & G F p1) | F G p2",
    "G (p0 -> X F p1) & G F p0",
)
_WALK = 5


def policy_of(system: TransitionSystem, formula: Formula, *, laps: bool, shallow: FloatArray | None = None) -> Policy:
    automaton = Conjunction.of(parts_of(formula, LETTERS))
    none = np.zeros(system.size, dtype=np.bool_)
    stops = np.zeros(system.size) if shallow is None else shallow
    return Policy(system, automaton, 0, Semantics.STANDARD, shallow=stops, homes=none, laps=laps)


def words_to_states(policy: Policy, letter: int) -> dict[int, tuple[int, ...]]:
    """A word that ends in a letter for each state of the automaton that such a word leads to."""
    whole = policy.moves.automaton.whole
    found: dict[int, tuple[int, ...]] = {}
    for length in range(3):
        for before in product(range(len(LETTERS)), repeat=length):
            counter = RoundCounter(whole)
            for each in (*before, letter):
                counter.read(each)
            if counter.state != DEAD:
                found.setdefault(counter.state, (*before, letter))
    return found


def walks(system: TransitionSystem, triangle: int, most: int) -> list[list[tuple[int, ...]]]:
    """All ways from a triangle without staying, by the number of their steps."""
    levels: list[list[tuple[int, ...]]] = [[(triangle,)]]
    for _ in range(most):
        levels.append(
            [(*way, int(after)) for way in levels[-1] for after in system.successors[way[-1], 1:] if after >= 0]
        )
    return levels


def spelled(system: TransitionSystem, before: tuple[int, ...], way: tuple[int, ...]) -> tuple[frozenset[str], ...]:
    """The word before a way, whose last letter is that of its first triangle, and what is entered on it."""
    return tuple(LETTERS[letter] for letter in (*before, *system.letter_of[list(way[1:])].tolist()))


def system_of(seed: int, triangles: int) -> TransitionSystem:
    rng = np.random.default_rng(seed)
    system = random_system(rng, triangles, len(LETTERS))
    return TransitionSystem(system.successors, system.letter_of, LETTERS)


@tried(40)
@given(seed=st.integers(0, 10**6), triangles=st.integers(1, 4), text=st.sampled_from(STAYS))
def test_a_flight_that_ends_does_what_it_must_at_the_least_cost(seed: int, triangles: int, text: str) -> None:
    system, formula = system_of(seed, triangles), parse_formula(text)
    shallow = np.random.default_rng(seed).integers(0, 4, size=triangles).astype(np.float64)
    policy = policy_of(system, formula, laps=False, shallow=shallow)
    for start in range(triangles):
        ways: list[tuple[int, ...]] = [way for level in walks(system, start, _WALK) for way in level]
        for state, before in words_to_states(policy, int(system.letter_of[start])).items():
            least = min(
                (
                    len(way) - 1 + shallow[way[-1]]
                    for way in ways
                    if satisfies(
                        LassoWord(spelled(system, before, way), (LETTERS[system.letter_of[way[-1]]],)), formula
                    )
                ),
                default=np.inf,
            )
            choice = policy.completing(start, state, ())
            if choice is None or choice.cost > _WALK:
                assert least > _WALK
                continue
            assert choice.cost == least
            way: tuple[int, ...] = (start,)
            now = state
            while choice is not None and choice.enter is not None:
                assert choice.enter in system.successors[way[-1], 1:]
                way = (*way, choice.enter)
                now = int(policy.moves.automaton.whole.targets[now, system.letter_of[choice.enter]])
                choice = policy.completing(way[-1], now, ())
            assert choice is not None
            assert len(way) - 1 + shallow[way[-1]] == least


@tried(40)
@given(seed=st.integers(0, 10**6), triangles=st.integers(2, 4), text=st.sampled_from(LAPS))
def test_laps_satisfy_the_formula_wherever_any_lap_does(seed: int, triangles: int, text: str) -> None:
    system, formula = system_of(seed, triangles), parse_formula(text)
    policy = policy_of(system, formula, laps=True)
    for start in range(triangles):
        for before in words_to_states(policy, int(system.letter_of[start])).values():
            counter = RoundCounter(policy.moves.automaton.whole)
            for letter in before:
                counter.read(letter)
            way: tuple[int, ...] = (start,)
            seen: dict[tuple[int, int, tuple[int, ...]], int] = {}
            choice = policy.completing(start, counter.state, counter.due)
            if choice is None:
                assert not any_lasso(system, formula, before, start)
                continue
            while (key := (way[-1], counter.state, counter.due)) not in seen:
                seen[key] = len(way) - 1
                choice = policy.completing(*key)
                assert choice is not None
                if choice.enter is None:
                    break
                way = (*way, choice.enter)
                counter.read(int(system.letter_of[choice.enter]))
            if choice.enter is None:
                loop: tuple[frozenset[str], ...] = (LETTERS[system.letter_of[way[-1]]],)
            else:
                loop = spelled(system, (), way[seen[key] :])
            assert satisfies(LassoWord(spelled(system, before, way), loop), formula), (before, way, loop)


def any_lasso(system: TransitionSystem, formula: Formula, before: tuple[int, ...], start: int) -> bool:
    """Whether some way of a few steps, and then a stay or a round of a few steps for ever, satisfies a formula."""
    for head in (way for level in walks(system, start, 3) for way in level):
        word = spelled(system, before, head)
        rounds = [way for level in walks(system, head[-1], 4)[1:] for way in level if way[-1] == head[-1]]
        loops = [(LETTERS[system.letter_of[head[-1]]],), *(spelled(system, (), way) for way in rounds)]
        if any(satisfies(LassoWord(word, loop), formula) for loop in loops):
            return True
    return False


@pytest.mark.parametrize("text", [*STAYS, *LAPS])
def test_what_is_closed_is_what_nothing_can_be_completed_behind(text: str) -> None:
    system, formula = system_of(7, 5), parse_formula(text)
    policy = policy_of(weighted(np.random.default_rng(7), system, 9), formula, laps=text in LAPS)
    whole = policy.moves.automaton.whole
    for state in range(whole.size):
        closed = policy.closed(state, returning=False)
        for triangle in np.flatnonzero(policy.possible[state]).tolist():
            for facet, behind in enumerate(system.successors[triangle, 1:].tolist()):
                after = DEAD if behind < 0 else int(whole.targets[state, system.letter_of[behind]])
                due = tuple(inf for _, inf in whole.pairs)
                assert closed[triangle, facet] == (policy.completing(behind, after, due) is None)
