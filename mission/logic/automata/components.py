"""Strongly connected components of directed graphs given as lists of successors."""

from collections.abc import Iterable, Sequence


def strong_components(successors: Sequence[Iterable[int]], roots: Iterable[int]) -> list[list[int]]:
    """The strongly connected components that ``roots`` reach, each before those that lead to it.

    Source: Tarjan, "Depth-first search and linear graph algorithms" (1972), with an explicit stack.
    """
    number: dict[int, int] = {}
    lowest: dict[int, int] = {}
    done: set[int] = set()
    path: list[int] = []
    components: list[list[int]] = []
    for root in roots:
        if root in number:
            continue
        number[root] = lowest[root] = len(number)
        path.append(root)
        pending = [(root, iter(successors[root]))]
        while pending:
            vertex, rest = pending[-1]
            for target in rest:
                if target not in number:
                    number[target] = lowest[target] = len(number)
                    path.append(target)
                    pending.append((target, iter(successors[target])))
                    break
                if target not in done:
                    lowest[vertex] = min(lowest[vertex], number[target])
            else:
                pending.pop()
                if pending:
                    parent = pending[-1][0]
                    lowest[parent] = min(lowest[parent], lowest[vertex])
                if lowest[vertex] == number[vertex]:
                    component = [path.pop()]
                    while component[-1] != vertex:
                        component.append(path.pop())
                    done.update(component)
                    components.append(component)
    return components


def reachable(successors: Sequence[Iterable[int]], start: int) -> set[int]:
    """Every vertex that ``start`` reaches, itself included."""
    found = {start}
    pending = [start]
    while pending:
        for vertex in successors[pending.pop()]:
            if vertex not in found:
                found.add(vertex)
                pending.append(vertex)
    return found


def backward_reachable(successors: Sequence[Iterable[int]], goals: Iterable[int]) -> set[int]:
    """Every vertex from which one of ``goals`` can be reached, the goals included."""
    predecessors: list[list[int]] = [[] for _ in successors]
    for vertex, targets in enumerate(successors):
        for target in targets:
            predecessors[target].append(vertex)
    found = set(goals)
    pending = sorted(found)
    while pending:
        for vertex in predecessors[pending.pop()]:
            if vertex not in found:
                found.add(vertex)
                pending.append(vertex)
    return found
