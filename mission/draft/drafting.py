"""A commented mission file of what other programs have drawn, which plans as it is."""

import json
import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from mission.decimals import decimal
from mission.draft.cameras import ALTITUDE_M, agrees, camera_keys
from mission.draft.frame import frame_of
from mission.draft.layout import USUAL, Guesses, Layout, laid_out
from mission.draft.pieces import Piece, pieces_of
from mission.draft.turns import turns_of
from mission.errors import Fault, FormulaSyntaxError, SpecError
from mission.interchange.features import Drawing, Feature
from mission.interchange.roles import role_of
from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import propositions, written_name
from mission.printable import printable
from mission.spec.model import CORRIDOR, Cost
from mission.spec.schema import default_of

_WIDTH: Final = 118
_LONGEST_STAY_S: Final = 86_400.0
SPEED_M_S: Final = 5.0
_NEVER: Final = "restricted ones are never entered, whatever the formula says"
_MOST_VISITED: Final = 90
"""A formula of more in a row would be nested too deeply."""

_MOST_IN_ANY_ORDER: Final = 5
"""Of more regions, the orders would be too many to search: they are visited in a row, each time the nearest."""


@dataclass(frozen=True)
class Draft:
    """A mission file that was drafted.

    Attributes:
        text: Of the file.
        guessed: Names of the regions to survey whose lanes no file tells of.
        tube_guessed: Whether no file tells what the proof is to allow for.
        remarks: What of the files was left out, or read in a way that should be known.
    """

    text: str
    guessed: tuple[str, ...]
    tube_guessed: bool
    remarks: tuple[str, ...]


def draft_mission(
    drawings: Sequence[tuple[str, Drawing]], name: str, guesses: Guesses = USUAL, notes: Sequence[str] = ()
) -> Draft:
    """A mission file of drawings.

    Args:
        drawings: One at least, each with the name of its file without its ending.
        name: Of the mission.
        guesses: For what no file tells.
        notes: What else is to be said at its top.

    Raises:
        SpecError: Some drawings are in degrees and others in metres, or they reach farther than a mission can.
    """
    if len({drawing.in_degrees for _, drawing in drawings}) > 1:
        metres = ", ".join(file for file, drawing in drawings if not drawing.in_degrees)
        message = f"the coordinates of {metres} are metres, those of the other files are degrees"
        raise SpecError((Fault(0, 0, "", message, "import files of one kind together"),))
    in_degrees = drawings[0][1].in_degrees
    frame = frame_of((point for _, drawing in drawings for point in drawing.points()), in_degrees=in_degrees)
    alone = len(drawings) == 1
    features = [feature for file, drawing in drawings for feature in _told(drawing, file, alone=alone)]
    route = [place for _, drawing in drawings for place in drawing.route]
    flights = [drawing for _, drawing in drawings if drawing.formula]
    flight = flights[0] if len(flights) == 1 else None
    turns, of_route = turns_of(route, features, frame)
    layout = laid_out(
        pieces_of([*features, *turns], frame),
        frame,
        route=route,
        start=flight.start if flight else None,
        tube_m=flight.tube_m if flight else None,
        guesses=guesses,
    )
    remarks = [remark for _, drawing in drawings for remark in drawing.remarks] + of_route + list(layout.remarks)
    if len(layout.visited) > _MOST_VISITED:
        left = f"of {len(layout.visited)} regions to survey, the first {_MOST_VISITED} are asked for"
        remarks.append(f"{left}: draw those that belong together as one feature of several parts")
    altitude_m = max((drawing.altitude_m for _, drawing in drawings if drawing.altitude_m), default=None)
    speed_m_s = max((drawing.speed_m_s for _, drawing in drawings if drawing.speed_m_s), default=None)
    sources = ", ".join(f"{file} ({drawing.format})" for file, drawing in drawings)
    lines = list(_comment(f"Drafted from {sources}. Questions are about what the drawing does not tell."))
    lines += [line for note in notes for line in _comment(note)]
    lines += [line for remark in remarks for line in _comment(f"Note: {remark}.")]
    lines.append(f"name: {json.dumps(printable(name), ensure_ascii=False)}")
    if frame.origin:
        place = (
            f"latitude_deg: {decimal(frame.origin.latitude_deg)}, longitude_deg: {decimal(frame.origin.longitude_deg)}"
        )
        lines += ["", f"origin: {{{place}}}"]
    elif frame.shift_m != (0.0, 0.0):
        shift = f"[{decimal(frame.shift_m[0])}, {decimal(frame.shift_m[1])}]"
        lines += ["", *_comment(f"{shift} is taken from all coordinates of the file. Where on Earth is [0, 0]?")]
    lines += ["", "domain:", *(["  corners: latitude_longitude"] if frame.origin else [])]
    lines += [*_comments(layout.boundary, "  "), *_boundary(layout.boundary), "", "regions:"]
    lines += [line for piece in layout.regions for line in _region(piece, layout, altitude_m)]
    formula = _kept_formula(flight.formula, layout) if flight else ""
    if flight is not None and not formula:
        lines += ["", *_comment(f"The flight in the file had to satisfy {flight.formula}: not all of that is here.")]
    lines += [
        "",
        *_mission(layout, formula, flight.laps if flight else ""),
        "",
        "start:",
        f"  position_m: {layout.start}",
        "",
    ]
    lines += _flight(altitude_m, speed_m_s, layout)
    if flight is not None and flight.cost in set(Cost):
        lines += ["", f"search: {{cost: {flight.cost}}}"]
    if flight is None or flight.smoothing == CORRIDOR:
        lines += ["", f"smoothing: {CORRIDOR}"]
    guessed = tuple(piece.name for piece in layout.regions if piece.name in layout.covered and not piece.lanes)
    return Draft("\n".join(lines) + "\n", guessed, flight is None or flight.tube_m is None, tuple(remarks))


def _told(drawing: Drawing, file: str, *, alone: bool) -> Iterator[Feature]:
    """Features; the file's name is that of those without one, and beside other files it may tell what they are."""
    for feature in drawing.features:
        named = replace(feature, name=feature.name or file)
        role, _ = (None, "") if alone or feature.role else role_of({}, file, ())
        yield replace(named, role=role, reason="told by its file's name") if role else named


def _boundary(piece: Piece) -> Iterator[str]:
    if len(piece.keys) == 1 and piece.keys[0][0] == "polygon":
        yield from _entry("  boundary", piece.keys[0][1])
    else:
        yield "  boundary:"
        for key, value in piece.keys:
            yield from _entry(f"    {key}", value)
    if piece.clearance_m:
        yield f"  clearance_m: {decimal(piece.clearance_m)}"


def _region(piece: Piece, layout: Layout, altitude_m: float | None) -> Iterator[str]:
    yield from _comments(piece, "  ")
    plain = piece.name.isascii() and piece.name.isidentifier()
    yield f"  {piece.name if plain else json.dumps(piece.name, ensure_ascii=False)}:"
    yield f"    kind: {piece.role}"
    for key, value in piece.keys:
        yield from _entry(f"    {key}", value)
    if piece.clearance_m:
        yield f"    clearance_m: {decimal(piece.clearance_m)}"
    if piece.loiter_s:
        yield f"    loiter_s: {decimal(min(piece.loiter_s, _LONGEST_STAY_S))}"
    if piece.name not in layout.covered:
        return
    spacing_m, lanes = layout.covered[piece.name], piece.lanes
    yield "    # as it was planned before" if lanes else "    # how far apart are the lanes to be?"
    values = {"spacing_m": decimal(spacing_m), "heading_deg": "auto"}
    if lanes is not None:
        if lanes.camera and agrees(lanes.camera, lanes.spacing_m, altitude_m or ALTITUDE_M):
            values = {"camera": camera_keys(lanes.camera), "heading_deg": "auto"}
        values |= {} if lanes.heading_deg is None else {"heading_deg": decimal(lanes.heading_deg % 360.0)}
        values |= {} if lanes.share is None else {"share": decimal(lanes.share)}
    yield from _entry("    cover", "{" + ", ".join(f"{key}: {value}" for key, value in values.items()) + "}")


def _kept_formula(text: str, layout: Layout) -> str:
    """The formula that a file's flight satisfied, if all that it speaks of is there; empty otherwise."""
    names = frozenset(piece.name for piece in layout.regions)
    try:
        return text if propositions(parse_timed_formula(text, names)) <= names else ""
    except FormulaSyntaxError:
        return ""


def _mission(layout: Layout, formula: str, laps: str) -> Iterator[str]:
    if formula:
        yield from _comment("As the flight in the file had to satisfy it.")
        yield "mission:"
        yield from _entry("  formula", _quoted(formula))
        if laps:
            yield f"  laps: {laps}"
        return
    homes = " | ".join(map(written_name, layout.homes))
    end = f"F G ({homes})" if len(layout.homes) > 1 else f"F G {homes}"
    visits = [*map(written_name, layout.visited[:_MOST_VISITED])]
    if not visits:
        yield from _comment("Nothing is there to be surveyed: the vehicle starts and lands. What should it visit?")
        formula = end
    elif len(visits) <= _MOST_IN_ANY_ORDER and not layout.ordered:
        yield from _comment(f"Every region to survey, in any order, then home; {_NEVER}.")
        formula = " & ".join([*(f"F {visit}" for visit in visits), end])
    else:
        yield from _comment(f"Every region to survey, one after the other, then home; {_NEVER}.")
        formula = end
        for visit in reversed(visits):
            formula = f"F ({visit} & {formula})"
    yield "mission:"
    yield from _entry("  formula", _quoted(formula) if '"' in formula else formula)


def _quoted(formula: str) -> str:
    """A formula in YAML's single quotes, in which whatever its names have in them stays as it is."""
    return "'" + formula.replace("'", "''") + "'"


def _flight(altitude: float | None, speed: float | None, layout: Layout) -> Iterator[str]:
    asked = [what for what, value in (("high", altitude), ("fast", speed)) if value is None]
    if asked:
        yield from _comment(f"How {' and how '.join(asked)} is it to be flown?")
    speed_m_s = min(max(speed or SPEED_M_S, 0.5), 20.0)
    yield "flight:"
    yield f"  speed_m_s: {decimal(speed_m_s)}"
    yield f"  altitude_m: {decimal(min(max(altitude or ALTITUDE_M, 2.0), 500.0))}"
    yield f"  disturbance_m_s2: {decimal(layout.tube_m)}"
    if speed_m_s > default_of("limits", "speed_m_s"):
        yield from ("", "limits:", f"  speed_m_s: {decimal(speed_m_s)}")


def _comments(piece: Piece, indent: str) -> Iterator[str]:
    for comment in piece.comments:
        yield from _comment(comment, indent)


def _comment(text: str, indent: str = "") -> Iterator[str]:
    # What a file brings along is on one line here, and shows.
    shown = re.sub("[^\t -~\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", printable(" ".join(text.split())))
    yield from textwrap.wrap(shown, _WIDTH, initial_indent=f"{indent}# ", subsequent_indent=f"{indent}# ")


def _entry(key: str, value: str) -> Iterator[str]:
    """A key and its value, on as many lines as it takes."""
    indent = " " * (len(key) - len(key.lstrip()) + 2)
    yield from textwrap.wrap(
        f"{key}: {value}", _WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
