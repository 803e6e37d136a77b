"""Every pattern of `tasks:` is planned and flown in lock-step; the flown word is judged by the definition of LTL."""

import io

from mission.fly import FlightResult, fly
from mission.logic.formula.word import LassoWord, Letter, satisfies
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.spec.loader import parse_mission
from mission.spec.task import TaskKind, TaskMode
from mission.spec.tasks import task_formula
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import plan_of
from tests.support.usual_cases import sampled

MAP = """\
domain:
  boundary: [[0, 0], [40, 0], [40, 26], [0, 26]]
regions:
  home: {kind: home, polygon: [[7, 3], [13, 3], [13, 10], [7, 10]]}
  gate: {kind: survey, polygon: [[1, 3], [7, 3], [7, 10], [1, 10]]}
  a: {kind: survey, polygon: [[18, 4], [25, 4], [25, 11], [18, 11]]}
  b: {kind: survey, polygon: [[23, 15], [37, 15], [37, 22], [23, 22]]}
  west_of_b: {kind: survey, polygon: [[23, 15], [30, 15], [30, 22], [23, 22]]}
  c: {kind: survey, polygon: [[30, 3], [37, 3], [37, 10], [30, 10]]}
  pond: {kind: restricted, polygon: [[4, 16], [11, 16], [11, 22], [4, 22]]}
start: {position_m: [10, 6]}
mission: {laps: 1}
flight: {speed_m_s: 6, altitude_m: 3, final_stay_s: 0.5, disturbance_m_s2: 0.3}
limits: {speed_m_s: 9, acceleration_m_s2: 2.5, tilt_deg: 30}
tasks:
"""

TASKS = (
    ("- visit: [a, c]",),
    ("- sequenced_visit: [c, a]",),
    ("- ordered_visit: [c, b]",),
    ("- strict_ordered_visit: [a, c]",),
    ("- fair_visit: [a, c]",),
    ("- patrol: [a, c]",),
    ("- sequenced_patrol: [a, c]",),
    ("- ordered_patrol: [a, c]",),
    ("- strict_ordered_patrol: [a, c]",),
    ("- fair_patrol: [a, c]",),
    ("- avoid: a", "- visit: c"),
    ("- avoid: {region: a, until: c}", "- visit: a"),
    ("- avoid: {region: home, after: c}", "- visit: c"),
    ("- visits: {region: a, at_most: 1}", "- sequenced_visit: [a, c]"),
    ("- visits: {region: a, at_least: 2}",),
    ("- visits: {region: a, exactly: 2}", "- sequenced_visit: [a, c]"),
    ("- wait: {in: home, until: gate}",),
    ("- react: {when: b, then: west_of_b, how: instantaneous}", "- visit: b"),
    ("- react: {when: a, then: c, how: delayed}", "- visit: a"),
    ("- react: {when: a, then: c, how: prompt}", "- visit: a"),
    ("- react: {when: b, then: west_of_b, how: bound}", "- visit: b"),
    ("- react: {when: a, then: c, how: bound_delay}", "- visit: c"),
)


def flown(tasks: tuple[str, ...], flavour: str) -> tuple[FlightResult, Record]:
    plan = plan_of(MAP + "\n".join(f"  {task}" for task in tasks))
    sink = io.BytesIO()
    vehicle = LockstepVehicle(vehicle_of(flavour, seed=7))
    result = fly(plan, vehicle, vehicle, FlightRecord(sink, mission="patterns"))
    return result, parse_record(sink.getvalue())


def letters_before(record: Record, t_s: float) -> tuple[Letter, ...]:
    return tuple(visit.labels for visit in record.visits if visit.t_s < t_s)


@sampled("tasks", TASKS, TASKS[::3], ids=lambda tasks: tasks[0][2:])
def test_a_pattern_is_flown(tasks: tuple[str, ...]) -> None:
    result, record = flown(tasks, ("ardupilot", "px4")[TASKS.index(tasks) % 2])
    plan, trajectory = result.plan, result.plan.trajectory
    assert result.achieved, result.reason
    assert not plan.warnings
    formulas = [task_formula(task, plan.spec.regions) for task in plan.spec.tasks]
    if not plan.run.recurrent:
        assert all(satisfies(LassoWord(result.word, result.word[-1:]), formula) for formula in formulas)
        return
    # The lap as it was flown, again and again; and after the way back there is still a way to satisfy the tasks.
    assert result.began_s is not None
    begins_s = result.began_s + trajectory.laps_end_s - trajectory.legs[1].duration_s
    to_lap, with_lap = (letters_before(record, t_s) for t_s in (begins_s, result.began_s + trajectory.laps_end_s))
    lap = with_lap[len(to_lap) :]
    assert all(satisfies(LassoWord(to_lap, lap), formula) for formula in formulas)
    onward = (LassoWord((*result.word, *lap[i:]), lap) for i in range(len(lap)))
    assert any(all(satisfies(word, formula) for formula in formulas) for word in onward)
    assert result.laps == 1
    assert result.word[-1] == {"home"}


def test_every_kind_and_every_mode_is_among_them() -> None:
    shown = [parse_mission((MAP + f"  {tasks[0]}").encode()).tasks[0] for tasks in TASKS]
    assert {task.kind for task in shown} == set(TaskKind)
    assert {task.mode for task in shown} == set(TaskMode)
