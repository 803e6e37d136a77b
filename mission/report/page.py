"""The report as one HTML page: no scripts, nothing fetched, good on paper. All text is escaped where it enters."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from mission.decimals import decimal
from mission.monitor.gaps import Missing
from mission.plan import FlightPlan
from mission.report.figures import Picture
from mission.report.markup import STYLE, Row, details, escape, facts, table
from mission.report.reading import Entry, Record
from mission.spec.model import FIELD
from mission.spec.tasks import task_text

SEVERITIES = ("emergency", "alert", "critical", "error", "warning", "notice", "info", "debug")
FIRST = "10_flown_path.png"
"""The picture that a reader looks for first: it stands above all numbers."""
PREFLIGHT = "preflight"
"""The event that holds the table of the check before the flight."""

_SAID_OF_THE_ENDING = (
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
    pictures: Sequence[Picture],
    *,
    mission_text: str = "",
) -> str:
    """The report of a plan, and of its flight where there is a record.

    Args:
        plan: The plan.
        record: The flight's record, if it was flown.
        numbers: What ``summary`` gives for the two.
        pictures: Those that lie in the page's folder.
        mission_text: The mission file as the user wrote it, if it is to be shown.
    """
    spec = plan.spec
    parts = [
        f"<h1>{escape(spec.name)}</h1>",
        f"<p>{escape(spec.description)}</p>" if spec.description else "",
        _verdict(numbers["verdict"]),
        *(_figure(picture) for picture in pictures if picture.file == FIRST),
        "<h2>Mission</h2>",
        f"<p>Specification ({escape(spec.semantics.value)} semantics):</p><pre>{escape(plan.specification)}</pre>",
        _tasks(plan),
        details(f"Automaton {spec.automaton.file}", spec.automaton.text) if spec.automaton else "",
        details("Mission file", mission_text) if mission_text else "",
        "<h2>Plan</h2>",
        facts(_planned_rows(numbers["planned"])),
        "<h2>Certificate</h2>",
        facts(_certificate_rows(numbers["certificate"], numbers["planned"])),
    ]
    if record is not None:
        parts += [
            "<h2>Flight</h2>",
            facts(_flown_rows(numbers)),
            "<h2>Word flown</h2>",
            _word(numbers["flown"]["word"]),
            "<h2>Vehicle</h2>",
            facts([(name.replace("_", " "), _text(value)) for name, value in record.vehicle.items() if name != "t_s"]),
            *map(_preflight, (event for event in record.events if event.text == PREFLIGHT)),
        ]
    others = [_figure(picture) for picture in pictures if picture.file != FIRST]
    parts += ["<h2>Pictures</h2>" if others else "", *others]
    if record is not None:
        parts += ["<h2>Events and messages of the vehicle</h2>", _log(record)]
    title = f"{spec.name}: {'flight' if record is not None else 'plan'}"
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{escape(title)}</title>\n'
        f"<style>\n{STYLE}</style>\n</head>\n<body>\n" + "\n".join(filter(None, parts)) + "\n</body>\n</html>\n"
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


def _verdict(verdict: Mapping[str, Any] | None) -> str:
    if verdict is None:
        return '<p class="verdict"><strong>Planned, not flown.</strong></p>'
    kind, words = {
        True: ("achieved", "The specification was achieved."),
        False: ("failed", "The specification was not achieved."),
    }.get(verdict["achieved"], ("", "There is no verdict."))
    more = [
        (title, _text(verdict[name]))
        for name, title in _SAID_OF_THE_ENDING
        if verdict.get(name) not in (None, "", False, 0)
    ]
    reason = f"<br>{escape(_sentence(str(verdict['reason'])))}" if verdict["reason"] else ""
    return f'<p class="verdict {kind}"><strong>{words}</strong>{reason}</p>' + (facts(more) if more else "")


def _planned_rows(planned: Mapping[str, Any]) -> list[Row]:
    run = [f"T{state}" for state in planned["run"]]
    start = planned["loop_from_state"]
    loop = f"then again and again: {' '.join(run[start:])}" if planned["recurrent"] else f"then stay in {run[start]}"
    return [
        ("Transition system T", f"{planned['triangles']:,} triangles"),
        ("Automaton A", f"{planned['automaton_states']:,} states, {planned['automaton_edges']:,} edges"),
        (
            "Product P",
            f"{planned['product_states']:,} states, {planned['product_states_reachable']:,} of them reachable",
        ),
        ("Shortest runs", f"{planned['shortest_runs']:,}; number {planned['run_index']} (from 0) is flown"),
        ("Run", f"{' '.join(run[:start])}, {loop}" if start else loop),
        ("Controls", " ".join(f"u{control}" for control in planned["controls"])),
        ("Length of the planned path", f"{planned['length_m']:.2f} m"),
        ("Duration under the steering law", f"{planned['steering_duration_s']:.1f} s"),
        ("Duration of the trajectory", f"{_duration(planned)}, at {planned['altitude_m']:g} m"),
        *(
            [("Clearances", ", ".join(f"{name} {decimal(metres)} m" for name, metres in clearances_m.items()))]
            if (clearances_m := planned["clearances_m"])
            else []
        ),
        *(
            [("Way back from the laps", " ".join(f"T{state}" for state in planned["way_back"]))]
            if planned["way_back"]
            else []
        ),
    ]


def _duration(planned: Mapping[str, Any]) -> str:
    if planned["laps"] is None:
        return f"{planned['duration_s']:.1f} s"
    each = f"laps of {planned['lap_duration_s']:.1f} s each"
    if planned["duration_s"] is None:
        return f"{each}, until the vehicle is told to return"
    return f"{planned['duration_s']:.1f} s, {planned['laps']:,} {each}"


def _certificate_rows(certificate: Mapping[str, Any], planned: Mapping[str, Any]) -> list[Row]:
    clearance, clearances_m = certificate["clearance_m"], planned["clearances_m"]
    by_field = "of the path; the flight is led by the field, of which no tube is proved"
    word = " → ".join(_letter(letter) for letter in certificate["word"])
    return [
        ("Result", f"{'proved' if certificate['holds'] else 'NOT proved'}: {certificate['reason']}"),
        *([("What it is about", by_field)] * (planned["guidance"] == FIELD)),
        *([("Frequencies of the Fourier series", f"{certificate['frequencies']}")] * (certificate["frequencies"] > 0)),
        ("Tube around the path, each axis", f"±{certificate['tube_m']:.3f} m"),
        (
            f"Distance of the path to restricted regions{' with their clearances' * bool(clearances_m)}",
            "nothing is restricted" if clearance is None else f"at least {clearance:.3f} m",
        ),
        ("Word that it surely spells", word or "(empty)"),
        *([("Way back from the laps", certificate["way_back"])] if certificate["way_back"] else []),
    ]


def _flown_rows(numbers: Mapping[str, Any]) -> list[Row]:
    flown, certificate = numbers["flown"], numbers["certificate"]
    achieved = numbers["verdict"]["achieved"]
    by_field = numbers["planned"]["guidance"] == FIELD
    rows = [
        ("Continuations of the word flown", _continuations(flown["judged"]["so_far"], achieved, numbers["planned"])),
        ("Progress of the automaton", _progress(flown["judged"], achieved)),
        *([] if by_field else _following(flown, certificate)),
        *(
            (f"Smallest distance to {name}", _against_clearance(distance, numbers["planned"]["clearances_m"].get(name)))
            for name, distance in flown["distance_to_restricted_m"].items()
        ),
        *([("Plans flown, one after the other", str(flown["plans"]))] if flown["plans"] > 1 else []),
        ("Length flown", _number(flown["length_m"], "m", 2)),
        (f"Time {'by the field' if by_field else 'on the trajectory'}", _number(flown["duration_s"], "s", 1)),
        *_gaps(flown["gaps"]),
        *_covered(flown["covered"]),
        *_photographs(flown["photographs"]),
        ("Largest speed", _number(flown["largest_speed_m_s"], "m/s", 2)),
        ("Largest tilt", _number(flown["largest_tilt_deg"], "°", 1)),
        ("Positions reported", f"{flown['reports']:,}, {flown['reports_on_trajectory']:,} of them on the trajectory"),
    ]
    if flown["record_is_cut"]:
        rows.append(("Record", "its last line is cut; everything before it was read"))
    return rows


def _following(flown: Mapping[str, Any], certificate: Mapping[str, Any]) -> list[Row]:
    """How closely the trajectory was followed."""
    return [
        ("Largest distance from the trajectory", _metres(flown["largest_error_m"])),
        (
            "Largest error on one axis",
            _against_tube(flown["largest_error_per_axis_m"], certificate["tube_m"]),
        ),
        (
            "Largest error of the velocity on one axis",
            _against_bound(flown["largest_velocity_error_per_axis_m_s"], certificate),
        ),
        ("Distance from the trajectory, rms", _metres(flown["rms_error_m"])),
    ]


def _continuations(so_far: str, achieved: object, planned: Mapping[str, Any]) -> str:
    """The three-valued verdict, and why the flight's own may be another: that is about one continuation alone."""
    known = {"true": "true: all satisfy the formula", "false": "false: none satisfies the formula"}
    if so_far in known:
        return known[so_far]
    text = "open: some satisfy the formula"
    if achieved is True:
        others = "as laps without end would" if planned["recurrent"] else "as staying in the last region does"
        return f"{text}, {others}, and some do not"
    return text


def _progress(judged: Mapping[str, Any], achieved: object) -> str:
    waits = f"; it waits for {' or '.join(judged['awaited'])}" if judged["awaited"] and achieved is not True else ""
    return f"{judged['done']} of {judged['total']}{waits}"


def _against_clearance(distance_m: float, clearance_m: float | None) -> str:
    return _metres(distance_m) + ("" if clearance_m is None else f", to be kept: {decimal(clearance_m)} m")


def _against_bound(error_m_s: float | None, certificate: Mapping[str, Any]) -> str:
    """A velocity's error against what goes with the tube, where there is one."""
    text, bound_m_s = _number(error_m_s, "m/s", 2), certificate["tube_m_s"]
    if error_m_s is None or certificate["tube_m"] == 0.0:
        return text
    return f"{text}, {'within' if error_m_s <= bound_m_s else 'BEYOND'} the {bound_m_s:.2f} m/s that go with the tube"


def _against_tube(error_m: float | None, tube_m: float) -> str:
    if error_m is None or tube_m == 0.0:
        return _metres(error_m)
    if error_m <= tube_m:
        return f"{_metres(error_m)}, within the tube of {tube_m:.3f} m that is proved"
    return f"{_metres(error_m)}, BEYOND the tube of {tube_m:.3f} m: the proof does not cover what was flown there"


def _word(word: Iterable[Mapping[str, Any]]) -> str:
    rows = [
        (_time(letter["t_s"]), _letter(letter["labels"]), " ".join(_triangle(i) for i in letter["triangles"]))
        for letter in word
    ]
    return table(("vehicle time, s", "labels", "triangles"), rows) if rows else "<p>No triangle was visited.</p>"


def _log(record: Record) -> str:
    def row(entry: Entry, kind: str) -> tuple[float, str, str, str]:
        values = ", ".join(f"{name} {_text(value)}" for name, value in entry.values.items() if name != "severity")
        return entry.t_s, kind, entry.text, values

    entries = [row(entry, "event") for entry in record.events if entry.text != PREFLIGHT]
    entries += [row(entry, _severity(entry.values.get("severity"))) for entry in record.texts]
    entries.sort(key=lambda entry: entry[0])
    rows = [(_time(t_s), kind, f"{text} ({values})" if values else text) for t_s, kind, text, values in entries]
    if not rows:
        return "<p>None.</p>"
    shown = table(("time, s", "kind", "what"), rows, kind="log")
    return f"<details><summary>{len(rows):,} entries, in vehicle time</summary>{shown}</details>"


def _preflight(checked: Entry) -> str:
    """What was looked at before the flight; a row that was overridden says so."""
    rows = [
        (each["row"], f"{each['level']}, forced" if each["forced"] else each["level"], each["figure"], each["advice"])
        for each in checked.values["rows"]
    ]
    title = f"Check before the flight: {'go' if checked.values['go'] else 'no-go'}"
    return f"<h2>{title}</h2>{table(('', '', 'figures', 'what to do'), rows)}"


def _figure(picture: Picture) -> str:
    return (
        f'<figure><img src="{escape(picture.file)}" alt="{escape(picture.title)}">'
        f"<figcaption><strong>{escape(picture.title)}.</strong> {escape(picture.caption)}</figcaption></figure>"
    )


def _letter(labels: Sequence[str]) -> str:
    return "{" + ", ".join(labels) + "}" if labels else "∅"


def _triangle(triangle: int) -> str:
    return "outside" if triangle < 0 else f"T{triangle}"


def _severity(value: object) -> str:
    return SEVERITIES[value] if isinstance(value, int) and 0 <= value < len(SEVERITIES) else "message"


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."


def _time(t_s: float | None) -> str:
    return "" if t_s is None or math.isnan(t_s) else f"{t_s:.2f}"


def _metres(value: float | None) -> str:
    return _number(value, "m", 3)


def _number(value: float | None, unit: str, digits: int) -> str:
    return "not known" if value is None else f"{value:.{digits}f} {unit}"


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return " ".join(_text(part) for part in value)
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_text(part)}" for name, part in value.items())
    return "not known" if value is None else str(value)


def _covered(visits: Sequence[Mapping[str, Any]]) -> list[tuple[str, str]]:
    """A row for each visit of a region that was to be covered."""
    return [
        (
            f"Covered of {visit['region']}" + (f" in lap {visit['lap']}" if visit["lap"] else ""),
            f"{visit['share']:.1%}, and {visit['asked']:.1%} was asked",
        )
        for visit in visits
    ]


def _photographs(counts: Mapping[str, int]) -> list[tuple[str, str]]:
    """A row where photographs were planned or taken."""
    if not (counts["told"] or counts["planned"]):
        return []
    lost = f"; nothing was heard of {counts['missing']} more" if counts["missing"] else ""
    return [("Photographs", f"{counts['told']} of {counts['planned']} planned{lost}")]


def _gaps(gaps: Sequence[Mapping[str, Any]]) -> list[tuple[str, str]]:
    """A row for each kind of gap that there was."""
    titles = {Missing.POSITION: "Gaps between positions", Missing.SETPOINT: "Pauses of the trajectory"}
    rows = []
    for missing, title in titles.items():
        lengths_s = [float(gap["for_s"]) for gap in gaps if gap["missing"] == missing]
        if lengths_s:
            rows.append((title, f"{len(lengths_s)}, the longest {max(lengths_s):.1f} s, {sum(lengths_s):.1f} s in all"))
    return rows
