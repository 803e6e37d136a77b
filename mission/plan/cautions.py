"""What the writer of a mission that can be flown may not have meant."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton, CompiledAutomaton, compile_to_alphabet
from mission.logic.automata.conversion import with_accepting_states
from mission.logic.automata.stutter import tells_repeats_apart
from mission.logic.automata.translate import translate
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import Formula, negation, postorder, propositions
from mission.logic.formula.word import Letter
from mission.plan.missing_letters import violated_by_first
from mission.spec.model import Flight, Limits, NamedAutomaton, Region, RegionKind, Semantics
from mission.spec.specification import Specification
from mission.spec.windows import window_text

_HIGHEST_M: Final = 120.0
"""Above ground: the open category of the EU, Regulation 2019/947, UAS.OPEN.010; 14 CFR 107.51 has 400 feet."""


def cautions(
    specification: Specification,
    letters: tuple[Letter, ...],
    start: int,
    semantics: Semantics,
    covered: frozenset[str] = frozenset(),
) -> tuple[str, ...]:
    """Warnings for a specification that a plan satisfies: for its automaton, and conjunct by conjunct.

    A part already holds at the start where every word over the labels of the map that begins with the start's
    satisfies it, and asks nothing where every word does. One with ``X``, and an automaton that counts repeats, may mean
    another thing on another mesh.

    Args:
        specification: The specification.
        letters: The observations of the map.
        start: Number of the start triangle's letter.
        semantics: Whether that letter is read.
        covered: Names of regions that are covered: a part that speaks of one asks for that, whatever else.
    """
    found: list[str] = []
    if specification.given and specification.outside:
        name = f"the automaton {specification.given.file}"
        found += _of_automaton(name, specification.given, specification.outside, letters)
        found += _of_empty(name, compile_to_alphabet(specification.outside, letters), letters, start, semantics)
    for conjunct in conjuncts(specification.formula):
        found += _of_next(conjunct)
        if covered.isdisjoint(propositions(conjunct)):
            found += _of_conjunct(conjunct, letters, start, semantics)
    return tuple(found)


def flight_cautions(flight: Flight, limits: Limits) -> tuple[str, ...]:
    """Warnings for how a mission is to be flown, whatever it is about."""
    found: list[str] = []
    if flight.altitude_m > _HIGHEST_M:
        found.append(
            f"flight.altitude_m: {flight.altitude_m:.12g} m above the take-off point is more than the {_HIGHEST_M:g} m "
            "above ground to which drones are limited in most countries without a permission"
        )
    if flight.speed_m_s > limits.speed_m_s:
        found.append(
            f"flight.speed_m_s: {flight.speed_m_s:.12g} m/s is above limits.speed_m_s, so it is flown at "
            f"{limits.speed_m_s:.12g} m/s at most; where the vehicle can, write "
            f"`limits: {{speed_m_s: {flight.speed_m_s:.12g}}}`"
        )
    return tuple(found)


def window_cautions(regions: Iterable[Region]) -> tuple[str, ...]:
    """What does not guard a flight from restricted regions that are there for a time only, or move."""
    guarded = "no part of the vehicle's own geofence, which stands all the time"
    return tuple(
        f"regions.{region.name}: it {'moves' if region.forbidden else f'is restricted {window_text(region)} alone'}, "
        f"and is {guarded}"
        for region in regions
        if region.kind is RegionKind.RESTRICTED and (region.motion is not None or not region.forbidden)
    )


def _of_automaton(
    name: str, given: NamedAutomaton, outside: BuchiAutomaton, letters: tuple[Letter, ...]
) -> Iterator[str]:
    with suppress(AutomatonSizeError):
        if tells_repeats_apart(with_accepting_states(given.automaton), outside, letters):
            yield f"{name} may depend on the mesh: it counts how many triangles of the same labels follow each other"


def _of_next(conjunct: Formula) -> Iterator[str]:
    if any(node.operator is Operator.NEXT for node in postorder(conjunct)):
        yield (
            f"`{conjunct}` may depend on the mesh: X speaks of the next triangle on the way, "
            "or of the same one where the vehicle stays"
        )


def _of_conjunct(conjunct: Formula, letters: tuple[Letter, ...], start: int, semantics: Semantics) -> Iterator[str]:
    with suppress(AutomatonSizeError):
        refutation = compile_to_alphabet(translate(negation(conjunct)), letters)
        yield from _of_empty(f"`{conjunct}`", refutation, letters, start, semantics)


def _of_empty(
    name: str, refutation: CompiledAutomaton, letters: tuple[Letter, ...], start: int, semantics: Semantics
) -> Iterator[str]:
    """Whether a part of a specification asks nothing, or nothing of what comes after the start."""
    if all(violated_by_first(refutation, letter) for letter in range(len(letters))):
        yield f"{name} asks nothing: every flight on this map satisfies it"
    elif semantics is Semantics.STANDARD and violated_by_first(refutation, start):
        where = ", ".join(sorted(letters[start])) or "no region"
        yield f"{name} already holds where the flight starts ({where}): it asks nothing of the rest"
