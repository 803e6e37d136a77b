"""Questions to the vehicle's services as state machines without I/O: what to send, and whether that is done.

A question is sent again where nothing follows, on the clock here. Of an upload the vehicle asks for item after item;
its answer to the whole may be lost, and then nothing comes of asking again: whoever must know reads back what is there.
"""

import math
from abc import ABC, abstractmethod
from typing import Final

from mission.link.packing import Message
from mission.link.plan_values import (
    Partner,
    PlanAnswer,
    PlanBody,
    PlanCount,
    PlanItem,
    PlanKind,
    PlanPart,
    PlanRequest,
)
from mission.link.services import (
    ACCEPTED,
    PASSING,
    parameter_request,
    parameter_setting,
    plan_clearing,
    plan_count,
    plan_item,
    plan_item_request,
    plan_list_request,
    plan_received,
    plan_result_name,
)
from mission.link.values import Body, ParameterValue

PATIENCE_S: Final = 0.5
ATTEMPTS: Final = 20
"""In a row without effect: where three of ten messages are lost each way, one question in a million is in vain."""

_MOST_ITEMS: Final = 1000
_OFTEN: Final = 8


class Question(ABC):
    """One thing that is asked.

    Attributes:
        done: Whether it is answered.
        trouble: Why it never will be, in plain words; empty while it may.
        silent: Whether that is because nobody answers.
        about: What it is about, for people.
    """

    about = ""

    def __init__(self) -> None:
        """Begin."""
        self.done = self.silent = False
        self.trouble = ""

    @abstractmethod
    def message(self, system_id: int) -> Message:
        """What to send now, for the first time or again."""

    @abstractmethod
    def take(self, body: Body) -> bool:
        """Take what the vehicle says; True where that leads on, so that the next message is due at once."""

    def closing(self, system_id: int) -> Message | None:  # noqa: ARG002 - most end with the answer
        """What is sent once at the end; None where nothing is."""
        return None

    def unanswered(self) -> None:
        """Nothing follows, however often it is asked."""
        self.silent = True
        self.trouble = f"the vehicle does not answer about {self.about}"


class ParameterQuestion(Question):
    """Reads one parameter, of which it has to be known whether it is there.

    Attributes:
        value: What it is; None where the vehicle knows none of that name.
        type: Its MAV_PARAM_TYPE.
    """

    def __init__(self, name: str, *, bytewise: bool, optional: bool = False) -> None:
        """Read; silence about one that is ``optional`` means that there is none."""
        super().__init__()
        self.about = f"its parameter {name}"
        self.value: float | None = None
        self.type = 0
        self._name, self._bytewise, self._optional = name, bytewise, optional

    def message(self, system_id: int) -> Message:
        """Ask for it."""
        return parameter_request(system_id, self._name)

    def take(self, body: Body) -> bool:
        """Take its value."""
        if isinstance(body, ParameterValue) and body.name == self._name:
            self.value, self.type, self.done = body.value(bytewise=self._bytewise), body.type, True
        return self.done

    def unanswered(self) -> None:
        """It is not there, or nobody answers."""
        self.done = self._optional
        if not self._optional:
            super().unanswered()


class ParameterSetting(Question):
    """Sets one parameter, until the vehicle says that it has that value."""

    def __init__(self, name: str, value: float, kind: int, *, bytewise: bool) -> None:
        """Set it to ``value``, of MAV_PARAM_TYPE ``kind``."""
        super().__init__()
        self.about = f"its parameter {name}"
        self._name, self._value, self._kind, self._bytewise = name, value, kind, bytewise
        self._others = 0

    def message(self, system_id: int) -> Message:
        """Set it."""
        return parameter_setting(system_id, self._name, self._value, self._kind, bytewise=self._bytewise)

    def take(self, body: Body) -> bool:
        """Take its value, which may be an answer to an earlier question."""
        if not isinstance(body, ParameterValue) or body.name != self._name:
            return False
        value = body.value(bytewise=self._bytewise)
        self.done = math.isclose(value, self._value, rel_tol=1e-6)
        self._others += not self.done
        if self._others >= _OFTEN:
            self.trouble = f"the vehicle keeps its parameter {self._name} at {value:g} instead of {self._value:g}"
        return self.done


class PlanReading(Question):
    """Reads all items of a plan.

    Attributes:
        items: What there is, once it is done.
    """

    def __init__(self, kind: PlanKind, own: Partner, about: str) -> None:
        """Read it as ``own``."""
        super().__init__()
        self.about = about
        self.items: list[PlanItem] = []
        self._kind, self._own = kind, own
        self._count: int | None = None
        self._refusal = ""

    def message(self, system_id: int) -> Message:
        """Ask how many there are, or for the next one."""
        if self._count is None:
            return plan_list_request(system_id, self._kind)
        return plan_item_request(system_id, self._kind, len(self.items))

    def closing(self, system_id: int) -> Message | None:
        """Say that all have come."""
        return plan_received(system_id, self._kind)

    def take(self, body: Body) -> bool:
        """Take the number of items, and each in its turn."""
        if not _is_for(self._own, self._kind, body):
            return False
        if isinstance(body, PlanAnswer) and body.result != ACCEPTED:
            self._refusal = f"the vehicle does not tell {self.about}: {plan_result_name(body.result)}"
            self.trouble = "" if body.result in PASSING else self._refusal
            return bool(self.trouble)
        if isinstance(body, PlanCount) and self._count is None:
            self._count = min(body.count, _MOST_ITEMS)
        elif isinstance(body, PlanPart) and self._count is not None and body.number == len(self.items):
            self.items.append(body.item)
        else:
            return False
        self.done = len(self.items) == self._count
        return True

    def unanswered(self) -> None:
        """It is refused all the time, or nobody answers."""
        super().unanswered()
        if self._refusal:
            self.silent, self.trouble = False, self._refusal


class PlanWriting(Question):
    """Replaces all items of a plan, as a whole.

    It is done once all items were taken, whether or not the vehicle's answer to the whole has come.

    Attributes:
        answer: What the vehicle said to the whole that is not yes, in plain words.
    """

    def __init__(self, kind: PlanKind, items: tuple[PlanItem, ...], own: Partner, about: str) -> None:
        """Write ``items`` as ``own``; none clear the plan, for a count of 0 leaves ArduPilot's as it is."""
        super().__init__()
        self.about = about
        self._kind, self._items, self._own = kind, items, own
        self._asked: int | None = None
        self.answer = ""

    def message(self, system_id: int) -> Message:
        """Say how many there are, or give the one that was asked for."""
        if not self._items:
            return plan_clearing(system_id, self._kind)
        if self._asked is None:
            return plan_count(system_id, self._kind, len(self._items))
        return plan_item(system_id, self._kind, self._asked, self._items[self._asked])

    def take(self, body: Body) -> bool:
        """Take what is asked for, and the answer to the whole."""
        if not _is_for(self._own, self._kind, body):
            return False
        if isinstance(body, PlanAnswer):
            # After the last item this may be the answer to one that was sent twice.
            self.answer = "" if body.result == ACCEPTED else plan_result_name(body.result)
            self.done = not self.answer or self._all_given
            if not self.done and body.result in PASSING:
                return False
            self.trouble = "" if self.done else f"the vehicle refuses {self.about} ({self.answer})"
        elif isinstance(body, PlanRequest) and body.number < len(self._items) and body.number != self._asked:
            # The same again is what came twice, or follows from that; where it was lost, it is sent again in time.
            self._asked = body.number
        else:
            return False
        return True

    def unanswered(self) -> None:
        """The answer to the whole may have been lost."""
        self.done = self._all_given
        if self.done:
            return
        super().unanswered()
        if self.answer:
            self.silent, self.trouble = False, f"the vehicle refuses {self.about} ({self.answer})"

    @property
    def _all_given(self) -> bool:
        return self._asked == len(self._items) - 1


def _is_for(own: Partner, kind: PlanKind, body: Body) -> bool:
    """Whether a message is about this plan and for us: another ground station may be reading the same one."""
    if not isinstance(body, PlanBody) or body.kind != kind:
        return False
    return body.partner.system_id in (0, own.system_id) and body.partner.component_id in (0, own.component_id)


class Asking:
    """Asks one question until it is answered or in vain; times are of the clock here."""

    def __init__(self, question: Question) -> None:
        """Ask it."""
        self.question = question
        self._next_s = -math.inf
        self._silent = 0

    @property
    def over(self) -> bool:
        """Whether it is answered, or in vain."""
        return self.question.done or bool(self.question.trouble)

    def take(self, body: Body) -> None:
        """Take what the vehicle says."""
        if not self.over and self.question.take(body):
            self._next_s, self._silent = -math.inf, 0

    def due(self, system_id: int, now_s: float) -> Message | None:
        """What to send now; None where nothing is due."""
        if self.over or now_s < self._next_s:
            return None
        if self._silent >= ATTEMPTS:
            self.question.unanswered()
            return None
        self._silent += 1
        self._next_s = now_s + PATIENCE_S
        return self.question.message(system_id)

    def wait_s(self, now_s: float) -> float:
        """How long until something is due."""
        return math.inf if self.over else max(self._next_s - now_s, 0.0)
