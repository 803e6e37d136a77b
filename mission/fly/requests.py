"""What somebody who watches may ask of a flight, and how that is granted, or refused in words.

Each request and what came of it is written down. Whoever flies the vehicle otherwise is never fought: while a pilot
has it, everything is refused.
"""

from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Final, Protocol

from mission.fly.cause import Cause
from mission.fly.recording import RecordWriter
from mission.fly.replanning import Replanning
from mission.fly.watch import FlightWatch
from mission.link.guidance import Guidance
from mission.link.session import Session
from mission.monitor.stage import Stage

_CLEAR_M: Final = 2.0
"""By this height heartbeats, one a second, tell the mode of the climb: then it is known what a landing has to end."""

_DESCENDING: Final = frozenset({Stage.LAND, Stage.TOUCH_DOWN, Stage.DISARM})


class Request(StrEnum):
    """What is asked for."""

    HOLD = "hold"
    """Come to rest on the path, and wait there."""
    RESUME = "resume"
    """Go on from there."""
    RETURN = "return"
    """Give up what is left of the mission and fly home on a way that is planned and proved first."""
    LAND = "land"
    """Land where the vehicle is."""


class Requests(Protocol):
    """Where requests come from; neither method may wait."""

    def take(self) -> Request | None:
        """The next, if there is one."""
        ...

    def answer(self, request: Request, words: str, *, granted: bool) -> None:
        """Say what came of one."""
        ...


class NoRequests:
    """Nobody asks."""

    def take(self) -> Request | None:
        """Nothing."""
        return None

    def answer(self, request: Request, words: str, *, granted: bool) -> None:
        """There is nobody to be told."""


class Heeding:
    """Grants requests, one a turn."""

    def __init__(
        self,
        session: Session,
        watch: FlightWatch,
        record: RecordWriter,
        replanning: Replanning,
        requests: Requests,
        *,
        say: Callable[[str], None],
        land: Callable[[str], None],
    ) -> None:
        """Grant none yet.

        Args:
            session: The flight.
            watch: What is known of it.
            record: Where it is written down.
            replanning: What holds the vehicle on its plan, and plans the way home.
            requests: Where they come from.
            say: Tells whoever watches the vehicle what is intended.
            land: Gives the flight up, with this reason, by a landing on the spot.
        """
        self._session, self._watch, self._record = session, watch, record
        self._replanning, self._requests, self._say, self._land = replanning, requests, say, land

    def turn(self, now_s: float) -> None:
        """Take the next request, if there is one, and grant it if that is possible now.

        Args:
            now_s: The time here.
        """
        request = self._requests.take()
        if request is None:
            return
        self._record.write("event", self._session.vehicle.clock.newest_s, name="request", request=request.value)
        if self._session.stage is Stage.DONE:
            self._answer(request, "the flight is over", granted=False)
        elif self._session.pilot.words:
            self._answer(request, f"{self._session.pilot.words}: whoever flies it is not fought", granted=False)
        elif request is Request.LAND:
            self._answer_land(now_s)
        else:
            self._answer_on_path(request, now_s)

    def _answer_land(self, now_s: float) -> None:
        stage, vehicle_s = self._session.stage, self._session.vehicle.clock.now_s(now_s)
        if stage in _DESCENDING:
            self._answer(Request.LAND, f"the vehicle is {stage} already", granted=False)
        elif vehicle_s is None or not self._is_clear(vehicle_s):
            # One that is about to lift off cannot be disarmed for sure, either.
            words = f"the vehicle is {stage}: it can land once it is {_CLEAR_M:g} m high"
            self._answer(Request.LAND, words, granted=False)
        else:
            self._answer(Request.LAND, "the vehicle lands where it is", granted=True)
            self._land("a landing was asked for")

    def _is_clear(self, vehicle_s: float) -> bool:
        """Whether the vehicle is in the air, and no longer about to lift off."""
        scene = self._session.lead.scene(vehicle_s, 0.0, 0.0)
        rises = self._session.stage in (Stage.TAKE_OFF, Stage.CLIMB)
        return scene.airborne and (not rises or scene.height_m >= _CLEAR_M)

    def _answer_on_path(self, request: Request, now_s: float) -> None:
        """Answer what only makes sense while the trajectory is flown."""
        session, guidance = self._session, self._session.guidance
        vehicle_s = session.contact.arrives_s(now_s)
        if not session.redirectable or vehicle_s is None:
            why = f"the vehicle is {session.stage}: it can {request} only while it flies its path"
            self._answer(request, why, granted=False)
        elif not isinstance(guidance, Guidance):
            why = f"a vehicle that is led by the field flies no path: it cannot {request}, it can land"
            self._answer(request, why, granted=False)
        elif self._replanning.busy:
            why = "another plan is being made: ask again once it is flown, or land"
            self._answer(request, why, granted=False)
        else:
            _GRANT[request](self, guidance, vehicle_s)

    def _hold(self, guidance: Guidance, vehicle_s: float) -> None:
        if self._replanning.held:
            self._answer(Request.HOLD, "the vehicle holds already", granted=False)
            return
        if coming := self._watch.coming(vehicle_s, soon=True):
            self._answer(Request.HOLD, f"{coming}; the plan is flown on", granted=False)
            return
        self._replanning.hold(guidance, vehicle_s)
        self._replanning.held = True
        self._answer(Request.HOLD, "the vehicle slows to rest on its path and holds there", granted=True)

    def _resume(self, guidance: Guidance, vehicle_s: float) -> None:
        closing = self._watch.closing(vehicle_s, guidance.flown_s(vehicle_s)) if self._replanning.held else ""
        if why := closing or self._replanning.go_on(guidance, vehicle_s):
            self._answer(Request.RESUME, why, granted=False)
        else:
            self._answer(Request.RESUME, "the plan is flown on", granted=True)

    def _return(self, _guidance: Guidance, _vehicle_s: float) -> None:
        if self._watch.legs.given_up is not None:
            self._answer(Request.RETURN, "the vehicle returns already", granted=False)
        else:
            self._replanning.begin(Cause("asked to return", returns=True, told=self._answer_return))

    def _answer_return(self, why: str) -> None:
        """Say why there is no way home, or, with no words, that it is flown."""
        onward = "the vehicle holds" if self._replanning.held else "the old plan is flown on"
        words = f"{why}; {onward}" if why else "the vehicle returns home, and what is left is given up"
        self._answer(Request.RETURN, words, granted=not why)

    def _answer(self, request: Request, words: str, *, granted: bool) -> None:
        self._record.write(
            "event",
            self._session.vehicle.clock.newest_s,
            name="request answered",
            request=request.value,
            granted=granted,
            reason=words,
        )
        self._say(f"asked to {request}: {words}")
        self._requests.answer(request, words, granted=granted)


_GRANT: Final[Mapping[Request, Callable[[Heeding, Guidance, float], None]]] = {
    Request.HOLD: Heeding._hold,  # noqa: SLF001 - the table of this class
    Request.RESUME: Heeding._resume,  # noqa: SLF001
    Request.RETURN: Heeding._return,  # noqa: SLF001
}
