"""Missions without a run are refused with the first reason that helps."""

import numpy as np
import pytest

from mission.errors import NoPlanError
from mission.planning.product import Product
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from tests.support.curves import marked, paper_labelling, paper_partition
from tests.support.required import required

LABELLING = paper_labelling()
SYSTEM = TransitionSystem.from_partition(paper_partition(), LABELLING, marked(paper_partition(), (6,)))


@pytest.mark.parametrize(
    ("formula", "says"),
    [
        ("G !S2", "violated where the flight starts, in triangle 0 (S2)"),
        ("F K1", "from triangle 0 the flight can reach R, S1, S2, but not K1: no open way leads there"),
        ("(S2 | R) U S1", "can reach S2, but not K1: no open way leads there; it can reach R, S1 only by violating"),
        ("F R & G !R", "no flight whatever satisfies the specification: it contradicts itself"),
        ("F (S1 & R)", "asks for regions together, or for a region, that no triangle has (regions of this map: K1, R"),
        ("F nowhere", "that no triangle has (regions of this map: K1, R, S1, S2)"),
    ],
)
def test_the_reason_is_given(formula: str, says: str) -> None:
    with pytest.raises(NoPlanError) as refused:
        search(Product(SYSTEM, required(formula, LABELLING.letters), 0, Semantics.STANDARD))
    assert says in str(refused.value)


def test_a_start_without_a_label_is_called_no_region() -> None:
    bare = LABELLING.letters.index(frozenset())
    start = int(np.flatnonzero(LABELLING.letter_of == bare)[0])
    with pytest.raises(NoPlanError, match=rf"in triangle {start} \(no region\)"):
        search(Product(SYSTEM, required("S1", LABELLING.letters), start, Semantics.STANDARD))


def test_a_one_way_map_cannot_satisfy_a_recurrent_formula() -> None:
    letters = (frozenset({"R"}), frozenset({"S1"}))
    one_way = TransitionSystem(np.array([[0, 1, -1, -1], [1, -1, -1, -1]]), np.array([0, 1]), letters)
    with pytest.raises(NoPlanError, match=r"only finitely often: from triangle 0 the flight can reach R, S1$"):
        search(Product(one_way, required("G F R & G F S1", letters), 0, Semantics.STANDARD))
