"""Formulas and lasso words by chance, from a seed, and the formulas that automata are measured on."""

import csv
from dataclasses import dataclass
from pathlib import Path
from random import Random

from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import (
    FALSE,
    TRUE,
    Formula,
    always,
    conjunction,
    disjunction,
    equivalence,
    eventually,
    following,
    implication,
    negation,
    proposition,
    release,
    strong_release,
    until,
    weak_until,
)
from mission.logic.formula.word import LassoWord, Letter

GOLDEN = Path(__file__).parents[1] / "golden" / "logic"
_UNARY = (negation, following, eventually, always)
_BINARY = (conjunction, disjunction, implication, equivalence, until, release, weak_until, strong_release, conjunction)


def random_formula(random: Random, operators: int, names: tuple[str, ...]) -> Formula:
    """A formula of exactly so many operators; now and then a constant takes the place of a proposition."""
    if operators == 0:
        return random.choice((*map(proposition, names * 5), TRUE, FALSE))
    kind = random.randrange(len(_UNARY) + len(_BINARY))
    if kind < len(_UNARY):
        return _UNARY[kind](random_formula(random, operators - 1, names))
    left = random.randrange(operators)
    return _BINARY[kind - len(_UNARY)](
        random_formula(random, left, names), random_formula(random, operators - 1 - left, names)
    )


def random_letter(random: Random, names: tuple[str, ...]) -> Letter:
    return frozenset(name for name in names if random.random() < 0.5)


def random_word(random: Random, names: tuple[str, ...]) -> LassoWord:
    """A lasso word of up to four letters before the loop and up to five in it."""
    prefix = tuple(random_letter(random, names) for _ in range(random.randrange(5)))
    return LassoWord(prefix, tuple(random_letter(random, names) for _ in range(random.randrange(1, 6))))


@dataclass(frozen=True)
class Measured:
    """A formula that automata are measured on, and what the best known translator reaches."""

    group: str
    number: int
    formula: Formula
    states: int
    edges: int
    deterministic: bool


def measured_formulas(group: str) -> tuple[Measured, ...]:
    """The formulas of ``dac`` or ``mission``."""
    with (GOLDEN / "formulas.csv").open(newline="", encoding="utf-8") as file:
        return tuple(
            Measured(
                group,
                int(row["number"]),
                parse_formula(row["formula"]),
                int(row["states"]),
                int(row["edges"]),
                row["deterministic"] == "1",
            )
            for row in csv.DictReader(file)
            if row["set"] == group
        )
