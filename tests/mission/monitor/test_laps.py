"""Laps are counted by the labels of the loop, in order, whatever lies between."""

import numpy as np
import pytest

from mission.geometry.regions import Labelling
from mission.logic.automata.rabin import Rabin
from mission.monitor.laps import LapCounter, RoundCounter

# Triangles: 0 and 1 west, 2 north, 3 east, the rest without a label.
LABELS = Labelling(
    (frozenset(), frozenset({"west"}), frozenset({"north"}), frozenset({"east"})), np.array([1, 1, 2, 3, 0, 0, 0, 0])
)


@pytest.mark.parametrize(
    ("suffix", "flown", "laps"),
    [
        ((0, 4, 2, 5, 3, 6), (0, 4, 2, 5, 3, 6), 0),  # not round yet
        ((0, 4, 2, 5, 3, 6), (0, 4, 2, 5, 3, 6, 0), 1),
        ((0, 4, 2, 5, 3, 6), (7, 2, *(0, 4, 2, 5, 3, 6) * 3, 0, 4, 7), 3),  # with a way there and a way back
        ((0, 4, 2, 5, 3, 6), (1, 7, 2, 3, 1), 1),  # by other triangles of the same regions
        ((0, 4, 2, 5, 3, 6), (0, 4, 3, 6, 0), 0),  # north left out
        ((0, 4, 2, 5, 3, 6), (0, 4, 2, 4, 0, 4, 2, 5, 3, 1), 1),  # went back once
        ((1, 4, 2, 5, 0), (0, 4, 2, 5, 0, 4, 2), 1),  # begins and ends in west
        ((1, 4, 2, 5, 0), (0, 4, 2, 5, 0, 4, 2, 5, 1), 2),
        ((4, 0, 5, 2), (4, 0, 5, 2), 1),  # begins outside: the last region counts
        ((4, 0, 5, 2), (4, 0, 5, 2, 4, 0, 5, 2, 4, 7), 2),
        ((0, 4), (0, 1, 4, 7, 0, 1, 5, 0), 2),  # one region, again and again
        ((4, 0), (4, 0, 1, 4, 5, 0, 4), 2),
        ((0, 1), (0, 1, 0, 1), 1),  # all in one region: its triangles count
        ((4, 5, 6), (4, 5, 6, 4, 5), 1),  # without labels the triangles count
        ((4, 5, 6), (6, 5, 4, 5, 6), 0),
    ],
)
def test_laps(suffix: tuple[int, ...], flown: tuple[int, ...], laps: int) -> None:
    counter = LapCounter(suffix, LABELS)
    for triangle in flown:
        counter.enter(triangle)
    assert counter.laps == laps


@pytest.mark.parametrize(
    ("flown", "due"),
    [
        ((7,), None),
        ((7, 0), (2, 3)),
        ((0, 4, 2), (3,)),
        ((0, 4, 2, 5, 3), ()),  # all but what closes it
        ((0, 4, 2, 5, 3, 6, 0), (2, 3)),  # the next one
    ],
)
def test_what_a_lap_has_not_met_is_due(flown: tuple[int, ...], due: tuple[int, ...] | None) -> None:
    counter = LapCounter((0, 4, 2, 5, 3, 6), LABELS)
    for triangle in flown:
        counter.enter(triangle)
    assert counter.due == (None if due is None else tuple(LABELS.label(triangle) for triangle in due))


def test_a_lap_that_was_begun_before_is_over_where_the_loop_begins() -> None:
    counter = LapCounter((0, 4, 2, 5, 3, 6), LABELS, begun=True)
    counts = []
    for triangle in (2, 5, 0, 4, 2, 5, 3, 6, 0):
        counter.enter(triangle)
        counts.append(counter.laps)
    assert counts == [-1, -1, 0, 0, 0, 0, 0, 0, 1]


@pytest.mark.parametrize(
    ("letters", "rounds", "due"),
    [
        ((), 0, 3),
        ((1, 1), 0, 2),
        ((1, 0, 2), 1, 3),
        ((2, 1, 2, 2, 1), 2, 3),  # in any order
        ((1, 3, 2), 0, 1),  # what must not come makes it begin anew
        ((1, 3, 1, 2), 1, 3),
    ],
)
def test_rounds_are_over_when_every_mark_has_come(letters: tuple[int, ...], rounds: int, due: int) -> None:
    # One state: letter 1 bears the first mark, letter 2 the second, letter 3 the one that must come no more.
    automaton = Rabin(np.zeros((1, 4), dtype=np.int64), np.array([[0, 1, 2, 4]]), ((4, 3),))
    counter = RoundCounter(automaton)
    for letter in letters:
        counter.read(letter)
    assert (counter.laps, counter.due) == (rounds, (due,))
