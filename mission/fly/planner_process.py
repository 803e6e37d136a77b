"""A planner as a process of its own, so that the loop that flies never waits for a plan.

It has pipes that nobody else has, in which each message is preceded by its length (8 bytes, big-endian). Requests and
answers are JSON: the plan that is flown, when the process does not have it, how far it is, and the mission where it was
amended; and the new plan. A thread here writes and reads, so that not even a full pipe stops the loop. Whatever ends
the process, the flight is told that no plan comes.

Before anything is asked for, what a flight might ask for is rehearsed: so all that is read or made once is there, and
how long an answer takes for each of its goals is known, one for which nothing can be kept of the plan that is flown,
and one for which ways are. Garbage is collected between answers, not while somebody waits for one.
"""

import contextlib
import gc
import json
import math
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from subprocess import DEVNULL, PIPE, Popen
from typing import IO, Any, Final, TypeVar

import numpy as np

from mission.errors import MissionError, SpecError
from mission.fly.replanner import PlanAnswer, PlanRequest, answered, goals_of, may_keep
from mission.plan import FlightPlan, plan_from_json, plan_to_json
from mission.plan.rest import Rest
from mission.plan.stages import foresee
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

_MOST_BYTES: Final = 1 << 28
_LENGTH: Final = 8
_TAKES_S: Final = 1.0
"""Until it is known how long an answer takes."""

_ENDS_WITHIN_S: Final = 2.0
_PREPARES_WITHIN_S: Final = 5.0
_SLOWER: Final = 0.99
_FORGETS: Final = 0.8
"""By what part an answer may be expected sooner than the last time: some are had sooner than others."""

_Made = TypeVar("_Made")


class PlannerProcess:
    """Plans beside the loop; the process is started by ``prepare``.

    Attributes:
        takes_s: How long an answer took, on the clock here, for which nothing could be kept.
        trouble: Why no answer will come any more, in plain words; empty while one may.
    """

    def __init__(self) -> None:
        """Start nothing yet."""
        self.takes_s, self.trouble = _TAKES_S, ""
        self._goal_s = {True: _TAKES_S, False: _TAKES_S}  # by whether ways may be kept
        self._requests: queue.SimpleQueue[PlanRequest | FlightPlan | bytes | None] = queue.SimpleQueue()
        self._answers: queue.SimpleQueue[PlanAnswer] = queue.SimpleQueue()
        self._foreseen_s = -math.inf
        self._foresights = self._awaited = self._prepared = 0
        self._thread: threading.Thread | None = None
        self._process: Popen[bytes] | None = None
        self._workers = ThreadPoolExecutor(max_workers=1)

    def takes_about_s(self, goals: int, *, kept: bool) -> float:
        """How long an answer takes, by how long others took for each of their goals, and as if one had more."""
        return (1 + goals) * self._goal_s[kept]

    def prepare(self, plan: FlightPlan) -> None:
        """Start the process, and let it become acquainted with a plan."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._serve, daemon=True)
            self._thread.start()
        self._requests.put(plan)
        self._prepare_for(_mission_text(plan.spec)[0].encode())  # its map, to which a change may lead back

    def foresee(self, mission: bytes) -> None:
        """Let the process prepare for a mission file: what does not depend on where it is begun is there then."""
        if self._thread is not None:
            self._prepare_for(mission)
            self._foreseen_s, self._awaited = time.monotonic(), self._foresights

    def _prepare_for(self, mission: bytes) -> None:
        self._foresights += 1
        self._requests.put(mission)

    @property
    def ready(self) -> bool:
        """Whether that is done, or nobody should wait for it any longer."""
        late = time.monotonic() - self._foreseen_s > _PREPARES_WITHIN_S
        return late or self._prepared >= self._awaited or bool(self.trouble)

    def ask(self, request: PlanRequest) -> None:
        """Begin to plan."""
        if self._thread is None:
            self.prepare(request.plan)
        self._requests.put(request)

    def answer(self) -> PlanAnswer | None:
        """The next answer, if one has come."""
        with contextlib.suppress(queue.Empty):
            return self._answers.get_nowait()
        return None

    def beside(self, work: Callable[[], _Made]) -> "Future[_Made]":
        """Do something in another thread."""
        return self._workers.submit(work)

    @property
    def process_id(self) -> int | None:
        """Of the process; None where there is none."""
        return None if self._process is None else self._process.pid

    def close(self) -> None:
        """End the process."""
        self._requests.put(None)
        self._workers.shutdown(wait=False, cancel_futures=True)
        if self._process is not None:
            self._process.kill()
            self._process.wait(_ENDS_WITHIN_S)
        if self._thread is not None:
            self._thread.join(_ENDS_WITHIN_S)

    def _serve(self) -> None:
        """In the thread: one request after the other."""
        try:
            command = [sys.executable, "-m", __name__]
            with Popen(command, stdin=PIPE, stdout=PIPE, stderr=DEVNULL) as self._process:  # noqa: S603 - this module
                if self._process.stdin is not None and self._process.stdout is not None:
                    self._talk(self._process.stdin, self._process.stdout)
        except (EOFError, OSError, LookupError, TypeError, ValueError, SpecError) as error:
            self.trouble = f"the planner's process has ended ({type(error).__name__})"

    def _talk(self, to_it: IO[bytes], from_it: IO[bytes]) -> None:
        known: FlightPlan | None = None
        made: FlightPlan | None = None
        while (request := self._requests.get()) is not None:
            if isinstance(request, bytes):
                _send(to_it, json.dumps({"foreseen": request.decode()}))
                _received(from_it)
                self._prepared += 1
                continue
            asked = [request] if isinstance(request, PlanRequest) else _rehearsed(request)
            for each in asked:
                began_s = time.monotonic()
                its_own = each.plan is made
                _send(to_it, _written(each, sends=each.plan is not known and not its_own, its_own=its_own))
                known = each.plan
                goals = goals_of(each.plan, each.rest.word, each.amended, returns=each.returns)
                answer = json.loads(_received(from_it))
                made = plan_from_json(answer["plan"]) if answer["plan"] else None
                self._learn(each, goals, time.monotonic() - began_s, least=_FORGETS if each is request else 0.0)
                if each is request:  # whoever finds that it comes too late asks at once for another
                    self._answers.put(
                        PlanAnswer(each.number, made, answer["plan"], answer["refusal"], stopped=answer["stopped"])
                    )

    def _learn(self, asked: PlanRequest, goals: int, took_s: float, *, least: float) -> None:
        """Expect answers as late as this one, and no sooner than by a part of what was expected."""
        kept = may_keep(asked.plan.spec, asked.amended)
        self._goal_s[kept] = max(took_s / (1 + goals), least * self._goal_s[kept])
        if not kept:
            self.takes_s = max(took_s, least * self.takes_s)


def _rehearsed(plan: FlightPlan) -> list[PlanRequest]:
    """What a flight might ask for half way to the first of its rests, or laps: to fly more slowly, or by another map.

    The first answer of all is late, and tells nothing of how long others take.
    """
    leg = plan.trajectory.legs[0]
    at_s = 0.5 * float(leg.law.knots_t_s[np.flatnonzero(leg.law.rates == 0.0)[1:2]].sum())
    place, velocity, acceleration = (tuple(each[0].tolist()) for each in plan.trajectory.state(at_s))
    flight = replace(plan.spec.flight, speed_m_s=_SLOWER * plan.spec.flight.speed_m_s)
    # After a letter, what is left is written as it will be later; in another order the same regions are another map.
    onward = Rest(plan.certificate.word[:1], place, velocity, acceleration, flown_s=at_s)
    slowly = PlanRequest(0, plan, onward, amended=replace(plan.spec, flight=flight))
    elsewhere = replace(slowly, amended=replace(plan.spec, regions=plan.spec.regions[::-1]))
    return [slowly, slowly, elsewhere]


def _written(asked: PlanRequest, *, sends: bool, its_own: bool) -> str:
    return json.dumps(
        {
            "plan": plan_to_json(asked.plan) if sends else "",
            "its_own": its_own,
            "number": asked.number,
            "amended": None if asked.amended is None else _mission_text(asked.amended),
            "returns": asked.returns,
            "rest": _rest_data(asked.rest),
            "stopped": None if asked.stopped is None else _rest_data(asked.stopped),
        }
    )


def _rest_data(rest: Rest) -> dict[str, Any]:
    return {
        "word": [sorted(letter) for letter in rest.word],
        "place_m": rest.place_m,
        "velocity_m_s": rest.velocity_m_s,
        "acceleration_m_s2": rest.acceleration_m_s2,
        "flown_s": rest.flown_s,
        "laps": rest.laps,
        "due": None if rest.due is None else [sorted(letter) for letter in rest.due],
    }


def _rest_of(data: dict[str, Any]) -> Rest:
    word = tuple(frozenset(letter) for letter in data["word"])
    place, velocity, acceleration = (
        (float(data[key][0]), float(data[key][1])) for key in ("place_m", "velocity_m_s", "acceleration_m_s2")
    )
    due = None if data["due"] is None else tuple(frozenset(letter) for letter in data["due"])
    return Rest(word, place, velocity, acceleration, flown_s=data["flown_s"], laps=int(data["laps"]), due=due)


def _mission_text(spec: MissionSpec) -> list[str]:
    """A mission as JSON, and the automaton that it names."""
    return [json.dumps(document_of(spec)), spec.automaton.text if spec.automaton is not None else ""]


def _send(stream: IO[bytes], text: str) -> None:
    data = text.encode()
    stream.write(len(data).to_bytes(_LENGTH, "big") + data)
    stream.flush()


def _received(stream: IO[bytes]) -> bytes:
    """The next message.

    Raises:
        EOFError: The other side is gone.
    """
    length = int.from_bytes(_whole(stream, _LENGTH), "big")
    if length > _MOST_BYTES:
        raise EOFError
    return _whole(stream, length)


def _whole(stream: IO[bytes], length: int) -> bytes:
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return data


def serve(asks: IO[bytes], answers: IO[bytes]) -> None:
    """In the process: answer until the other side is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the flight decides when it is over
    plan: FlightPlan | None = None
    made: FlightPlan | None = None
    gc.disable()
    with contextlib.suppress(EOFError, OSError):
        while True:
            data = json.loads(_received(asks))
            if "foreseen" in data:
                with contextlib.suppress(Exception):  # which whoever asks for it is told
                    foresee(parse_mission(data["foreseen"].encode(), read=lambda _: b""))
                _send(answers, "")
                continue
            if data["its_own"]:
                plan = made
            elif data["plan"]:
                plan = plan_from_json(data["plan"])
            if plan is None:
                return
            answer = _answer(plan, data)
            made = answer.plan
            _send(answers, json.dumps({"plan": answer.text, "refusal": answer.refusal, "stopped": answer.stopped}))
            gc.collect()


def _answer(plan: FlightPlan, data: dict[str, Any]) -> PlanAnswer:
    try:
        amended = None
        if data["amended"] is not None:
            text, named = data["amended"]
            amended = parse_mission(text.encode(), read=lambda _: named.encode())
        stopped = None if data["stopped"] is None else _rest_of(data["stopped"])
        return answered(PlanRequest(data["number"], plan, _rest_of(data["rest"]), stopped, amended, data["returns"]))
    except MissionError as error:
        return PlanAnswer(data["number"], None, refusal=str(error))
    except Exception as error:  # noqa: BLE001 - a failure to plan must not end the planner of a flight
        return PlanAnswer(data["number"], None, refusal=f"the planner failed: {type(error).__name__}: {error}")


if __name__ == "__main__":
    serve(sys.stdin.buffer, sys.stdout.buffer)
