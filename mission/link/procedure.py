"""Takes a vehicle through steps, one after the other, without I/O."""

from collections.abc import Callable
from typing import Final

from mission.errors import LinkError, MissionError, VehicleError
from mission.link.events import WentOn
from mission.link.requests import Answer, RequestChannel
from mission.link.steps import Scene, Step
from mission.link.values import Command, Result
from mission.link.vehicle_state import VehicleState

_WORDS_WITHIN_S: Final = 0.5
"""How long an explanation may follow a refusal, on the clock here, or come before the step, by the vehicle's."""

_AGAIN_S: Final = 1.0
_PASSING: Final = (Result.TEMPORARILY_REJECTED, Result.FAILED)
"""Refusals that may be about something that passes."""


class Procedure:
    """The steps that are left, the present one first.

    Attributes:
        entered: Counts the steps entered, so that a change can be seen.
    """

    def __init__(
        self,
        steps: tuple[Step, ...],
        channel: RequestChannel,
        words_since: Callable[[float], str],
        note: Callable[[WentOn], None],
    ) -> None:
        """Begin; ``words_since`` gives what the vehicle has said since a vehicle time, ``note`` takes events."""
        self._steps = list(steps)
        self._channel = channel
        self._words_since, self._note = words_since, note
        self._started_s: float | None = None
        self._ask_at_s = 0.0
        self._asked: Command | None = None
        self._refused: tuple[Answer, float] | None = None
        self._unanswered = False
        self._beats: int | None = None
        self.entered = 0

    def replace(self, steps: tuple[Step, ...], vehicle_s: float) -> None:
        """Go on with other steps, the first of which begins anew without being asked for."""
        self._channel.forget()
        self._steps = list(steps)
        self._started_s = vehicle_s
        self._refused, self._unanswered = None, False

    @property
    def step(self) -> Step | None:
        """The present step; None after the last."""
        return self._steps[0] if self._steps else None

    @property
    def started_s(self) -> float | None:
        """When the present step began, vehicle time; None before it did."""
        return self._started_s

    def allows(self, mode: int) -> bool:
        """Whether the vehicle may be told something in this mode: over no other than was asked for."""
        return self.step is None or self.step.modes is None or mode in self.step.modes

    def weigh(self, vehicle: VehicleState, local_s: float) -> None:
        """Hold the command back unless a heartbeat that has just come shows that nobody else flies.

        Between two heartbeats somebody may have taken the vehicle: so what is not pressing waits for the next one, as
        does each repetition, but where none comes.
        """
        step, fresh = self.step, self._beats is not None and vehicle.beats != self._beats
        self._beats = vehicle.beats
        watched = step is not None and step.modes is not None and self._channel.carries(self._asked)
        presses = step is not None and step.at_once and not self._channel.is_sent
        told = fresh or presses or vehicle.is_silent(local_s)
        self._channel.held = watched and not (told and self.allows(vehicle.mode))

    def take(self, answer: Answer, vehicle_s: float, local_s: float) -> None:
        """Take the answer to the present step's command."""
        step = self.step
        if step is None or self._started_s is None or answer.command is not self._asked:
            return  # of what was asked beside the steps
        self._unanswered = answer.result is None
        if answer.result is None:
            self._ask_at_s = vehicle_s  # the way may be long: telemetry tells, and what is late is still an answer
        elif answer.result is Result.ACCEPTED:
            self._ask_at_s = vehicle_s + step.repeat_s
        elif answer.result in _PASSING and vehicle_s - self._started_s < step.patience_s:
            self._ask_at_s = vehicle_s + _AGAIN_S
        else:
            self._refused = (answer, local_s)

    def advance(self, scene_at: Callable[[float], Scene], vehicle_s: float, local_s: float) -> None:
        """Go on as far as telemetry shows.

        Args:
            scene_at: What is known now, for a step that has lasted so long.
            vehicle_s: The vehicle's time.
            local_s: The time here.

        Raises:
            VehicleError: The vehicle refused, or did not do what it accepted; with its own words.
            LinkError: It never answered, nor did it do what it was asked to.
        """
        while (step := self.step) is not None:
            if self._started_s is None:
                self._enter(step, vehicle_s)
            scene = scene_at(vehicle_s - (self._started_s or vehicle_s))
            if not step.confirmed(scene):
                break
            self._leave()
        if step is None:
            return
        if self._refused is not None:
            self._judge_refusal(local_s)
        elif scene.in_step_s > step.limit_s:
            if not step.suffices(scene):
                raise self._overdue(step)
            self._note(WentOn(vehicle_s, f"the vehicle {step.missing} within {step.limit_s:.0f} s"))
            self._leave()
        elif step.command is not None and not self._channel.busy and vehicle_s >= self._ask_at_s:
            self._ask_at_s = float("inf")  # until it is answered
            self._asked = step.command(scene)
            self._channel.ask(self._asked, local_s)

    def _enter(self, step: Step, vehicle_s: float) -> None:
        self._started_s = vehicle_s
        self._unanswered = False
        self._ask_at_s = vehicle_s + step.wait_s
        self._refused = None
        self.entered += 1

    def _leave(self) -> None:
        self._channel.forget()
        self._steps.pop(0)
        self._started_s = None

    def _judge_refusal(self, local_s: float) -> None:
        if self._refused is None:
            return
        answer, heard_s = self._refused
        if answer.result is not None and local_s - heard_s >= _WORDS_WITHIN_S:
            refusal = answer.result.name.lower().replace("_", " ")
            raise VehicleError(self._explained(f"the vehicle refused to {answer.command.name} ({refusal})"))

    def _overdue(self, step: Step) -> MissionError:
        if self._unanswered and self._asked is not None:
            return LinkError(self._explained(f"the vehicle never answered the command to {self._asked.name}"))
        return VehicleError(self._explained(f"the vehicle {step.missing} within {step.limit_s:.0f} s"))

    def _explained(self, what: str) -> str:
        words = self._words_since((self._started_s or 0.0) - _WORDS_WITHIN_S)
        return f"{what}; it says: {words}" if words else what
