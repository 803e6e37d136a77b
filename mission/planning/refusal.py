"""Why there is no accepting run: the first reason that is of use to the writer of the mission."""

from collections.abc import Iterable

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from mission.geometry.arrays import IntArray
from mission.logic.automata.rabin import DEAD
from mission.planning.product import Product
from mission.planning.transition_system import TransitionSystem


def refusal(product: Product) -> str:
    """The reason for a product without accepting runs.

    Asked in this order: does any word over the map's labels satisfy the formula, may the flight start where it does,
    can it take a transition that an accepting run takes again and again.
    """
    system = product.system
    if product.automaton.whole.initial == DEAD:
        regions = ", ".join(sorted(set[str]().union(*system.letters))) or "none"
        return (
            "no flight whatever satisfies the specification: it contradicts itself, or asks for regions together, or "
            f"for a region, that no triangle has (regions of this map: {regions})"
        )
    if not len(product.initial):
        label = _listed(system.letters[system.letter_of[product.start]])
        return f"the specification is violated where the flight starts, in triangle {product.start} ({label})"
    if not _recurs(product):
        return f"no run satisfies the specification: {_how_far(product)}"
    return (
        f"the specification asks for something again and again that can happen only finitely often: {_how_far(product)}"
    )


def _recurs(product: Product) -> bool:
    """Whether the flight can do all that it must do again and again once, one after the other."""
    waiting = product.along(product.automaton.in_turn()) if len(product.automaton.whole.pairs) == 1 else product
    marks = waiting.out(np.flatnonzero(np.isfinite(waiting.distances))).marks
    return any(bool((marks & inf).any()) for _, inf in waiting.automaton.whole.pairs)


def _how_far(product: Product) -> str:
    """Which regions can be reached before the formula is violated, and what keeps the vehicle from the others."""
    system = product.system
    x, _ = product.parts(np.flatnonzero(np.isfinite(product.distances)))
    reached = _regions(system, x)
    connected = _regions(system, _connected(system, product.start))
    text = f"from triangle {product.start} the flight can reach {_listed(reached)}"
    if cut_off := set[str]().union(*system.letters) - connected - reached:
        text += f", but not {_listed(cut_off)}: no open way leads there"
    if connected - reached:
        text += f"; it can reach {_listed(connected - reached)} only by violating the specification"
    return text


def _listed(names: Iterable[str]) -> str:
    return ", ".join(sorted(names)) or "no region"


def _regions(system: TransitionSystem, triangles: IntArray) -> set[str]:
    return set[str]().union(*(system.letters[i] for i in np.unique(system.letter_of[triangles]).tolist()))


def _connected(system: TransitionSystem, start: int) -> IntArray:
    """The triangles that controls lead to from ``start``, it included."""
    rows, controls = np.nonzero(system.successors >= 0)
    ends = rows, system.successors[rows, controls]
    graph = coo_array((np.ones(len(rows), dtype=np.int8), ends), shape=(system.size, system.size)).tocsr()
    return np.asarray(breadth_first_order(graph, start, return_predecessors=False), dtype=np.int64)
