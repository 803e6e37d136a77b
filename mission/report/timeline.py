"""What happened in a flight, in the order of time: what matters, the commands with their answers, and all of it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from mission.monitor.gaps import Missing
from mission.report.markup import text_of
from mission.report.reading import Entry, Record

SEVERITIES: Final = ("emergency", "alert", "critical", "error", "warning", "notice", "info", "debug")
PREFLIGHT: Final = "preflight"
"""The event that holds the table of the check before the flight."""
COMMAND, ANSWER, STAGE = "command", "answer", "stage"
_WARNING: Final = SEVERITIES.index("warning")
_ACCEPTED: Final = "accepted"
_LONGEST: Final = 160
_ASKS: Final = ("send ", "set the rate of ")
"""So begin the commands that ask a vehicle for its messages: they are many, and what does not come is asked again."""
# What somebody asked of the flight is told as an intention, with what came of it.
_ROUTINE: Final = frozenset({COMMAND, ANSWER, PREFLIGHT, "firmware", "anchored", "request", "request answered"})

Values = Mapping[str, Any]


@dataclass(frozen=True)
class Moment:
    """Something that happened: when, what in plain words, and who says so."""

    t_s: float
    what: str
    source: str


@dataclass(frozen=True)
class Order:
    """A command: when it was given first, how often, and what was answered last, after how long."""

    t_s: float
    command: str
    attempts: int
    answer: str
    after_s: float | None


def _gap(values: Values) -> str:
    what = "no position was told" if values.get("missing") == Missing.POSITION else "the trajectory paused"
    return f"{what} for {float(values['for_s']):.1f} s"


def _violation(values: Values) -> str:
    names = ", ".join(map(str, values.get("names") or ()))
    return f"the vehicle {values['violation']}" + (f" ({names})" if names else "")


def _planned(values: Values) -> str:
    duration = values.get("duration_s")
    length = "" if duration is None else f": a trajectory of {float(duration):.1f} s"
    return f"planned for where the vehicle stands{length}"


_IN_WORDS: Final[Mapping[str, Callable[[Values], str]]] = {
    STAGE: lambda values: str(values["stage"]),
    "gap": _gap,
    "violation": _violation,
    "planned": _planned,
    "leg": lambda values: f"plan {values['number']} is flown from here on: {values.get('reason') or 'no reason told'}",
    "intention": lambda values: str(values["reason"]),
    "stop": lambda values: f"given up: {values['reason']}",
    "geofence": lambda values: f"the geofence of the mission is set, {len(values.get('items') or ())} items",
    "failure": lambda _: "an error of this program ended the flight",
}


def moments(record: Record) -> list[Moment]:
    """What matters of a flight; the rest is routine."""
    found = [Moment(event.t_s, in_words(event), "flight") for event in record.events if event.text not in _ROUTINE]
    found += [
        Moment(text.t_s, text.text, f"vehicle, {severity_of(text)}")
        for text in record.texts
        if isinstance(text.values.get("severity"), int) and text.values["severity"] <= _WARNING
    ]
    found += [
        Moment(order.t_s, f"{order.command}: {order.answer}, asked {_times(order.attempts)}", "command")
        for order in orders(record)
        if (order.answer != _ACCEPTED or order.attempts > 1) and not order.command.startswith(_ASKS)
    ]
    return sorted(found, key=_when)


def orders(record: Record) -> list[Order]:
    """The commands of a flight, each with its answer; what was asked again is one with its first attempt."""
    found: list[Order] = []
    open_at: dict[str, int] = {}
    for event in record.events:
        if event.text not in (COMMAND, ANSWER):
            continue
        name = str(event.values.get("command"))
        at = open_at.get(name)
        if event.text == COMMAND and (at is None or not event.values.get("attempt")):
            open_at[name] = len(found)
            found.append(Order(event.t_s, name, 1, "no answer", None))
        elif at is not None:
            order = found[at]
            asked = event.text == COMMAND
            found[at] = Order(
                order.t_s,
                name,
                order.attempts + asked,
                order.answer if asked else str(event.values.get("result")),
                order.after_s if asked else event.t_s - order.t_s,
            )
    return found


def everything(record: Record) -> list[Moment]:
    """All events and messages of a flight with all their values."""
    found = [Moment(event.t_s, _whole(event), "event") for event in record.events if event.text != PREFLIGHT]
    found += [Moment(text.t_s, _whole(text), severity_of(text)) for text in record.texts]
    return sorted(found, key=_when)


def in_words(event: Entry) -> str:
    """An event in plain words; one that nothing is known of by its name and values."""
    told = _IN_WORDS.get(event.text)
    if told is not None:
        try:
            return told(event.values)
        except (KeyError, TypeError, ValueError, OverflowError):  # of another version, or damaged
            pass
    if "reason" in event.values:
        return f"{event.text}: {event.values['reason']}"
    text = _whole(event)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def severity_of(text: Entry) -> str:
    """What MAVLink calls it."""
    value = text.values.get("severity")
    return SEVERITIES[value] if isinstance(value, int) and 0 <= value < len(SEVERITIES) else "message"


def _whole(entry: Entry) -> str:
    values = ", ".join(f"{name} {text_of(value)}" for name, value in entry.values.items() if name != "severity")
    return f"{entry.text} ({values})" if values else entry.text


def _when(moment: Moment) -> tuple[bool, float]:
    """Before all others what has no time: it came before the vehicle told its own."""
    return (not math.isnan(moment.t_s), 0.0 if math.isnan(moment.t_s) else moment.t_s)


def _times(number: int) -> str:
    return "once" if number == 1 else f"{number} times"
