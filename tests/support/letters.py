"""Automata over letters as plain arrays, run by a graph library: an oracle that shares nothing with the translator."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from mission.logic.automata.automaton import CompiledAutomaton, CompiledGeneralised
from mission.logic.formula.word import LassoWord, Letter

IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Rows:
    """Transitions, one a row; a run is accepting if it takes rows of every column of ``marks`` infinitely often."""

    states: int
    sources: IntArray
    letters: IntArray
    targets: IntArray
    marks: BoolArray
    initial: IntArray


def rows_of(compiled: CompiledAutomaton | CompiledGeneralised) -> Rows:
    """Accepting states are marks on all that leaves them."""
    marks = compiled.accepting[compiled.sources][:, None] if isinstance(compiled, CompiledAutomaton) else compiled.marks
    return Rows(compiled.states, compiled.sources, compiled.letters, compiled.targets, marks, compiled.initial)


def accepts(rows: Rows, alphabet: tuple[Letter, ...], word: LassoWord) -> bool:
    """Whether a lasso word over ``alphabet`` is accepted."""
    read = [alphabet.index(letter) for letter in word.prefix + word.suffix]
    following = [*range(1, len(read)), len(word.prefix)]
    spelled = Rows(
        len(read),
        np.arange(len(read)),
        np.array(read),
        np.array(following),
        np.zeros((len(read), 0), dtype=np.bool_),
        np.zeros(1, dtype=np.int64),
    )
    return have_common_word(rows, spelled)


def have_common_word(first: Rows, second: Rows) -> bool:
    """Whether some infinite word is accepted by both: an accepting component of their product."""
    pairs = np.argwhere(first.letters[:, None] == second.letters[None, :])
    left, right = pairs[:, 0], pairs[:, 1]
    sources = first.sources[left] * second.states + second.sources[right]
    targets = first.targets[left] * second.states + second.targets[right]
    marks = np.concatenate((first.marks[left], second.marks[right]), axis=1)
    size = first.states * second.states
    starts = (first.initial[:, None] * second.states + second.initial[None, :]).ravel()
    # One more vertex leads to all starts.
    ends = np.concatenate((sources, np.full(len(starts), size))), np.concatenate((targets, starts))
    graph = csr_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(size + 1, size + 1))
    reached = np.zeros(size + 1, dtype=np.bool_)
    reached[breadth_first_order(graph, size, return_predecessors=False)] = True
    _, component = connected_components(graph, connection="strong")
    inner = (component[sources] == component[targets]) & reached[sources]
    met = np.zeros((size + 1, marks.shape[1]), dtype=np.bool_)
    np.logical_or.at(met, component[sources[inner]], marks[inner])
    return bool(met[component[sources[inner]]].all(axis=1).any())
