"""``mission verify --flight``: the verdict on a flight of which there is a log, whoever flew it."""

import math
from argparse import Namespace
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from mission.cli.inputs import bad_file, read_plan
from mission.cli.mission_input import mission_in
from mission.cli.report import with_later_plans
from mission.cli.screen import out, print_json
from mission.decimals import count
from mission.errors import Fault, RecordError, SpecError, reason
from mission.monitor.pictures import missing
from mission.plan import FlightPlan, plan_mission
from mission.report.reading import LEG, LaterPlan, read_record
from mission.report.record import RECORD_FILE
from mission.spec.areas import clearance_of
from mission.spec.model import MissionSpec
from mission.verify.flown.judging import ALL as _ALL
from mission.verify.flown.judging import Judged, judged
from mission.verify.flown.possible import Doubt
from mission.verify.logs.reading import LoggedFlight, read_flight
from mission.verify.logs.telemetry import Clock, LogError

_PLAN_FILE: Final = "plan.json"
_MOST_DOUBTS: Final = 10
_NEARER_M: Final = 0.05
_SAID: Final = {True: "achieved", False: "not achieved", None: "cannot be told"}
_MET: Final = {True: "met", False: "not met", None: "cannot be told"}


def run(arguments: Namespace) -> int:
    """Judge the flight of a log by a mission; 0 where it is known to be achieved."""
    file = Path(arguments.flight)
    spec, plan = _asked(arguments, file)
    start_m = spec.start.position_m if plan is None else plan.start_m
    try:
        flight = read_flight(
            file, origin=spec.origin, start_m=start_m, system=arguments.system, number=arguments.flight_number
        )
    except OSError as error:
        raise bad_file(file, f"cannot be read: {reason(error)}", "name the log of a flight") from error
    except LogError as error:
        raise LogError(f"{file}: {error}") from error
    except RecordError as error:
        raise RecordError(f"{file}: {error}", line=error.line) from error
    anew_m = flight.track.planned_from_m
    if plan is not None and anew_m is not None and anew_m != plan.start_m:
        plan = plan_mission(spec, start_m=anew_m, run=plan.asked_run)
    parts = [_Part(spec, plan, flight)]
    if arguments.mission is None and plan is not None and (file / RECORD_FILE).is_file():
        parts = _amended(file, parts[0], plan)
    found = [
        judged(part.spec, part.flight.track, plan=part.plan, legs=part.legs, fastest_m_s=arguments.fastest)
        for part in parts
    ]
    if arguments.json:
        values = [_values(part.flight, each) for part, each in zip(parts, found, strict=True)]
        print_json({"exit_code": _exit_code(found), **(values[0] if len(values) == 1 else {"parts": values})})
    for number, (part, each) in enumerate(zip(parts, found, strict=True), 1):
        if len(parts) > 1:
            out.print(f"part      {number} of {len(parts)}, between changes of the mission", markup=False)
        for name, words in _lines(part.flight, each, part.spec, None if arguments.verbose else _MOST_DOUBTS):
            out.print(f"{name:<10}{words}", markup=False)
    return _exit_code(found)


@dataclass(frozen=True, eq=False)
class _Part:
    """What a part of a flight is judged by."""

    spec: MissionSpec
    plan: FlightPlan | None
    flight: LoggedFlight
    legs: tuple[LaterPlan, ...] = ()


def _exit_code(found: Sequence[Judged]) -> int:
    """0 where the mission that was asked for last is known to be achieved, and nothing was violated before."""
    return 0 if found[-1].achieved and not any(each.violations for each in found[:-1]) else 1


def _amended(file: Path, whole: _Part, first: FlightPlan) -> list[_Part]:
    """The parts of a flight of which the mission was changed: each is judged by what was asked for then.

    A part that another one follows has only to violate nothing.
    """
    record = with_later_plans(read_record(file), file)
    changes = [event.t_s for event in record.events if event.text == LEG and event.values.get("amended")]
    parts, track, legs = [], whole.flight.track, (LaterPlan(-math.inf, first, 0), *record.later)
    for from_s, to_s in pairwise([-math.inf, *changes, math.inf]):
        flown = (track.t_s >= from_s) & (track.t_s <= to_s)
        by = tuple(leg for leg in legs if from_s <= leg.from_s < to_s)
        if flown.any():
            cut = replace(
                track,
                t_s=track.t_s[flown],
                position_m=track.position_m[flown],
                word_from_s=max(track.word_from_s, float(track.t_s[flown][0])),
                ends_whole=track.ends_whole or math.isfinite(to_s),
                pictures=tuple(each for each in track.pictures if from_s <= each[0] <= to_s),
            )
            parts.append(_Part(by[0].plan.spec, by[0].plan, replace(whole.flight, track=cut), by))
    return parts


def _asked(arguments: Namespace, file: Path) -> tuple[MissionSpec, FlightPlan | None]:
    """The mission, and the plan of it that the flight is compared with."""
    named = arguments.compared or arguments.plan
    if named is None and arguments.mission is None and (file / _PLAN_FILE).is_file():
        named = str(file / _PLAN_FILE)
    if named is None and arguments.mission is None:
        hint = "name the mission that the flight is judged by: --mission FILE"
        raise SpecError((Fault(0, 0, "--flight", "a flight is judged by a mission, and there is none", hint),))
    plan = None if named is None else read_plan(Path(named))[0]
    if arguments.mission is None and plan is not None:
        return plan.spec, plan
    spec = mission_in(arguments.mission)
    if plan is not None and plan.spec != spec:
        raise bad_file(Path(named), f"this is not a plan of {arguments.mission}", "plan the mission anew")
    return spec, plan


def _lines(flight: LoggedFlight, found: Judged, spec: MissionSpec, most: int | None) -> Iterator[tuple[str, str]]:
    """What was found, as names and words; of what is not told, so many times at most."""
    clock = flight.track.clock
    yield from _log_lines(flight, found)
    yield "mission", found.specification
    yield "word", " ".join("..." if each.regions is None else _letter(each.regions) for each in found.word)
    yield from _measured_lines(flight, found)
    for violation in found.violations:
        named = _named(violation.names, spec)
        east, north = violation.position_m
        yield "violation", f"{violation.kind}{named} at {clock.text(violation.time_s)}, at ({east:.1f}, {north:.1f})"
    # Of a verdict that is known, what does not bear on it is no news.
    doubts = [doubt for doubt in found.doubts if found.achieved is None or doubt.violates]
    for doubt in doubts[:most]:
        yield "not told", f"{_when(doubt, clock)}: {_what(doubt)}"
    if most is not None and len(doubts) > most:
        yield "not told", f"and {count(len(doubts) - most, 'time')} more (-v and --json list all)"
    when = "" if found.at_s is None else f" at {clock.text(found.at_s)}"
    yield "verdict", f"{_SAID[found.achieved]}: {found.reason}{when}"


def _log_lines(flight: LoggedFlight, found: Judged) -> Iterator[tuple[str, str]]:
    """What was read."""
    track, clock = flight.track, flight.track.clock
    begin_s, end_s = float(track.t_s[0]), float(track.t_s[-1])
    which = "" if flight.flights == 1 else f", flight {flight.number} of {flight.flights}"
    yield "flight", f"{flight.kind}{which}: {clock.text(begin_s)} to {clock.text(end_s)}, {end_s - begin_s:.1f} s"
    yield "positions", f"{len(track.t_s):,}, up to {found.longest_gap_s:.2f} s apart: {track.frame}"
    for note in flight.notes:
        yield "note", note
    if found.jumps:
        times = ", ".join(clock.text(t_s) for t_s in found.jumps[:_MOST_DOUBTS])
        yield "note", f"the position jumped farther than the vehicle flies at {times}"


def _measured_lines(flight: LoggedFlight, found: Judged) -> Iterator[tuple[str, str]]:
    """Distances, shares and counts."""
    clock = flight.track.clock
    for near in found.nearness:
        at = f"({near.position_m[0]:.1f}, {near.position_m[1]:.1f})"
        least = f"{near.least_m:.2f} m from {near.region} at {clock.text(near.t_s)}, at {at}"
        open_m = near.least_m - near.surely_m > _NEARER_M
        yield "nearest", least + (f"; what the log does not tell may be {near.surely_m:.2f} m from it" * open_m)
    for share in found.covered:
        between = f"{share.least:.1%}" + (f" to {share.most:.1%}" if share.most > share.least else "")
        yield "covered", f"{between} of {share.region}, {share.asked:.1%} is asked"
    if found.pictures:
        places = [f"{number} over {name}" for name, number in found.pictures.items() if name != _ALL]
        lost = missing([number for _, number in flight.track.pictures])
        unheard = [f"nothing was heard of {lost} more"] if lost else []
        yield "pictures", ", ".join([str(found.pictures[_ALL]), *places, *unheard])
    for bound in found.bounds:
        margin = "" if bound.margin_s is None or not math.isfinite(bound.margin_s) else _margin(bound.margin_s)
        yield "in time", f"{bound.formula}: {_MET[bound.met]}{margin}"
    for wish in found.wishes:
        yield "wish", f"{wish.task}: {_MET[wish.met]}"
    if found.deviation is not None:
        most = f"at most {found.deviation.largest_m:.2f} m at {clock.text(found.deviation.t_s)}"
        yield "path", f"{most} from the planned path, rms {found.deviation.rms_m:.2f} m"


def _margin(margin_s: float) -> str:
    return f", with {margin_s:.1f} s to spare" if margin_s >= 0.0 else f", by {-margin_s:.1f} s"


def _named(names: tuple[str, ...], spec: MissionSpec) -> str:
    """Regions that were entered, with their clearances: distances are measured to regions without these."""
    clearances = {region.name: clearance_of(region, spec.domain) for region in spec.regions}
    words = [name + (f" with its clearance of {clearances[name]:g} m" if clearances[name] else "") for name in names]
    return f" ({', '.join(words)})" if words else ""


def _letter(regions: tuple[str, ...]) -> str:
    return f"{{{', '.join(regions)}}}"


def _when(doubt: Doubt, clock: Clock) -> str:
    if math.isinf(doubt.from_s):
        return f"before {clock.text(doubt.to_s)}, where the log begins"
    if math.isinf(doubt.to_s):
        return f"after {clock.text(doubt.from_s)}, where the log ends"
    return f"between {clock.text(doubt.from_s)} and {clock.text(doubt.to_s)}"


def _what(doubt: Doubt) -> str:
    parts = [f"whether it entered {', '.join(doubt.restricted)}"] if doubt.restricted else []
    if doubt.outside:
        parts.append("whether it left the domain")
    others = [name for name in doubt.regions if name not in doubt.restricted]
    if others:
        parts.append(f"whether it was in {', '.join(others)}")
    return ", ".join(parts) or "in which order it was where"


def _values(flight: LoggedFlight, found: Judged) -> dict[str, Any]:
    """What was found, as JSON values; times are the vehicle's, ``utc_s`` seconds since 1970 where they are known."""
    clock = flight.track.clock

    def at(t_s: float) -> dict[str, float | None]:
        return {"t_s": t_s if math.isfinite(t_s) else None, "utc_s": clock.utc(t_s) if math.isfinite(t_s) else None}

    return {
        "achieved": found.achieved,
        "reason": found.reason,
        "specification": found.specification,
        "log": {
            "kind": flight.kind,
            "flight": flight.number,
            "flights": flight.flights,
            "begin": at(float(flight.track.t_s[0])),
            "end": at(float(flight.track.t_s[-1])),
            "begins_whole": flight.track.begins_whole,
            "ends_whole": flight.track.ends_whole,
            "positions": len(flight.track.t_s),
            "longest_gap_s": found.longest_gap_s,
            "frame": flight.track.frame,
            "notes": [*flight.notes],
            "jumps": [at(t_s) for t_s in found.jumps],
        },
        "word": [
            {**at(each.t_s), "regions": None if each.regions is None else list(each.regions)} for each in found.word
        ],
        "violations": [
            {
                **at(each.time_s),
                "what": each.kind.value,
                "names": list(each.names),
                "position_m": list(each.position_m),
            }
            for each in found.violations
        ],
        "not_told": [
            {
                "from": at(each.from_s),
                "to": at(each.to_s),
                "regions": list(each.regions),
                "restricted": list(each.restricted),
                "outside": each.outside,
            }
            for each in found.doubts
        ],
        "restricted": [
            {
                "region": each.region,
                "least_m": each.least_m,
                "surely_m": each.surely_m,
                "position_m": list(each.position_m),
                **at(each.t_s),
            }
            for each in found.nearness
        ],
        "covered": [asdict(each) for each in found.covered],
        "bounds": [
            {**asdict(each), "margin_s": each.margin_s if math.isfinite(each.margin_s or 0.0) else None}
            for each in found.bounds
        ],
        "wishes": [asdict(each) for each in found.wishes],
        "laps": None if found.laps is None else {"flown": found.laps[0], "asked": found.laps[1]},
        "pictures": found.pictures,
        "deviation": None
        if found.deviation is None
        else {
            "largest_m": found.deviation.largest_m,
            "rms_m": found.deviation.rms_m,
            **at(found.deviation.t_s),
        },
    }
