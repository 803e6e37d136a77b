"""What the paper defines, in the numbers of a plan: the fields of its run (Eq. 13 to 21), and delta_P (Eq. 25)."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import compile_to_alphabet
from mission.plan.flight_plan import FlightPlan
from mission.spec.model import Semantics
from mission.steering.facet_control import (
    affine_fields,
    exit_margins,
    exit_velocities,
    stay_equilibria,
    stay_margins,
    stay_velocities,
)
from mission.steering.moving_fields import MovingFields


class Condition(NamedTuple):
    """A row of Eq. 13 to 15 (of the matrix of Eq. 18), or of Eq. 21, as it holds in a triangle.

    Attributes:
        equation: Its number in the paper.
        row: What must not be negative, such as ``-n2 u1``, the paper's indices from 1.
        strict: Whether it must be positive.
        margin_m_s: By how much it holds.
    """

    equation: int
    row: str
    strict: bool
    margin_m_s: float


class InMotion(NamedTuple):
    """What holds of a field at every moment while its triangle moves (Sec. 4.4).

    Attributes:
        margin_m_s: By how much the tightest of its conditions holds, across the facets as they move.
        speed_m_s: The largest speed in space.
    """

    margin_m_s: float
    speed_m_s: float


@dataclass(frozen=True, eq=False)
class TriangleField:
    """The field of one triangle of a run under one control.

    Attributes:
        triangle: Which.
        vertices: Its three nodes, counter-clockwise.
        control: 0 to stay, j to leave through the facet opposite the j-th vertex.
        normals: Outward unit normals n_1 to n_3 of its facets, shape (3, 2).
        velocities_m_s: u_1 to u_3 at its vertices, shape (3, 2).
        F: Of u = F x + g (Eq. 16), shape (2, 2), 1/s.
        g: Shape (2,), m/s.
        conditions: What the velocities have to meet: Eq. 13 to 15, or to stay, Eq. 21.
        cost: J of Eq. 19, m^2/s^2.
        equilibrium_m: Where a field that stays comes to rest, ENU; None of one that leaves.
        in_motion: Where something moves: all else is of the triangle as it is at first.
    """

    triangle: int
    vertices: tuple[int, int, int]
    control: int
    normals: FloatArray
    velocities_m_s: FloatArray
    F: FloatArray
    g: FloatArray
    conditions: tuple[Condition, ...]
    cost: float
    equilibrium_m: FloatArray | None
    in_motion: InMotion | None = None


def fields_of_run(plan: FlightPlan) -> tuple[TriangleField, ...]:
    """The fields of the triangles that a plan's run passes, each once, in the order of the run.

    They are those of the paper's way; of a curve in a corridor they are the fields that its run stands for.
    """
    speed_m_s = plan.spec.flight.speed_m_s
    passed = dict.fromkeys(zip(plan.run.states, plan.run.controls, strict=True))
    whole = plan.partition
    fields = tuple(_field(whole, triangle, control, speed_m_s) for triangle, control in passed)
    if plan.moving is None:
        return fields
    velocities = np.stack([field.velocities_m_s for field in fields])
    moving = MovingFields(plan.moving, np.array([field.triangle for field in fields]), velocities)
    margins = moving.margins(np.array([field.control for field in fields]))
    figures = zip(margins.tolist(), moving.speeds_m_s.max(axis=0).tolist(), strict=True)
    return tuple(replace(field, in_motion=InMotion(*each)) for field, each in zip(fields, figures, strict=True))


def _field(whole: Partition, triangle: int, control: int, speed_m_s: float) -> TriangleField:
    one = Partition(whole.vertices_m, whole.triangles[[triangle]], np.full((1, 3), -1))
    if control:
        leaving = exit_velocities(one, speed_m_s)
        velocities = leaving[0, control - 1]
        conditions = tuple(_leaving(control - 1, exit_margins(one, leaving)[0, control - 1]))
    else:
        staying = stay_velocities(one, speed_m_s)
        velocities = staying[0]
        conditions = tuple(_staying(stay_margins(one, staying)[0]))
    F, g = affine_fields(one.corners_m[0], velocities)
    first, second, third = one.triangles[0].tolist()
    return TriangleField(
        triangle,
        (first, second, third),
        control,
        one.normals[0],
        velocities,
        F,
        g,
        conditions,
        float(((speed_m_s - np.linalg.norm(velocities, axis=1)) ** 2).sum()),
        None if control else stay_equilibria(one)[0],
    )


def _leaving(j: int, margins: FloatArray) -> Iterator[Condition]:
    """The rows of ``exit_margins`` by their names."""
    out, first, second = j + 1, (j + 1) % 3 + 1, (j + 2) % 3 + 1
    rows = (
        (13, f"-n{first} u{out}", False),
        (13, f"-n{second} u{out}", False),
        (13, f"-(n{first} + n{second}) u{out}", True),
        (14, f"n{out} u{first}", True),
        (14, f"-n{second} u{first}", False),
        (15, f"n{out} u{second}", True),
        (15, f"-n{first} u{second}", False),
    )
    for (equation, row, strict), margin in zip(rows, margins.tolist(), strict=True):
        yield Condition(equation, row, strict, margin)


def _staying(margins: FloatArray) -> Iterator[Condition]:
    """The rows of ``stay_margins`` by their names."""
    for vertex in range(3):
        for facet, margin in zip(((vertex + 1) % 3, (vertex + 2) % 3), margins[vertex].tolist(), strict=True):
            yield Condition(21, f"-n{facet + 1} u{vertex + 1}", strict=False, margin_m_s=margin)


class ProductStep(NamedTuple):
    """(x, q), u -> (x', q')."""

    triangle: int
    state: int
    control: int
    to_triangle: int
    to_state: int


def product_steps(plan: FlightPlan) -> tuple[ProductStep, ...]:
    """delta_P of Eq. 25 so far as it can be reached from the start, by state and then by control.

    The states of A are those of the automaton that is shown; of a specification of several automata, those of the
    deterministic one of all of them.
    """
    letter_of = plan.labelling.letter_of.tolist()
    reads: dict[tuple[int, int], list[int]] = {}
    if plan.shown_parts == 1:
        compiled = compile_to_alphabet(plan.shown_automaton, plan.labelling.letters)
        initial = compiled.initial.tolist()
        rows = np.column_stack((compiled.sources, compiled.letters, compiled.targets)).tolist()
    else:
        whole = plan.deterministic
        initial = [whole.initial] if whole.initial >= 0 else []
        rows = [[q, letter, to] for (q, letter), to in np.ndenumerate(whole.targets) if to >= 0]
    for source, letter, target in rows:
        reads.setdefault((source, letter), []).append(int(target))
    start = plan.run.states[0]
    if plan.spec.semantics is Semantics.STANDARD:
        initial = sorted({to for q in initial for to in reads.get((q, letter_of[start]), ())})
    successors = plan.successors.tolist()
    seen, waiting = {(start, q) for q in initial}, deque((start, q) for q in initial)
    steps = []
    while waiting:
        triangle, state = waiting.popleft()
        for control, entered in enumerate(successors[triangle]):
            for to in reads.get((state, letter_of[entered]), ()) if entered >= 0 else ():
                steps.append(ProductStep(triangle, state, control, entered, to))
                if (entered, to) not in seen:
                    seen.add((entered, to))
                    waiting.append((entered, to))
    return tuple(sorted(steps))
