"""A draft that plans: what it guesses is made less where there is no plan with it, and what keeps it is told."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from mission.decimals import decimal
from mission.draft.drafting import Draft, draft_mission
from mission.draft.layout import USUAL, Guesses
from mission.errors import MissionError, NoPlanError, SpecError
from mission.interchange.features import Drawing
from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

_TUBE_SHARES: Final = (0.4, 0.1)


@dataclass(frozen=True, eq=False)
class Trial:
    """A draft and what came of planning it.

    Attributes:
        draft: The mission file.
        plan: Its plan; None where there is none.
        error: Why there is none.
    """

    draft: Draft
    plan: FlightPlan | None
    error: MissionError | None = None


def draft_that_plans(drawings: Sequence[tuple[str, Drawing]], name: str) -> Trial:
    """A mission file of drawings that plans as it is, if guessing otherwise can do it.

    Args:
        drawings: One at least, each with the name of its file without its ending.
        name: Of the mission.

    Raises:
        SpecError: The drawings make no mission, as in ``draft_mission``.
    """
    first = _tried(draft_mission(drawings, name))
    if first.error is None:
        return first
    why = _line(first.error)
    for guesses in _others(first):
        plain = _tried(draft_mission(drawings, name, guesses))
        if plain.plan is not None:
            notes = [f"{said} Otherwise: {why}" for said in _changed(plain.plan.spec, guesses)]
            return replace(plain, draft=draft_mission(drawings, name, guesses, notes))
    told = draft_mission(drawings, name, USUAL, [f"It does not plan as it is: {why}"])
    if isinstance(first.error, SpecError):
        return _tried(told)  # its places are those of the file as it is written
    return replace(first, draft=told)


def _tried(draft: Draft) -> Trial:
    try:
        return Trial(draft, plan_mission(parse_mission(draft.text.encode())))
    except MissionError as error:
        return Trial(draft, None, error)


def _others(first: Trial) -> Iterator[Guesses]:
    """What else can be guessed: a narrower tube, no lanes where they do not fit, no lanes that nobody asked for."""
    shares = _TUBE_SHARES if first.draft.tube_guessed else (1.0,)
    guessed = frozenset(first.draft.guessed)
    if first.draft.tube_guessed:
        yield from (Guesses(share) for share in shares)
    if not isinstance(first.error, NoPlanError):
        return  # no lanes are at fault
    blamed = guessed & frozenset(first.error.regions)
    for dropped in dict.fromkeys((blamed, guessed)):
        if dropped:
            yield from (Guesses(share, dropped) for share in shares)


def _changed(spec: MissionSpec, guesses: Guesses) -> Iterator[str]:
    """What is other than usual in a draft, in sentences."""
    if guesses.tube_share != USUAL.tube_share:
        yield f"The proof allows for a disturbance of {decimal(spec.flight.disturbance_m_s2)} m/s2 only."
    if guesses.only_visited:
        names = ", ".join(sorted(guesses.only_visited))
        yield f"Of what is surveyed, no lanes cover {names}: it is only visited."


def _line(error: MissionError) -> str:
    """An error on one line."""
    if isinstance(error, SpecError):
        return "; ".join(f"{fault.message} {fault.hint}".strip() for fault in error.faults)
    return " ".join(str(error).split())
