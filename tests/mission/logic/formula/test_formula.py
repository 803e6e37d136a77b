import copy
import pickle

import pytest

from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import (
    FALSE,
    TRUE,
    Formula,
    always,
    conjunction,
    disjunction,
    eventually,
    following,
    negation,
    postorder,
    proposition,
    proposition_order,
    propositions,
    until,
)

A, B, C = (proposition(name) for name in "abc")


def test_equal_formulas_are_one_object() -> None:
    assert until(A, conjunction(B, C)) is until(proposition("a"), conjunction(B, C))
    assert copy.deepcopy(until(A, B)) is until(A, B)
    assert pickle.loads(pickle.dumps(until(A, B))) is until(A, B)  # noqa: S301 - what was just written


def test_a_formula_cannot_be_changed() -> None:
    with pytest.raises(AttributeError, match="immutable"):
        A.name = "b"
    with pytest.raises(AttributeError, match="immutable"):
        del A.name


def test_chains_are_flat_and_keep_their_order() -> None:
    assert conjunction(conjunction(A, B), C) is conjunction(A, conjunction(B, C))
    assert conjunction(B, A) is not conjunction(A, B)
    assert conjunction() is TRUE
    assert disjunction() is FALSE
    assert disjunction(A) is A


@pytest.mark.parametrize(
    ("operator", "operands", "name"),
    [
        (Operator.NOT, (), ""),
        (Operator.UNTIL, (A,), ""),
        (Operator.AND, (A,), ""),
        (Operator.AND, (A, conjunction(B, C)), ""),
        (Operator.TRUE, (A,), ""),
        (Operator.PROPOSITION, (A,), "a"),
        (Operator.PROPOSITION, (), ""),
        (Operator.PROPOSITION, (), 'a"b'),
        (Operator.PROPOSITION, (), "a\nb"),
        (Operator.PROPOSITION, (), "a" * 201),
        (Operator.NEXT, (A,), "a"),
    ],
)
def test_what_does_not_fit_is_no_formula(operator: Operator, operands: tuple[Formula, ...], name: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        Formula(operator, operands, name)


def test_propositions_come_in_the_order_of_first_occurrence() -> None:
    formula = until(B, conjunction(A, eventually(B)))
    assert proposition_order(formula) == ("b", "a")
    assert propositions(formula) == {"a", "b"}


def test_postorder_has_each_node_once_and_operands_first() -> None:
    formula = disjunction(until(A, B), always(until(A, B)))
    order = postorder(formula)
    assert len(order) == len(set(order)) == 5
    assert all(order.index(part) < order.index(node) for node in order for part in node.operands)


def test_depth_is_bounded_by_memory_alone() -> None:
    formula = A
    for _ in range(5_000):
        formula = following(negation(formula))
    assert formula.depth == 10_001
    assert len(postorder(formula)) == 10_001


def test_a_deep_formula_is_written() -> None:
    formula = A
    for _ in range(3000):
        formula = negation(formula)
    assert str(formula) == "!" * 3000 + "a"


def test_eventualities_and_universalities() -> None:
    assert eventually(A).eventuality
    assert not eventually(A).universality
    assert always(eventually(A)).eventuality
    assert always(eventually(A)).universality
    assert negation(always(A)).eventuality
    assert not A.eventuality
    assert until(A, eventually(B)).eventuality
