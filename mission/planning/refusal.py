"""Why there is no accepting run: the first reason that is of use to the writer of the mission."""

import numpy as np

from mission.geometry.arrays import IntArray
from mission.planning.product import UNREACHED, Product
from mission.planning.transition_system import TransitionSystem


def start_refusal(product: Product) -> str:
    """For an automaton that rejects the label of the start triangle."""
    label = ", ".join(sorted(product.system.letters[product.system.letter_of[product.start]])) or "no region"
    return f"the formula is violated where the flight starts, in triangle {product.start} ({label})"


def reach_refusal(product: Product) -> str:
    """For accepting states that no run reaches."""
    return f"no run satisfies the formula: {_how_far(product)}"


def loop_refusal(product: Product) -> str:
    """For accepting states that can be reached, but not again and again."""
    return f"the formula asks for something again and again that can happen only finitely often: {_how_far(product)}"


def _how_far(product: Product) -> str:
    """Which regions can be reached before the formula is violated, and what keeps the vehicle from the others."""
    system = product.system
    x, _ = product.parts(np.flatnonzero(product.distances != UNREACHED).astype(np.int32))
    reached = _regions(system, x)
    missed = sorted(set[str]().union(*system.letters) - reached)
    text = f"from triangle {product.start} the flight can reach {', '.join(sorted(reached)) or 'no region'}"
    if not missed:
        return text
    cut_off = [name for name in missed if name not in _regions(system, _connected(system, product.start))]
    text = f"{text}, but not {', '.join(missed)}"
    if not cut_off:
        return f"{text} (only by violating the formula)"
    return f"{text} ({', '.join(cut_off)}: no way leads there, whatever the formula)"


def _regions(system: TransitionSystem, triangles: IntArray) -> set[str]:
    return set[str]().union(*(system.letters[i] for i in np.unique(system.letter_of[triangles]).tolist()))


def _connected(system: TransitionSystem, start: int) -> IntArray:
    """The triangles that controls lead to from ``start``, it included."""
    seen = np.zeros(system.size, dtype=np.bool_)
    frontier = np.array([start])
    while len(frontier):
        seen[frontier] = True
        entered = np.unique(system.successors[frontier])
        frontier = entered[(entered >= 0) & ~seen[entered]]
    return np.flatnonzero(seen)
