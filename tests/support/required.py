"""What a search is given: the deterministic automata of a formula, or of any automaton."""

from mission.logic.automata.automaton import GeneralisedBuchi
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.determined import part_of, parts_of
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula
from mission.logic.formula.word import Letter


def required(formula: str | Formula, letters: tuple[Letter, ...]) -> Conjunction:
    parsed = parse_formula(formula) if isinstance(formula, str) else formula
    return Conjunction.of(parts_of(parsed, letters))


def given(automaton: GeneralisedBuchi, letters: tuple[Letter, ...]) -> Conjunction:
    return Conjunction.of([part_of(automaton, letters)])
