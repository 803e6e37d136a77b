"""Who plans in flight, beside the loop: what is asked, what is answered, and a planner for flights in lock-step."""

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Final, Protocol, TypeVar

from mission.errors import MissionError
from mission.plan import FlightPlan, plan_to_json
from mission.plan.rest import Rest, plan_rest, plan_return
from mission.spec.model import MissionSpec

_TAKES_S: Final = 0.1

_Made = TypeVar("_Made")


@dataclass(frozen=True, eq=False)
class PlanRequest:
    """What is to be planned.

    Attributes:
        number: Tells the answer from that to another request.
        plan: What is flown.
        rest: How far, and where the new plan begins.
        amended: The mission as it is from now on; None where it stays as it is.
        returns: Whether what is left is given up for a return.
    """

    number: int
    plan: FlightPlan
    rest: Rest
    amended: MissionSpec | None = None
    returns: bool = False


@dataclass(frozen=True, eq=False)
class PlanAnswer:
    """What came of it.

    Attributes:
        number: Of the request.
        plan: What was planned; None where there is no plan.
        text: The same as JSON.
        refusal: Why, in plain words.
    """

    number: int
    plan: FlightPlan | None
    text: str = ""
    refusal: str = ""


class Replanner(Protocol):
    """Plans while the vehicle flies, one request at a time: a newer one takes the place of an older."""

    @property
    def takes_s(self) -> float:
        """How long an answer takes about, on the clock here."""
        ...

    @property
    def trouble(self) -> str:
        """Why no answer will come any more, in plain words; empty while one may."""
        ...

    def prepare(self, plan: FlightPlan) -> None:
        """Get ready to replan a flight, soon."""
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

    def prepare(self, plan: FlightPlan) -> None:
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


def answered(request: PlanRequest) -> PlanAnswer:
    """The answer to a request."""
    try:
        if request.returns:
            plan = plan_return(request.plan, request.rest)
        else:
            plan = plan_rest(request.plan, request.rest, request.amended)
        return PlanAnswer(request.number, plan, plan_to_json(plan))
    except MissionError as error:
        return PlanAnswer(request.number, None, refusal=str(error))
