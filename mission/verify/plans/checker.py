"""The rows of the table: each claim of a plan file, how it is judged, and what is said of it."""

import json
from collections.abc import Callable, Iterator, Mapping
from itertools import groupby, pairwise
from typing import Any, Final, NamedTuple, NoReturn, TypeVar

import numpy as np
import shapely

from mission.decimals import count
from mission.errors import Fault, MissionError, SpecError
from mission.logic.formula.word import LassoWord
from mission.spec.loader import parse_mission
from mission.spec.model import UNTIL_STOPPED, Semantics
from mission.spec.tasks import task_text
from mission.verify.plans.fields import curve_fault, steering_fault
from mission.verify.plans.flight import heading_kept, limits_kept, stops_made
from mission.verify.plans.in_time import bounds_kept
from mission.verify.plans.lanes import lanes_cover, pictures_taken
from mission.verify.plans.patches import pieces_of
from mission.verify.plans.proof import Sets, far_from_restricted, layers_of, tube_holds, words_satisfy
from mission.verify.plans.written import Verdict, Written

JUDGED: Final = frozenset((
    "format", "mission", "mission_automaton", "start_m", "partition", "labels", "run", "path", "covers", "stops",
    "trajectory", "certificate", "bounds", "photographs", "homeward", "onward",
))  # fmt: skip
"""The parts of a plan file that are judged here."""

_SAME: Final = 1e-9
_ROUNDING_M: Final = 1e-6
_Made = TypeVar("_Made")
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
        spec = parse_mission(json.dumps(data["mission"]).encode(), read=lambda _: named)
    except (AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        fault = Fault(0, 0, "", "this is not a plan", "name a file that 'mission plan --out' wrote")
        raise SpecError((fault,), source) from error
    try:
        plan = _strictly(Written, data, spec)
    except _UNREADABLE as error:
        yield Claim("file", _unread(error), "")
        return
    for name, judge in _ROWS.items():
        try:
            claim = Claim(name, *_strictly(judge, plan))
        except _UNREADABLE as error:
            claim = Claim(name, _unread(error), "")
        yield claim
        if claim.fault and judge is _domain:
            return


def _strictly(made: Callable[..., _Made], *arguments: Any) -> _Made:  # noqa: ANN401 - its own
    """What is no number compares as false, and would pass: it is an error."""
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        return made(*arguments)


def _unread(error: Exception) -> str:
    return f"it cannot be read: {error or type(error).__name__}"


def _finite(name: str) -> NoReturn:
    raise ValueError(f"a plan has no number {name}")


def _difference(given: Any, due: Any, slack: float, place: str = "") -> str | None:  # noqa: ANN401 - JSON values
    """Where a part of a file is not as due; None where it is. Of what is due, a mapping need not have every key."""
    if given == due or (isinstance(due, float) and abs(given - due) <= slack):
        return None
    keys: list[Any] = list(due) if isinstance(due, dict) else []
    if isinstance(due, list) and isinstance(given, list) and len(due) == len(given):
        keys = [i for i in range(len(due)) if given[i] != due[i]]
    found = (_difference(given[key], due[key], slack, f"{place}.{key}".lstrip(".")) for key in keys)
    return next((each for each in found if each), None) if keys else f"`{place}` is {given!r:.60}, and not {due!r:.60}"


def _domain(plan: Written) -> Verdict:
    """The triangles and labels that the outlines of the mission make."""
    of, labels = plan.partition, plan.labelling
    due = {
        "partition": {name: getattr(of, name).tolist() for name in ("triangles", "neighbours", "vertices_m")},
        "labels": {"letters": [sorted(each) for each in labels.letters], "letter_of": labels.letter_of.tolist()},
    }
    fault = _difference(plan.data, due, _SAME * of.extent_m)
    return (
        fault and f"{fault}, as its mission makes it",
        f"{count(of.size, 'triangle')}, {count(len(labels.letters), 'letter')}",
    )


def _orders(plan: Written) -> Verdict:
    """What the plan repeats of its mission, or of its curve and its proof."""
    flight, dropped, proofs = plan.spec.flight, plan.data.get("dropped", []), []
    laps = 1 if plan.lap is None else None if flight.laps == UNTIL_STOPPED else flight.laps
    legs, cut = plan.data["trajectory"]["legs"], len(plan.legs) if plan.lap is None else plan.lap + 1
    for proof, part in zip(plan.proofs, (legs[:cut], legs[cut:]), strict=False):
        letters = [{int(plan.labelling.letter_of[t]) for t in each} for each in layers_of(plan, proof, alone=True)[0]]
        sure = [next(iter(each)) for each in letters if len(each) == 1]
        waves = (len(piece.get("coefficients_m", ())) for leg in part for piece in pieces_of(leg["curve"]))
        proofs.append(
            {
                "tube_m": flight.tube_m,
                "holds": True,
                "where_s": None,
                "where_m": None,
                "counterexample": [],
                "frequencies": max(waves),
                "word": [sorted(plan.labelling.letters[letter]) for letter, _ in groupby(sure)],
            }
        )
    own = [plan.spec.tasks[each["number"]] for each in dropped]
    due = {
        "trajectory": {"altitude_m": flight.altitude_m, "laps": laps},
        "certificate": proofs[0],
        **({"homeward": {"certificate": proofs[1]}} if proofs[1:] else {}),
        "dropped": [{"task": task_text(task), "weight": task.weight or "a task that must be met"} for task in own],
    }
    fault = _difference({**plan.data, "dropped": dropped}, due, 0.0)
    flown = "any number of laps" if laps is None else count(laps, "lap")
    return fault, f"{flight.altitude_m:g} m high, {flown}, tube of {flight.tube_m:g} m"


def _run(plan: Written) -> Verdict:
    """Runs of T that are flown; that of the flight satisfies the mission."""
    run, back, across = plan.data["run"], plan.data["homeward"], plan.partition.neighbours
    for each, passed in zip((run, *([back["run"]] if back else [])), _passed(plan), strict=True):
        states = [*each["prefix"], *each["suffix"], each["suffix"][0]]
        if len(each["controls"]) != len(states) - 1:
            return "`run.controls` are not as many as its triangles", ""
        for (here, there), control in zip(pairwise(states), each["controls"], strict=True):
            led = here if control == 0 else int(across[here, range(3)[control - 1]])
            if led != there or plan.restricted[there] or min(here, control) < 0:
                return f"`run`: control {control} does not lead from triangle {here} to {there}", ""
        if not _leads(states, len(each["prefix"]), *passed):
            return "`run` is not what is passed, in order", ""
    states = [*run["prefix"], *run["suffix"]]
    if plan.partition.barycentric(np.array(states[:1]), np.array([plan.data["start_m"]])).min() < -_SAME:
        return f"`run` does not begin where the flight does, at {plan.data['start_m']}", ""
    if (plan.lap is not None) != (len(set(run["suffix"])) > 1):
        return "the lap of `trajectory` is not that of `run`", ""
    letters = [plan.labelling.label(state) for state in states]
    before, loop = letters[: len(run["prefix"])], letters[len(run["prefix"]) :]
    if plan.spec.semantics is Semantics.PAPER:
        before = before[1:] if before else loop[1:]
    word = LassoWord(tuple(before), tuple(loop))
    fault = "`run` spells a word that violates the mission" if plan.specification.refutation.accepts(word) else None
    return fault, f"{count(len(states), 'triangle')}, and as many transitions"


def _passed(plan: Written) -> list[tuple[Sets, tuple[int, int] | None]]:
    """Sets of triangles one of which each flight is in, one after the other, and its lap: what fields steer through."""
    if not plan.steered:
        return [layers_of(plan, proof, alone=number > 0) for number, proof in enumerate(plan.proofs)]
    segments, lap = plan.data["path"]["segments"], plan.data["path"]["lap"]
    entries = np.array([segment["entry_m"] for segment in segments], dtype=np.float64)
    which, touched, _ = plan.ground.met_at(entries, _SAME * plan.partition.extent_m)
    sets = [[segment["triangle"], *touched[which == i].tolist()] for i, segment in enumerate(segments)]
    cut = lap[1] if lap else len(sets)
    return [(sets[:cut], lap), (sets[cut:], None)][: len(plan.proofs)]


def _leads(states: list[int], loop: int, sets: Sets, lap: tuple[int, int] | None) -> bool:
    """Whether triangles, each beside the one before, can be passed while the sets are, the loop with the lap."""
    holds = np.array([[state in each for each in map(set, sets)] for state in states])
    at = np.arange(len(sets)) == 0
    for number, inside in enumerate(holds):
        for only in (slice(None), *([slice(lap[0], lap[0] + 1)] if lap and number == loop else [])):
            at &= inside & np.isin(np.arange(len(at)), np.arange(len(at))[only])
            for k in range(1, len(at)):
                at[k] |= at[k - 1] & inside[k]
    return bool(at[-1])


def _path(plan: Written) -> Verdict:
    """Fields that steer through triangles, or a polyline in what may be entered."""
    path = plan.data["path"]
    lap = path["lap"]
    begins = lap and (min(lap[0], 1) if plan.steered else plan.lap)  # with which leg
    if begins != plan.lap or (lap is None) != (plan.lap is None) or (lap and lap[0] >= lap[1]):
        return "the lap of `path` is not that of the trajectory", ""
    if plan.steered:
        moves = "the fields of `path` are of triangles that stand, and here some move"
        return moves if plan.moving else steering_fault(plan), count(len(path["segments"]), "field")
    points = np.array(path["points_m"], dtype=np.float64)
    if np.abs(points[0] - plan.data["start_m"]).max() > _SAME * plan.partition.extent_m:
        return "`path` does not begin where the flight does", ""
    if lap and np.abs(points[lap[0]] - points[lap[1]]).max() > _ROUNDING_M:
        return "the lap of `path` does not close", ""
    if len(points) > 1 and shapely.intersects(plan.ground.closed, shapely.linestrings(points)):
        return "`path` meets what must not be entered", ""
    return None, f"{count(len(points), 'corner')}{'' if plan.moving is None else ', clear of what stands'}"


def _curve(plan: Written) -> Verdict:
    """Legs that join, and a lap that closes; where fields steer, the series of their path, else from the start on."""
    plan.curve.jumps_s  # noqa: B018 - raises where legs do not join
    control = [leg.control_m for leg in plan.legs]
    lap = control[plan.lap or 0]
    if plan.lap is not None and np.abs(lap[0, 0] - lap[-1, -1]).max() > _SAME * plan.curve.size_m:
        return "the lap does not end where it begins", ""
    if not plan.steered and np.abs(control[0][0, 0] - plan.data["start_m"]).max() > _SAME * plan.partition.extent_m:
        return "the curve does not begin where the flight does", ""
    fault = curve_fault(plan) if plan.steered else None
    return fault, f"{count(len(control), 'leg')}, {plan.curve.ends_s[-1]:.1f} s of steering"


_ROWS: Final[Mapping[str, Callable[[Written], Verdict]]] = {
    "domain": _domain,
    "mission": _orders,
    "run": _run,
    "path": _path,
    "curve": _curve,
    "tube": tube_holds,
    "words": words_satisfy,
    "figures": far_from_restricted,
    "time law": limits_kept,
    "stops": stops_made,
    "in time": bounds_kept,
    "lanes": lanes_cover,
    "photographs": pictures_taken,
    "heading": heading_kept,
}
