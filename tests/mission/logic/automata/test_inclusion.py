"""What states accept and how they simulate each other, against all short lassos."""

from itertools import product

import numpy as np
import pytest

from mission.logic.automata.inclusion import included, simulated
from mission.logic.automata.rabin import DEAD, Rabin
from tests.support.required import required

LETTERS = 2
LASSOS = [
    (prefix, suffix)
    for before in range(6)
    for prefix in product(range(LETTERS), repeat=before)
    for again in range(1, 5)
    for suffix in product(range(LETTERS), repeat=again)
]


def accepts(automaton: Rabin, state: int, prefix: tuple[int, ...], suffix: tuple[int, ...]) -> bool:
    targets, marks = automaton.targets, automaton.marks
    for letter in prefix:
        state = int(targets[state, letter]) if state != DEAD else DEAD
    rounds: list[int] = []
    met: list[int] = []
    while state != DEAD and state not in rounds:
        rounds.append(state)
        borne = 0
        for letter in suffix:
            if state != DEAD:
                borne |= int(marks[state, letter])
                state = int(targets[state, letter])
        met.append(borne)
    if state == DEAD:
        return False
    borne = int(np.bitwise_or.reduce(met[rounds.index(state) :]))
    return any(not borne & fin and borne & inf == inf for fin, inf in automaton.pairs)


def random_automaton(seed: int) -> Rabin:
    rng = np.random.default_rng(seed)
    targets = rng.integers(-1 if seed % 2 else 0, 4, (4, LETTERS))
    pairs = [((0, 3),), ((1, 2),), ((1, 6), (4, 1)), ((1, 0),)][seed % 4]
    return Rabin(targets, rng.integers(0, 8, targets.shape), pairs).reduced()


@pytest.mark.parametrize("seed", range(24))
def test_a_state_includes_another_if_it_accepts_all_its_words(seed: int) -> None:
    automaton = random_automaton(seed)
    words = np.array([[accepts(automaton, q, *lasso) for lasso in LASSOS] for q in range(automaton.size)])
    expected = (~words[:, None] | words[None]).all(axis=2)
    assert (included(automaton) == expected).all()
    assert (~simulated(automaton) | expected).all()


def test_a_state_that_has_less_to_do_simulates_one_with_more() -> None:
    letters = (frozenset[str](), frozenset({"a"}), frozenset({"b"}))
    (part,) = required("F (a & F b)", letters).parts
    after_a = int(part.targets[part.initial, 1])
    for order in (simulated(part), included(part)):
        assert order[part.initial, after_a]
        assert not order[after_a, part.initial]


def test_of_two_states_the_one_with_the_worse_marks_does_not_simulate() -> None:
    # Both read the one letter for ever; only the first of them accepts.
    part = Rabin(np.array([[0], [1]]), np.array([[1], [0]]), ((0, 1),))
    assert simulated(part).tolist() == [[True, False], [True, True]]


def test_what_comes_a_step_later_for_ever_is_accepted_but_does_not_simulate() -> None:
    # One letter, a mark on every other step: the states take turns.
    part = Rabin(np.array([[1], [0]]), np.array([[1], [0]]), ((0, 1),))
    assert included(part).all()
    assert simulated(part).tolist() == [[True, False], [False, True]]
