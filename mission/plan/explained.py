"""The failure of a mission's search, explained by the parts of the mission that cannot be met."""

import numpy as np

from mission.errors import AutomatonSizeError, NoPlanError
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.formula.conjuncts import conjuncts
from mission.plan.diagnosis import Cause, diagnose
from mission.planning.transition_system import TransitionSystem
from mission.spec.loss import out_of_reach
from mission.spec.model import MissionSpec
from mission.spec.specification import formula_of
from mission.spec.tasks import task_formula, task_text


def explained(
    error: NoPlanError, spec: MissionSpec, partition: Partition, labelling: Labelling, *, start: int
) -> NoPlanError:
    """Explain why what a mission must meet has no run.

    Args:
        error: The failure as it was found.
        spec: The mission; tasks with a weight need not be met and play no part.
        partition: Its triangles.
        labelling: Their labels.
        start: The start triangle.

    Returns:
        The failure with its parts; ``error`` itself where the question is too large.
    """
    every_way = TransitionSystem.from_partition(partition, labelling, np.zeros(partition.size, dtype=np.bool_))
    names = [region.name for region in spec.regions if region.forbidden]
    soft = [number for number, task in enumerate(spec.tasks) if task.weight is not None]
    origins = {
        conjunct: f"task {task_text(task)}"
        for number, task in enumerate(spec.tasks)
        if number not in soft
        for conjunct in conjuncts(task_formula(task, spec.regions))
    }
    try:
        found = diagnose(
            formula_of(spec, soft),
            every_way,
            names,
            start,
            spec.semantics,
            given=spec.automaton,
            origins=origins,
        )
    except AutomatonSizeError:
        return error
    if found is None:
        return error
    begins_m = partition.incentres_m[start]
    parts = out_of_reach(spec, (begins_m[0], begins_m[1])) if found.cause is Cause.UNREACHABLE else ()
    return NoPlanError(
        "\n".join((found.text, *parts)),
        cause=found.cause,
        conjuncts=found.conjuncts,
        restricted=found.restricted,
        regions=found.regions,
    )
