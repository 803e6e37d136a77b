"""What a plan file claims, each claim judged by itself, from the numbers of the file and the mission in it.

Nothing is shared with the planner but the geometry, the automata, and the reader of missions. The certificate names
triangles for each piece of the curve. Once these are known to hold the tube, whatever they can spell is what counts,
and it does not matter who named them.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from itertools import groupby, pairwise
from typing import Any, Final, NamedTuple, NoReturn

import numpy as np
import shapely

from mission.errors import Fault, MissionError, SpecError
from mission.logic.formula.word import LassoWord
from mission.spec.loader import parse_mission
from mission.spec.model import UNTIL_STOPPED, Semantics
from mission.spec.tasks import task_text
from mission.verify.plans.fields import series_fault, steering_fault
from mission.verify.plans.flight import lanes_cover, limits_kept, pictures_taken, stops_made
from mission.verify.plans.nose import heading_kept
from mission.verify.plans.proof import Verdict, certified, figures_hold, tube_holds, words_satisfy
from mission.verify.plans.written import Written

JUDGED: Final = frozenset(
    (
        "format",
        "mission",
        "mission_automaton",
        "start_m",
        "partition",
        "labels",
        "run",
        "path",
        "covers",
        "stops",
        "trajectory",
        "certificate",
        "photographs",
        "homeward",
        "onward",
    )
)
"""The parts of a plan file that are judged here."""

_SAME: Final = 1e-9
_ROUNDING_M: Final = 1e-6
_UNREADABLE = (ArithmeticError, AttributeError, LookupError, MissionError, RecursionError, TypeError, ValueError)


class Claim(NamedTuple):
    """One thing that a plan claims.

    Attributes:
        name: What it is about.
        fault: What is wrong, and where; None where it is true.
        figure: What was looked at, in numbers.
    """

    name: str
    fault: str | None
    figure: str


def claims(text: str, source: str = "") -> Iterator[Claim]:
    """Judge what a plan file claims, one after the other; where its domain is not its mission's, nothing else.

    Args:
        text: The file.
        source: Its name, for what cannot be read.

    Raises:
        SpecError: It is no plan, or its mission has faults.
    """
    try:
        data = json.loads(text, parse_constant=_finite)
        named = str(data.get("mission_automaton", "")).encode()
        plan = Written(data, parse_mission(json.dumps(data["mission"]).encode(), read=lambda _: named))
    except (AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        fault = Fault(0, 0, "", "this is not a plan", "name a file that 'mission plan --out' wrote")
        raise SpecError((fault,), source) from error
    for name, judge in _CLAIMS.items():
        claim = _judged(plan, name, judge)
        yield claim
        if claim.fault and judge is _domain:
            return


def _finite(name: str) -> NoReturn:
    raise ValueError(f"a plan has no number {name}")


def _judged(plan: Written, name: str, judge: Callable[[Written], Verdict]) -> Claim:
    try:
        # What is no number compares as false, and would pass.
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            return Claim(name, *judge(plan))
    except _UNREADABLE as error:
        return Claim(name, f"it cannot be read: {error or type(error).__name__}", "")


def _domain(plan: Written) -> Verdict:
    """The triangles and labels that the outlines of the mission make."""
    stated, labels = plan.data["partition"], plan.data["labels"]
    due = {
        "partition.triangles": (stated["triangles"], plan.partition.triangles.tolist()),
        "partition.neighbours": (stated["neighbours"], plan.partition.neighbours.tolist()),
        "labels.letters": (labels["letters"], [sorted(letter) for letter in plan.labelling.letters]),
        "labels.letter_of": (labels["letter_of"], plan.labelling.letter_of.tolist()),
    }
    for what, (given, made) in due.items():
        for i, (one, other) in enumerate(zip(given, made, strict=False)):
            if one != other or len(given) != len(made):
                return f"`{what}.{i}` is not as its mission makes it", ""
    off = np.abs(np.array(stated["vertices_m"]) - plan.partition.vertices_m).max(axis=1)
    wrong = off.max() > _SAME * plan.partition.extent_m
    fault = f"`partition.vertices_m.{int(np.argmax(off))}` is {off.max():.3g} m off" if wrong else None
    return fault, f"{plan.partition.size} triangles, {len(labels['letters'])} letters"


def _orders(plan: Written) -> Verdict:
    """What the plan repeats of its mission."""
    data, flight, trajectory = plan.data, plan.spec.flight, plan.data["trajectory"]
    laps = 1 if plan.lap is None else None if flight.laps == UNTIL_STOPPED else flight.laps
    proofs = [proof for _, proof in certified(plan)]
    due: dict[str, tuple[Any, Any]] = {
        "trajectory.altitude_m": (trajectory["altitude_m"], flight.altitude_m),
        "trajectory.laps": (trajectory["laps"], laps),
        **{
            f"certificate.{key}": (proof[key], value)
            for proof in proofs
            for key, value in (
                ("tube_m", flight.tube_m),
                ("holds", True),
                ("where_s", None),
                ("where_m", None),
                ("counterexample", []),
            )
            if proof[key] != value
        },
    }
    for number, task in enumerate(data.get("dropped", ())):
        own = plan.spec.tasks[task["number"]]
        due[f"dropped.{number}"] = (own.weight and [task["task"], task["weight"]], [task_text(own), own.weight])
    wrong = next((f"`{k}` is {a!r}, and its mission asks for {b!r}" for k, (a, b) in due.items() if a != b), None)
    return wrong, f"{flight.altitude_m:g} m high, {laps or 'any number of'} laps, tube of {flight.tube_m:g} m"


def _run(plan: Written) -> Verdict:
    """Runs of T; that of the flight satisfies the mission."""
    run, across = plan.data["run"], plan.partition.neighbours
    back = plan.data["homeward"]
    for each in (run, *([back["run"]] if back else [])):
        states = [*each["prefix"], *each["suffix"]]
        for i, (here, there) in enumerate(pairwise([*states, each["suffix"][0]])):
            control = each["controls"][i]
            led = here if control == 0 else int(across[here, range(3)[control - 1]])
            if led != there or plan.restricted[there] or min(here, control) < 0:
                return f"`run`: control {control} does not lead from triangle {here} to {there}", ""
        if len(each["controls"]) != len(states):
            return "`run.controls` are not as many as its triangles", ""
    states = [*run["prefix"], *run["suffix"]]
    if plan.partition.barycentric(np.array(states[:1]), np.array([plan.data["start_m"]])).min() < -_SAME:
        return f"`run` does not begin where the flight does, at {plan.data['start_m']}", ""
    letters = [plan.labelling.label(state) for state in states]
    before, loop = letters[: len(run["prefix"])], letters[len(run["prefix"]) :]
    if plan.spec.semantics is Semantics.PAPER:
        before = before[1:] if before else loop[1:]
    word = LassoWord(tuple(before), tuple(loop))
    fault = "`run` spells a word that violates the mission" if plan.refutation.accepts(word) else None
    return fault, f"{len(states)} triangles, {len(states)} transitions"


def _path(plan: Written) -> Verdict:
    """Segments that follow the runs, steered by fields within triangles, or a polyline in what may be entered."""
    return _segments(plan) if plan.steered else _polyline(plan)


def _segments(plan: Written) -> Verdict:
    segments, run, back = plan.data["path"]["segments"], plan.data["run"], plan.data["homeward"]
    loops, lap = len(set(run["suffix"])) > 1, plan.data["path"]["lap"]
    if lap is not None and not lap[0] < lap[1]:
        return "`path.lap` ends before it begins", ""
    if not loops == (lap is not None) == (plan.lap is not None) or (loops and plan.lap != min(lap[0], 1)):
        return "the lap of `path` is not that of its run, or not that of the trajectory", ""
    due = list(zip([*run["prefix"], *run["suffix"]], run["controls"], strict=True))
    due += [(run["suffix"][0], 0)] * loops
    if back:
        due += zip([*back["run"]["prefix"], *back["run"]["suffix"]], back["run"]["controls"], strict=True)
    passed = [list(group) for _, group in groupby(segments, key=lambda segment: segment["triangle"])]
    for triangle, group in groupby(due, key=lambda step: step[0]):
        here = passed[0][0] if passed else segments[-1]
        if here["triangle"] == triangle and passed:
            if passed.pop(0)[-1]["control"] != [*group][-1][1]:
                return f"`path` does not leave triangle {triangle} as its run does", ""
        elif plan.partition.barycentric(np.array([triangle]), np.array([here["entry_m"]])).min() < -_SAME:
            return f"`path` does not pass triangle {triangle} of its run", ""  # nor touches its corner
    if passed:
        return f"`path` goes on into triangle {passed[0][0]['triangle']}, and its run does not", ""
    fault = steering_fault(segments, plan.partition, plan.data["start_m"], plan.spec.flight.speed_m_s)
    return fault, f"{len(segments)} fields"


def _polyline(plan: Written) -> Verdict:
    path, closed = plan.data["path"], shapely.polygons(plan.partition.corners_m[plan.restricted])
    points, lap = np.array(path["points_m"], dtype=np.float64), path["lap"]
    begins = np.stack((points[0], plan.curve.at(np.zeros(1))[0]))
    if np.abs(begins - plan.data["start_m"]).max() > _SAME * plan.partition.extent_m:
        return "`path`, or its curve, does not begin where the flight does", ""
    if (lap is None) != (plan.lap is None) or (lap and np.abs(points[lap[0]] - points[lap[1]]).max() > _ROUNDING_M):
        return "the lap of `path` is not that of the trajectory, or does not close", ""
    if len(points) > 1 and shapely.intersects(shapely.union_all(closed), shapely.linestrings(points)):
        return "`path` meets what must not be entered", ""
    return None, f"{len(points)} corners"


def _curve(plan: Written) -> Verdict:
    """Legs that join, and a lap that closes; where fields steer, the series of their path, and its lanes."""
    plan.curve.jumps_s  # noqa: B018 - raises where legs do not join
    if plan.lap is not None:
        control = plan.legs[plan.lap].control_m
        gap = float(np.abs(control[0, 0] - control[-1, -1]).max())
        if gap > _SAME * plan.curve.size_m:
            return f"the lap ends {gap:.3g} m from where it begins", ""
    fault = _series(plan) if plan.steered else None
    if fault:
        return fault, ""
    waves = [max(len(piece.get("coefficients_m", ())) for piece in pieces) for pieces in plan.pieces]
    ends = [0, len(waves) if plan.lap is None else plan.lap + 1, len(waves)]
    due = [max(waves[a:b]) for a, b in pairwise(ends) if a < b]
    told = [proof["frequencies"] for _, proof in certified(plan)]
    fault = None if told == due else f"`certificate.frequencies` is {told}, and the curve has {due}"
    return fault, f"{len(waves)} legs, {plan.curve.ends_s[-1]:.1f} s of steering, {max(waves)} frequencies"


def _series(plan: Written) -> str | None:
    """Whether a leg is not the series of its path, with its lanes in between."""
    if len(plan.pieces) != len(plan.segments):
        return f"there are {len(plan.pieces)} legs, and the path has {len(plan.segments)}"
    for number, (pieces, own) in enumerate(zip(plan.pieces, plan.segments, strict=True)):
        parts = [(lanes, list(part)) for lanes, part in groupby(own, key=lambda segment: segment.get("lanes"))]
        if len(parts) != len(pieces):
            return f"leg {number} has {len(pieces)} pieces, and its path {len(parts)}"
        for piece, (lanes, part) in zip(pieces, parts, strict=True):
            fault = series_fault(piece, part) if lanes is None else "is not as its lanes" * (lanes != piece) or None
            if fault:
                return f"leg {number} {fault}"
    return None


_CLAIMS: Final[Mapping[str, Callable[[Written], Verdict]]] = {
    "domain": _domain,
    "mission": _orders,
    "run": _run,
    "path": _path,
    "curve": _curve,
    "tube": tube_holds,
    "words": words_satisfy,
    "figures": figures_hold,
    "time law": limits_kept,
    "stops": stops_made,
    "lanes": lanes_cover,
    "photographs": pictures_taken,
    "heading": heading_kept,
}
