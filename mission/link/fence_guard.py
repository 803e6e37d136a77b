"""The vehicle's own geofence as a guard that does not depend on this program: set before arming, put back afterwards.

What the vehicle has is read first. The new one is uploaded while the fence is off, read back and compared; then come
the parameters, and the switch last. Putting back goes the same way, so that the vehicle never obeys half of a fence,
whoever flies it then. Each change is read back; what could not be put back is told.
"""

import math
import struct
from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from mission.errors import LinkError, MissionError, VehicleError
from mission.interchange.autopilot_plan import FenceCircle, FencePolygon
from mission.link.exchanges import Asking, ParameterQuestion, ParameterSetting, PlanReading, PlanWriting, Question
from mission.link.fence_rules import FenceRules
from mission.link.packing import Message
from mission.link.plan_values import Partner, PlanItem, PlanKind
from mission.link.services import (
    CIRCLE_TO_STAY_IN,
    CIRCLE_TO_STAY_OUT_OF,
    CORNER_TO_STAY_IN,
    CORNER_TO_STAY_OUT_OF,
    GLOBAL_FRAME,
)
from mission.link.values import Body

_TRIES: Final = 5
_ABOUT: Final = "its geofence"
_E7: Final = 1e7
_HINT: Final = "`--no-fence` flies without one"

_Asked = Generator[Question, None, None]


@dataclass(frozen=True)
class FenceBefore:
    """What the vehicle had: parameters by name, of those that it has, and the items of its fence."""

    parameters: Mapping[str, float]
    items: tuple[PlanItem, ...]


def fence_items(areas: Iterable[FencePolygon | FenceCircle]) -> tuple[PlanItem, ...]:
    """Areas as the items of a plan: each corner of a polygon says how many there are, a circle how large it is."""
    items: list[PlanItem] = []
    for area in areas:
        if isinstance(area, FenceCircle):
            command = CIRCLE_TO_STAY_IN if area.inclusion else CIRCLE_TO_STAY_OUT_OF
            places, first = [area.centre], _single(area.radius_m)
        else:
            command = CORNER_TO_STAY_IN if area.inclusion else CORNER_TO_STAY_OUT_OF
            places, first = list(area.corners), float(len(area.corners))
        items += [
            PlanItem(
                GLOBAL_FRAME,
                command,
                (first, 0.0, 0.0, 0.0),
                round(place.latitude_deg * _E7),
                round(place.longitude_deg * _E7),
                0.0,
            )
            for place in places
        ]
    return tuple(items)


class FenceGuard:
    """The geofence of one flight.

    Attributes:
        items: What the vehicle is to keep.
        before: What it had; None before that is known.
        is_set: Whether it keeps the new one, and is stopped by it.
        failure: Why it could not be set; None while it can.
    """

    def __init__(
        self,
        items: tuple[PlanItem, ...],
        rules: FenceRules,
        *,
        ceiling_m: float,
        own: Partner,
        bytewise: bool,
        keep: bool = False,
        before: FenceBefore | None = None,
        earlier: Sequence[tuple[PlanItem, ...]] = (),
    ) -> None:
        """Set it from the next ``advance`` on.

        Args:
            items: Its areas.
            rules: What the vehicle's kind wants to be told.
            ceiling_m: Height above home that is not to be exceeded.
            own: Who we are.
            bytewise: Whether the vehicle sends whole numbers of parameters as bytes.
            keep: Whether it stays after the flight.
            before: What the vehicle had, where it has been set already, by another program; then nothing is set, and
                nothing is put back where somebody else has set a fence since.
            earlier: What else of this flight it may keep, as that program was on the way to ``items``.
        """
        self.items = items
        self.before = before
        self._earlier = earlier
        self.is_set = before is not None
        self.failure: MissionError | None = None
        self._lost: list[str] = []
        self._rules, self._ceiling_m, self._own, self._bytewise, self._keep = rules, ceiling_m, own, bytewise, keep
        self._types: dict[str, int] = {}
        self._touched = self._inherited = before is not None
        self._foreign = False
        self._returning = False
        self._task: _Asked | None = self._set() if before is None else None
        self._asking: Asking | None = None

    @property
    def unfinished(self) -> bool:
        """Whether something is being changed, or is still to be put back."""
        return self._task is not None or (self._touched and not self._keep and not self._returning)

    @property
    def trouble(self) -> str:
        """What of the vehicle's own fence was not put back, in plain words; empty where nothing was left out."""
        if self._foreign:
            return "somebody else has given the vehicle another geofence since, which stays as it is"
        lost = self._lost or ["its parameters and its items"] * (self._returning and self.unfinished)
        return f"of the vehicle's own geofence this was not put back: {', '.join(lost)}" if lost else ""

    @property
    def parameters(self) -> Mapping[str, float]:
        """What the vehicle's parameters are set to, once it is known what they were."""
        if self.before is None:
            return {}
        wanted = self._rules.wanted(self.before.parameters, self._ceiling_m)
        known = {name: value for name, value in wanted.items() if name in self._types}
        return {**known, self._rules.switch: self._rules.on}

    def put_back(self) -> None:
        """From now on let the vehicle have what it had, if anything was changed and is not to be kept; once."""
        if self._returning:
            return
        self._returning = True
        self._asking = None
        self._task = self._restore() if self._touched and not self._keep else None

    def renew(self, items: tuple[PlanItem, ...]) -> None:
        """From now on let the vehicle keep other items, with the fence off meanwhile; not where it is put back."""
        if self.is_set and not self._returning:
            self.items, self._inherited = items, False
            self._asking, self._task = None, self._renewed()

    def confirm(self) -> None:
        """See that the vehicle still keeps what another program set, and set it where that had not come to its end."""
        if self.before is not None and self._inherited:
            self._asking, self._task = None, self._confirmed(self.before)

    def take(self, body: Body) -> None:
        """Take what the vehicle says."""
        if self._asking is not None:
            self._asking.take(body)

    def advance(self, system_id: int, now_s: float) -> list[Message]:
        """What to send to the vehicle now."""
        out: list[Message] = []
        while self._task is not None:
            if self._asking is None and not self._ask_next():
                break
            if self._asking is not None and (message := self._asking.due(system_id, now_s)) is not None:
                out.append(message)
            if self._asking is None or not self._asking.over:
                break
            if (closing := self._asking.question.closing(system_id)) is not None:
                out.append(closing)
            self._asking = None
        return out

    def wait_s(self, now_s: float) -> float:
        """How long until something is due, on the clock here; infinite where nothing is."""
        return math.inf if self._asking is None else self._asking.wait_s(now_s)

    def _ask_next(self) -> bool:
        """Go on with what is done at present; False where it is over."""
        if self._task is None:
            return False
        try:
            self._asking = Asking(next(self._task))
        except StopIteration:
            self._task = None
        except MissionError as error:
            self._task, self.failure = None, error
        return self._task is not None

    def _read(self, names: Iterable[str], parameters: dict[str, float]) -> _Asked:
        """Read parameters, and of which types they are."""
        for name in names:
            reading = ParameterQuestion(name, bytewise=self._bytewise, optional=name in self._rules.optional)
            yield from _answered(reading)
            if reading.value is not None:
                parameters[name], self._types[name] = reading.value, reading.type

    def _set(self) -> _Asked:
        rules, parameters = self._rules, dict[str, float]()
        yield from self._read((rules.switch, *rules.parameters), parameters)
        plan = PlanReading(PlanKind.FENCE, self._own, _ABOUT)
        yield from _answered(plan)
        self.before = FenceBefore(parameters, tuple(plan.items))
        self._touched = True
        now = dict(parameters)
        yield from self._change(rules.switch, rules.off, now)
        yield from self._replace(self.items)
        for name, value in self.parameters.items():
            yield from self._change(name, value, now)
        self.is_set = True

    def _renewed(self) -> _Asked:
        rules = self._rules
        now = {rules.switch: math.nan}
        yield from self._change(rules.switch, rules.off, now)
        yield from self._replace(self.items)
        yield from self._change(rules.switch, rules.on, now)

    def _confirmed(self, before: FenceBefore) -> _Asked:
        kept = yield from self._look(before)
        if self._foreign:
            return
        now: dict[str, float] = {}
        yield from self._read((self._rules.switch,), now)
        if now[self._rules.switch] == self._rules.off or not _same(kept, self.items):
            yield from self._renewed()

    def _restore(self) -> _Asked:
        before, rules = self.before, self._rules
        if before is None:
            return
        if self._inherited:
            yield from self._look(before)
            if self._foreign:
                return
        now = dict.fromkeys(before.parameters, math.nan)  # how far it has come is not known
        others = [(name, value) for name, value in before.parameters.items() if name != rules.switch]
        steps = [
            (f"{rules.switch} {rules.off:g}", self._change(rules.switch, rules.off, now)),
            (f"the {len(before.items)} items of its fence", self._replace(before.items)),
            *((f"{name} {value:g}", self._change(name, value, now)) for name, value in others),
            (
                f"{rules.switch} {before.parameters[rules.switch]:g}",
                self._change(rules.switch, before.parameters[rules.switch], now),
            ),
        ]
        heard = True
        for what, step in steps:
            try:
                if heard:
                    yield from step
            except MissionError as error:
                self._lost.append(what)
                heard = not isinstance(error, LinkError)
            else:
                self._lost += [what] * (not heard)

    def _look(self, before: FenceBefore) -> Generator[Question, None, list[PlanItem]]:
        """See whether somebody else has set a fence since another program did; silence is for those who ask next."""
        reading = PlanReading(PlanKind.FENCE, self._own, _ABOUT)
        yield reading
        kept = reading.items
        ours = (self.items, before.items, *self._earlier)
        self._foreign = reading.done and not any(_same(kept, items) for items in ours)
        return kept

    def _change(self, name: str, value: float, now: dict[str, float]) -> _Asked:
        """Set a parameter that is not so already."""
        value = _single(value)
        if now[name] != value:
            if name not in self._types:  # it was set by another program, in whose stead we are
                yield from self._read((name,), {})
            yield from _answered(ParameterSetting(name, value, self._types[name], bytewise=self._bytewise))
            now[name] = value

    def _replace(self, items: tuple[PlanItem, ...]) -> _Asked:
        """Upload items until they are read back as they are."""
        answer = ""
        for _ in range(_TRIES):
            writing = PlanWriting(PlanKind.FENCE, items, self._own, _ABOUT)
            yield writing
            answer = writing.trouble or writing.answer or answer
            reading = PlanReading(PlanKind.FENCE, self._own, _ABOUT)
            yield from _answered(reading)
            if _same(reading.items, items):
                return
            if writing.trouble:
                break  # it was refused, for as long as it is asked
        said = f": {answer}" if answer else ""
        raise VehicleError(f"the vehicle does not keep the geofence that it was given{said}; {_HINT}")


def _answered(question: Question) -> _Asked:
    """Ask, and fail where that is in vain."""
    yield question
    if question.trouble:
        raise (LinkError if question.silent else VehicleError)(f"{question.trouble}; {_HINT}")


def _same(kept: Sequence[PlanItem], items: Sequence[PlanItem]) -> bool:
    return len(kept) == len(items) and all(a.same_as(b) for a, b in zip(kept, items, strict=True))


def _single(value: float) -> float:
    """The nearest number that a message holds."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])
