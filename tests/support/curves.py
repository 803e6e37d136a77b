"""The paper's domain and path, and automata of formulas, for tests of what is built on them."""

from functools import cache

import numpy as np

from mission.geometry.arrays import BoolArray
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automata.automaton import CompiledAutomaton, compile_to_alphabet
from mission.logic.automata.translate import translate
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import negation
from mission.planning.run import Run
from mission.steering.path import SteeringPath, build_path
from tests.support.domains import PAPER_NODES

PAPER_FORMULA = "F (S1 & F R) & G !K1"
PAPER_RUN = Run(
    prefix=(0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12), suffix=(10,), controls=(1, 3, 3, 1, 1, 3, 1, 2, 2, 2, 3, 2, 0)
)


@cache
def paper_partition() -> Partition:
    return triangulate_nodes(PAPER_NODES)


def labelled(partition: Partition, names: dict[str, tuple[int, ...]]) -> Labelling:
    """Labels by region name; a letter for each distinct set of names."""
    sets = [frozenset(name for name, members in names.items() if t in members) for t in range(partition.size)]
    letters = tuple(sorted(set(sets), key=sorted))
    return Labelling(letters, np.array([letters.index(letter) for letter in sets]))


@cache
def paper_labelling() -> Labelling:
    return labelled(paper_partition(), {"R": (10,), "S1": (3,), "S2": (0,), "K1": (6,)})


@cache
def paper_path() -> SteeringPath:
    return build_path(paper_partition(), PAPER_RUN, start_m=(11.0, 9.5), speed_m_s=0.05, final_stay_s=100.0)


def marked(partition: Partition, triangles: tuple[int, ...]) -> BoolArray:
    flags = np.zeros(partition.size, dtype=np.bool_)
    flags[list(triangles)] = True
    return flags


@cache
def compiled(text: str, letters: tuple[frozenset[str], ...]) -> CompiledAutomaton:
    return compile_to_alphabet(translate(parse_formula(text)), letters)


@cache
def refuting(text: str, letters: tuple[frozenset[str], ...]) -> CompiledAutomaton:
    return compile_to_alphabet(translate(negation(parse_formula(text))), letters)
