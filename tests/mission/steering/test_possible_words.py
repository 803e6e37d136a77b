"""The words of a vehicle whose place is known only as sets of triangles, against listing those words."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.logic.automata.automaton import compile_to_alphabet
from mission.logic.automata.refutation import refutation
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.spec.model import Semantics
from mission.steering.possible_words import Layers, Violations
from tests.support.curves import refuting
from tests.support.drawn_cases import tried

# A strip of six triangles; each shares vertices with the two before it and the two behind it.
STRIP = np.array([(i, i + 1, i + 2) for i in range(6)])
LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b"}))
FORMULAS = (
    "F a",
    "G !a",
    "F (a & F b)",
    "!b U a",
    "G F a",
    "F G a",
    "X a",
    "G (a -> X b)",
    "F a & G !b",
    "F (a & X a)",
    "G F a & G F b",
)


def neighbours(triangle: int, layer: tuple[int, ...]) -> list[int]:
    return [t for t in layer if t != triangle and set(STRIP[t]) & set(STRIP[triangle])]


def step(layers: Layers, place: tuple[int, int]) -> Iterator[tuple[tuple[int, int], int | None, bool]]:
    """One move of the vehicle: the next place, the triangle it spells (None: nothing), whether a lap begins."""
    layer, t = place
    for u in neighbours(t, layers.triangles[layer]):
        yield (layer, u), u, False
    if layer < layers.last:
        if t in layers.triangles[layer + 1]:
            yield (layer + 1, t), None, False
    elif layers.loop_from is None:
        yield (layer, t), t, True
    else:
        for u in layers.triangles[layers.loop_from]:
            yield (layers.loop_from, u), (u if u != t else None), True
        if all(t in layer for layer in layers.triangles[layers.loop_from :]):
            yield (layers.loop_from, t), t, True


def words(layers: Layers, letter_of: list[int], semantics: Semantics, moves: int) -> Iterator[LassoWord]:
    """Every lasso word of at most so many moves whose loop closes at the place and the lap where it began."""

    def go(trail: list[tuple[int, int]], spelled: list[int | None], laps: list[bool]) -> Iterator[LassoWord]:
        for at, place in enumerate(trail[:-1]):
            loop = [t for t in spelled[at + 1 :] if t is not None]
            stays = layers.loop_from is None and place[0] == layers.last
            if place == trail[-1] and loop and (stays or any(laps[at + 1 :])):
                prefix = [t for t in spelled[: at + 1] if t is not None]
                yield LassoWord(*(tuple(LETTERS[letter_of[t]] for t in part) for part in (prefix, loop)))
        if len(trail) <= moves:
            for place, spells, lap in step(layers, trail[-1]):
                yield from go([*trail, place], [*spelled, spells], [*laps, lap])

    for t in layers.triangles[0]:
        yield from go([(0, t)], [t if semantics is Semantics.STANDARD else None], [False])


@st.composite
def flights(draw: st.DrawFn) -> Layers:
    size = draw(st.integers(1, 3))
    rows = [draw(st.sets(st.integers(0, 5), min_size=1, max_size=2)) for _ in range(size)]
    for before, after in pairwise(rows):
        if not before & after:
            after.add(min(before))
    loop = draw(st.none() | st.integers(0, size - 1))
    return Layers(tuple(tuple(sorted(row)) for row in rows), loop)


@given(
    flights(),
    st.lists(st.integers(0, 2), min_size=6, max_size=6),
    st.sampled_from(Semantics),
    st.sampled_from(FORMULAS),
)
@tried(100)
def test_a_violation_exists_exactly_if_one_can_be_listed(
    layers: Layers, letter_of: list[int], semantics: Semantics, text: str
) -> None:
    formula = parse_formula(text)
    violations = Violations(
        layers,
        corners=STRIP,
        letter_of=np.array(letter_of),
        refutation=refuting(text, LETTERS),
        semantics=semantics,
    )
    listed = any(not satisfies(word, formula) for word in words(layers, letter_of, semantics, moves=6))
    assert violations.exists() == listed
    way, loop = violations.witness(tuple(frozenset(layer) for layer in layers.triangles))
    assert bool(way) == bool(loop) == listed
    if listed:
        assert way[-1] == loop[0] == loop[-1]
        assert layers.loop_from is None or {layer for layer, _ in loop} >= set(range(layers.loop_from, layers.last + 1))
    for (layer, t), (following, u) in pairwise((*way, *loop[1:])):
        assert (following, u) in {place for place, _, _ in step(layers, (layer, t))}


@pytest.mark.parametrize(
    ("text", "rows", "loop", "holds"),
    [
        ("F a", ((0,), (0, 1), (1,)), None, True),  # surely enters 1
        ("F a", ((0,), (0, 1), (0,)), None, False),  # may touch 1
        ("G !a", ((0,), (0, 1), (0,)), None, False),
        ("G !a", ((0,), (0, 2), (2,)), None, True),
        ("F G a", ((0,), (0, 1), (1,)), None, True),
        ("F G a", ((0,), (0, 1)), None, False),  # may come and go for ever
        ("G F a", ((0,), (0, 1), (1,), (1, 2), (0, 2)), 0, True),  # once a lap
        ("G F a", ((0,), (0, 1), (0,)), 0, False),
        ("G F a", ((1,),), 0, True),  # stays in it lap after lap
        ("X a", ((0,), (0, 1), (1,)), None, True),
        ("X X a", ((0,), (0, 1), (1,)), None, False),  # may go 0, 1, 0, 1
    ],
)
def test_flights_that_one_can_follow_by_hand(
    text: str,
    rows: tuple[tuple[int, ...], ...],
    loop: int | None,
    holds: bool,  # noqa: FBT001 - a table's column
) -> None:
    violations = Violations(
        Layers(rows, loop),
        corners=STRIP,
        letter_of=np.array([0, 1, 0, 0, 0, 0]),
        refutation=refuting(text, LETTERS),
        semantics=Semantics.STANDARD,
    )
    assert violations.exists() != holds


@given(
    flights(),
    st.lists(st.integers(0, 2), min_size=6, max_size=6),
    st.sampled_from(Semantics),
    st.lists(st.sampled_from(FORMULAS), min_size=2, max_size=4, unique=True),
)
@tried(100)
def test_conjuncts_are_violated_exactly_where_their_conjunction_is(
    layers: Layers, letter_of: list[int], semantics: Semantics, texts: list[str]
) -> None:
    text = " & ".join(f"({text})" for text in texts)
    machines = (refuting(text, LETTERS), compile_to_alphabet(refutation(parse_formula(text)), LETTERS))
    whole, apart = (
        Violations(layers, corners=STRIP, letter_of=np.array(letter_of), refutation=machine, semantics=semantics)
        for machine in machines
    )
    assert apart.exists() == whole.exists()
