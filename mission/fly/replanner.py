"""Who plans in flight, beside the loop: what is asked, what is answered, and a planner for flights in lock-step."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass
from typing import Final, Protocol, TypeVar

import numpy as np

from mission.errors import AutomatonSizeError, MissionError
from mission.fly.cause import Cause
from mission.logic.formula.operators import Operator
from mission.logic.formula.progression import left_of
from mission.logic.formula.syntax import postorder
from mission.logic.formula.word import Letter
from mission.plan import FlightPlan, plan_to_json
from mission.plan.kept import flown_alike
from mission.plan.rest import Rest, plan_rest, plan_return
from mission.spec.amendment import asks_the_same
from mission.spec.model import MissionSpec
from mission.spec.specification import of_mission

_TAKES_S: Final = 0.1
_MORE: Final = 1.15
_WANTED: Final = frozenset({Operator.EVENTUALLY, Operator.UNTIL})
_SAME: Final = 1e-3
"""m, m/s and m/s^2: rounding, and what a sampled curve leaves."""

_Made = TypeVar("_Made")


@dataclass(frozen=True, eq=False)
class PlanRequest:
    """What is to be planned.

    Attributes:
        number: Tells the answer from that to another request.
        plan: What is flown.
        rest: How far, and where the new plan begins.
        stopped: The same where the vehicle has come to rest; for where there is no plan that begins in motion.
        amended: The mission as it is from now on; None where it stays as it is.
        returns: Whether what is left is given up for a return.
    """

    number: int
    plan: FlightPlan
    rest: Rest
    stopped: Rest | None = None
    amended: MissionSpec | None = None
    returns: bool = False


@dataclass(frozen=True, eq=False)
class PlanAnswer:
    """What came of it.

    Attributes:
        number: Of the request.
        plan: What was planned; None where there is no plan.
        stopped: Whether it begins where the vehicle has come to rest.
        text: The same as JSON.
        refusal: Why, in plain words.
    """

    number: int
    plan: FlightPlan | None
    text: str = ""
    refusal: str = ""
    stopped: bool = False


class Replanner(Protocol):
    """Plans while the vehicle flies, one request at a time: a newer one takes the place of an older."""

    @property
    def takes_s(self) -> float:
        """How long an answer takes about, on the clock here, where nothing of the plan that is flown may be kept."""
        ...

    def takes_about_s(self, goals: int, *, kept: bool) -> float:
        """How long it takes where so much is left to be done (``goals_of``), and ways may be kept or not."""
        ...

    @property
    def trouble(self) -> str:
        """Why no answer will come any more, in plain words; empty while one may."""
        ...

    @property
    def ready(self) -> bool:
        """Whether what was foreseen last is prepared; a plan that is asked for before takes longer by that."""
        ...

    def prepare(self, plan: FlightPlan) -> None:
        """Get ready to replan a flight, soon."""
        ...

    def foresee(self, mission: bytes) -> None:
        """Prepare for a mission file that may have to be planned soon, wherever it is begun."""
        ...

    def ask(self, request: PlanRequest) -> None:
        """Begin to plan."""
        ...

    def answer(self) -> PlanAnswer | None:
        """The next answer, if one has come."""
        ...

    def beside(self, work: Callable[[], _Made]) -> "Future[_Made]":
        """Do something that may take a while, beside the loop."""
        ...


class SynchronousReplanner:
    """Plans at once, and answers after a fixed while: in lock-step the same flight comes of the same seed."""

    trouble = ""

    def __init__(self, now_s: Callable[[], float], takes_s: float = _TAKES_S) -> None:
        """Let each answer take so long by a clock, which is the vehicle's."""
        self.takes_s = takes_s
        self._now_s = now_s
        self._answer: tuple[float, PlanAnswer] | None = None

    def takes_about_s(self, goals: int, *, kept: bool) -> float:
        """As long as any."""
        del goals, kept
        return self.takes_s

    def prepare(self, plan: FlightPlan) -> None:
        """There is nothing to do."""

    @property
    def ready(self) -> bool:
        """There is nothing to wait for."""
        return True

    def foresee(self, mission: bytes) -> None:
        """There is nothing to do."""

    def ask(self, request: PlanRequest) -> None:
        """Plan."""
        self._answer = self._now_s() + self.takes_s, answered(request)

    def answer(self) -> PlanAnswer | None:
        """The answer, once its time has come."""
        if self._answer is None or self._now_s() < self._answer[0]:
            return None
        (_, answer), self._answer = self._answer, None
        return answer

    def beside(self, work: Callable[[], _Made]) -> "Future[_Made]":
        """Do it at once."""
        done: Future[_Made] = Future()
        try:
            done.set_result(work())
        except Exception as error:  # noqa: BLE001 - whoever asks for the result has it
            done.set_exception(error)
        return done


def may_keep(flown: MissionSpec, amended: MissionSpec | None) -> bool:
    """Whether most ways of the plan of a mission may be flown on as they are, if that is amended."""
    return amended is None or (flown_alike(flown, amended) and asks_the_same(flown, amended))


def goals_of(
    plan: FlightPlan, word: Sequence[Letter], amended: MissionSpec | None = None, *, returns: bool = False
) -> int:
    """How much is left to be done after a word, or of what is asked for instead: what the formula wants some time."""
    if returns:
        return 1
    formula = plan.required.formula
    if amended is not None and not asks_the_same(amended, plan.spec):
        formula = of_mission(amended, ()).formula
    else:
        with suppress(AutomatonSizeError):
            formula = left_of(formula, word)
    return sum(node.operator in _WANTED for node in postorder(formula))


def expected_s(replanner: Replanner, plan: FlightPlan, word: Sequence[Letter], cause: Cause) -> float:
    """How long the answer takes at most, on the clock here, to what is asked for after a word of a plan's flight."""
    goals = goals_of(plan, word, cause.amended, returns=cause.returns)
    return _MORE * replanner.takes_about_s(goals, kept=may_keep(plan.spec, cause.amended))


def answered(request: PlanRequest) -> PlanAnswer:
    """The answer to a request: a plan that begins in motion, if it can, and one from rest else."""
    refusal = ""
    for rest in filter(None, (request.rest, request.stopped)):
        try:
            if request.returns:
                plan = plan_return(request.plan, rest)
            else:
                plan = plan_rest(request.plan, rest, request.amended)
        except MissionError as error:
            refusal = str(error)
            continue
        if not rest.begins.moves or _begins_with(plan, rest):
            return PlanAnswer(request.number, plan, plan_to_json(plan), stopped=rest is request.stopped)
        refusal = "the plan begins with another motion"
    return PlanAnswer(request.number, None, refusal=refusal)


def _begins_with(plan: FlightPlan, rest: Rest) -> bool:
    """Whether a plan begins with the motion that was promised."""
    state = np.array(plan.trajectory.state([0.0]))[:, 0]
    wanted = np.array([rest.place_m, rest.velocity_m_s, rest.acceleration_m_s2])
    return bool((np.abs(state - wanted) <= _SAME).all())
