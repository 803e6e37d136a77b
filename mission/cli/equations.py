"""``mission plan --equations`` and the tables of ``--transitions``: what the paper defines, in a plan's numbers."""

from collections.abc import Sequence
from itertools import groupby
from typing import Final

from mission.cli.screen import out
from mission.geometry.arrays import FloatArray
from mission.plan import FlightPlan
from mission.plan.definitions import Condition, TriangleField, fields_of_run, product_steps

_DIGITS: Final = 12
"""Behind the point: what is beyond is rounding."""


def print_equations(plan: FlightPlan) -> None:
    """Each field of the run: normals, vertex velocities, F and g, the conditions with their margins, and J."""
    out.out(f"\nFields of the run, u = F x + g (Eq. 16), c = {plan.spec.flight.speed_m_s:g} m/s; margins in m/s")
    for field in fields_of_run(plan):
        _print_field(field)


def equations(plan: FlightPlan) -> list[dict[str, object]]:
    """The same for programs."""
    return [
        {
            "triangle": field.triangle,
            "vertices": list(field.vertices),
            "control": field.control,
            "normals": field.normals.tolist(),
            "velocities_m_s": field.velocities_m_s.tolist(),
            "F": field.F.tolist(),
            "g": field.g.tolist(),
            "conditions": [condition._asdict() for condition in field.conditions],
            "cost": field.cost,
            "equilibrium_m": None if field.equilibrium_m is None else field.equilibrium_m.tolist(),
            **({} if field.in_motion is None else {"in_motion": field.in_motion._asdict()}),
        }
        for field in fields_of_run(plan)
    ]


def print_product(plan: FlightPlan) -> None:
    """delta_P of Eq. 25, so far as it can be reached, a line for each state."""
    steps = product_steps(plan)
    several = "" if plan.shown_parts == 1 else "; q are those of the deterministic automaton of all parts"
    reached = len({(step.triangle, step.state) for step in steps})
    out.out(f"\nTransitions of P, of the {reached:,} states that are reached: (x, q), u -> (x', q'){several}")
    for (triangle, state), leaving in groupby(steps, key=lambda step: step[:2]):
        moves = "   ".join(f"u{step.control} -> ({step.to_triangle}, q{step.to_state})" for step in leaving)
        out.out(f"  ({triangle}, q{state})".ljust(12) + moves)


def _print_field(field: TriangleField) -> None:
    through = f"leaves through facet {field.control}" if field.control else "stays"
    out.out(f"\n  T{field.triangle} ({' '.join(map(str, field.vertices))}), u{field.control}: {through}")
    _line("normals", "   ".join(f"n{i} = {_vector(n)}" for i, n in enumerate(field.normals, 1)))
    _line("velocities", "   ".join(f"u{i} = {_vector(u)}" for i, u in enumerate(field.velocities_m_s, 1)) + " m/s")
    _line("field", f"F = [{_vector(field.F[0])}, {_vector(field.F[1])}] 1/s   g = {_vector(field.g)} m/s")
    for equation, conditions in groupby(field.conditions, key=lambda condition: condition.equation):
        _line(f"Eq. {equation}", _conditions(tuple(conditions)))
    if field.equilibrium_m is not None:
        _line("rest at", f"{_vector(field.equilibrium_m)} m")
    if field.in_motion is not None:
        margin, speed = field.in_motion
        _line("in motion", f"all of that by {margin:.4g} at least, at any time; at most {speed:.4g} m/s in space")
    _line("Eq. 19", f"J = {round(field.cost, _DIGITS):.3g} m^2/s^2")


def _conditions(conditions: Sequence[Condition]) -> str:
    return "   ".join(f"{each.row} = {each.margin_m_s:.4g} {'>' if each.strict else '>='} 0" for each in conditions)


def _vector(values: FloatArray) -> str:
    return "(" + ", ".join(f"{round(value, _DIGITS) + 0.0:.5g}" for value in values.tolist()) + ")"


def _line(name: str, words: str) -> None:
    out.out(f"    {name:<11}{words}")
