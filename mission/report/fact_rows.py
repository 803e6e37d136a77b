"""The figures of a plan and of its flight as rows of names and values, as people read them."""

from collections.abc import Mapping, Sequence
from typing import Any

from mission.decimals import decimal
from mission.monitor.gaps import Missing
from mission.report.markup import Row
from mission.spec.model import FIELD


def planned_rows(planned: Mapping[str, Any]) -> list[Row]:
    """Of what ``summary`` says was planned."""
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
        *(("Moves, by the clock of the trajectory", f"{name} {text}") for name, text in planned["motions"].items()),
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


def certificate_rows(certificate: Mapping[str, Any], planned: Mapping[str, Any]) -> list[Row]:
    """Of what ``summary`` says was proved, and planned."""
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
        *(("In time, in the tube", text) for text in certificate["in_time"]),
    ]


def flown_rows(numbers: Mapping[str, Any]) -> list[Row]:
    """Of all that ``summary`` says of a flight."""
    flown, certificate = numbers["flown"], numbers["certificate"]
    achieved = numbers["verdict"]["achieved"]
    by_field = numbers["planned"]["guidance"] == FIELD
    rows = [
        ("Continuations of the word flown", _continuations(flown["judged"]["so_far"], achieved, numbers["planned"])),
        ("Progress of the automaton", _progress(flown["judged"], achieved)),
        *(("In time, as it was flown", text) for text in flown["judged"].get("in_time", ())),
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


def _letter(labels: Sequence[str]) -> str:
    return "{" + ", ".join(labels) + "}" if labels else "∅"


def _metres(value: float | None) -> str:
    return _number(value, "m", 3)


def _number(value: float | None, unit: str, digits: int) -> str:
    return "not known" if value is None else f"{value:.{digits}f} {unit}"
