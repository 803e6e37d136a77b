"""The report as one HTML page that stands alone: nothing is fetched, and it is good on paper and on a phone.

All text is escaped where it enters.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from mission.decimals import decimal
from mission.plan import FlightPlan
from mission.report.fact_rows import certificate_rows, flown_rows, planned_rows
from mission.report.figures import Picture
from mission.report.markup import STYLE, Row, details, escape, facts, folded, moment, table, text_of
from mission.report.reading import Entry, Record
from mission.report.timeline import PREFLIGHT, everything, moments, orders
from mission.report.word import in_short, passages, told
from mission.spec.tasks import task_text

_FEW: Final = 12
"""So many letters are shown without being asked for."""

_SAID_OF_THE_ENDING: Final = (
    ("vehicle", "Vehicle"),
    ("ending", "Ending"),
    ("interrupted", "Interrupted by the user"),
    ("laps", "Laps"),
    ("slowed_s", "Seconds that the trajectory took longer"),
    ("p99_gap_s", "Seconds between two setpoints, in 99 of 100 cases at most"),
    ("largest_gap_s", "Seconds between two setpoints, at most"),
    ("link_delay_s", "Seconds that the link took, both ways"),
    ("behind_s", "This computer did not keep up: seconds behind"),
)


def page(
    plan: FlightPlan,
    record: Record | None,
    numbers: Mapping[str, Any],
    pictures: Sequence[tuple[Picture, str]],
    *,
    figures: str = "",
    made: Sequence[Row] = (),
    mission_text: str = "",
) -> str:
    """The report of a plan, and of its flight where there is a record.

    Args:
        plan: The plan.
        record: The flight's record, if it was flown.
        numbers: What ``summary`` gives for the two.
        pictures: What is shown, each with the address of its file.
        figures: Map and histories as markup, with what they run.
        made: When, by what and from what it was made.
        mission_text: The mission file as the user wrote it, if it is to be shown.
    """
    spec = plan.spec
    parts = [
        f"<h1>{escape(spec.name)}</h1>",
        f"<p>{escape(spec.description)}</p>" if spec.description else "",
        _verdict(numbers["verdict"]),
        "" if record is None else _word(plan, record, numbers),
        figures,
    ]
    if record is not None:
        parts += [
            "<h2>What happened</h2>",
            _timeline(record),
            "<h2>Flight</h2>",
            facts(flown_rows(numbers)),
            _ending(numbers["verdict"]),
            "<h2>Vehicle</h2>",
            facts(
                [(name.replace("_", " "), text_of(value)) for name, value in record.vehicle.items() if name != "t_s"]
            ),
            *map(_preflight, (event for event in record.events if event.text == PREFLIGHT)),
        ]
    parts += [
        "<h2>Mission</h2>",
        f"<p>Specification ({escape(spec.semantics.value)} semantics):</p><pre>{escape(plan.specification)}</pre>",
        _tasks(plan),
        details(f"Automaton {spec.automaton.file}", spec.automaton.text) if spec.automaton else "",
        details("Mission file", mission_text) if mission_text else "",
        "<h2>Certificate</h2>",
        facts(certificate_rows(numbers["certificate"], numbers["planned"])),
        "<h2>Plan</h2>",
        facts(planned_rows(numbers["planned"])),
        "<h2>Pictures</h2>" if pictures else "",
        *(_figure(*each) for each in pictures),
        f"<h2>How it was made</h2>{facts(made)}" if made else "",
    ]
    title = f"{spec.name}: {'flight' if record is not None else 'plan'}"
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{escape(title)}</title>\n'
        f"<style>\n{STYLE}</style>\n</head>\n<body>\n" + "\n".join(filter(None, parts)) + "\n</body>\n</html>\n"
    )


def _verdict(verdict: Mapping[str, Any] | None) -> str:
    if verdict is None:
        return '<p class="verdict"><strong>Planned, not flown.</strong></p>'
    kind, words = {
        True: ("achieved", "The specification was achieved."),
        False: ("failed", "The specification was not achieved."),
    }.get(verdict["achieved"], ("", "There is no verdict."))
    reason = f"<br>{escape(_sentence(str(verdict['reason'])))}" if verdict["reason"] else ""
    return f'<p class="verdict {kind}"><strong>{words}</strong>{reason}</p>'


def _ending(verdict: Mapping[str, Any]) -> str:
    more = [
        (title, text_of(verdict[name]))
        for name, title in _SAID_OF_THE_ENDING
        if verdict.get(name) not in (None, "", False, 0)
    ]
    return facts(more) if more else ""


def _word(plan: FlightPlan, record: Record, numbers: Mapping[str, Any]) -> str:
    """The word that was flown, in plain words, and what each letter brought to the automaton."""
    found, flown = passages(plan, record), numbers["flown"]
    judged = flown["judged"]
    steps = f"{judged['done']} of {judged['total']} steps of the automaton were done"
    waited = judged["awaited"] and numbers["verdict"]["achieved"] is not True
    open_steps = f", and it waited for {' or '.join(judged['awaited'])}" if waited else ""
    entered = {name for passage in found for name in passage.regions or ()}
    restricted = [region.name for region in plan.spec.regions if region.forbidden]
    kept_out = [name for name in restricted if name not in entered]
    met = [name for name in restricted if name in entered]
    sentences = [
        in_short(found),
        f"At the end {steps}{open_steps}.",
        f"It entered {', '.join(met)}, which is restricted." if met else "",
        f"It kept out of {', '.join(kept_out)}." if kept_out else "",
    ]
    rows = [
        (moment(passage.t_s), _place(passage.regions), words) for passage, words in zip(found, told(found), strict=True)
    ]
    letters = table(("time, s", "where", "what that brought"), rows, kind="log") if rows else ""
    triangles = [
        (moment(letter["t_s"]), _place(letter["labels"]), " ".join(_triangle(i) for i in letter["triangles"]))
        for letter in flown["word"]
    ]
    return (
        f"<h2>What was flown</h2><p>{escape(' '.join(filter(None, sentences)))}</p>"
        + (folded(f"The word, letter by letter ({len(rows)})", letters, is_open=len(rows) <= _FEW) if letters else "")
        + (
            folded("Its triangles", table(("time, s", "labels", "triangles"), triangles, kind="log"))
            if triangles
            else "<p>No triangle was visited.</p>"
        )
    )


def _timeline(record: Record) -> str:
    """What matters, open; commands and the rest, folded away."""
    shown = [(moment(each.t_s), each.what, each.source) for each in moments(record)]
    given = [
        (
            moment(order.t_s),
            order.command,
            str(order.attempts),
            order.answer if order.after_s is None else f"{order.answer} after {order.after_s:.2f} s",
        )
        for order in orders(record)
    ]
    log = [(moment(each.t_s), each.source, each.what) for each in everything(record)]
    return (
        (table(("time, s", "what", "told by"), shown, kind="log") if shown else "<p>Nothing was told.</p>")
        + (
            folded(
                f"{len(given):,} commands and their answers",
                table(("time, s", "command", "asked", "answer"), given, kind="log"),
            )
            if given
            else ""
        )
        + (
            folded(
                f"{len(log):,} entries: all events and messages, in vehicle time",
                table(("time, s", "kind", "what"), log, kind="log"),
            )
            if log
            else ""
        )
    )


def _tasks(plan: FlightPlan) -> str:
    """The mission's tasks, and why some of them are not met."""
    if not plan.spec.tasks:
        return ""
    reasons = {task.number: task.reason for task in plan.dropped}
    rows = [
        (
            task_text(task),
            "must be met" if task.weight is None else decimal(task.weight),
            f"dropped: {reasons[i]}" if i in reasons else "",
        )
        for i, task in enumerate(plan.spec.tasks)
    ]
    return table(("task", "weight", ""), rows)


def _preflight(checked: Entry) -> str:
    """What was looked at before the flight; a row that was overridden says so."""
    told = checked.values.get("rows")
    rows = [
        (
            text_of(each.get("row")),
            f"{text_of(each.get('level'))}{', forced' if each.get('forced') else ''}",
            *(text_of(each.get(name)) for name in ("figure", "advice")),
        )
        for each in (told if isinstance(told, list) else ())
        if isinstance(each, Mapping)
    ]
    title = f"Check before the flight: {'go' if checked.values.get('go') else 'no-go'}"
    return f"<h2>{title}</h2>{table(('', '', 'figures', 'what to do'), rows, kind='log checks')}"


def _figure(picture: Picture, address: str) -> str:
    return (
        f'<figure><img src="{escape(address)}" alt="{escape(picture.title)}">'
        f"<figcaption><strong>{escape(picture.title)}.</strong> {escape(picture.caption)}</figcaption></figure>"
    )


def _place(regions: Sequence[str] | None) -> str:
    return "outside of the domain" if regions is None else ", ".join(regions) or "open ground"


def _triangle(triangle: int) -> str:
    return "outside" if triangle < 0 else f"T{triangle}"


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."
