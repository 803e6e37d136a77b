"""Vehicle time in lock-step with those who fly: no turn of it begins before they have had theirs.

Each turn ends with a PING on every link of a flight (https://mavlink.io/en/services/ping.html: who gets one that is for
all returns it to its sender), behind what the vehicle has said meanwhile. Who answers it has handled all of that, and
his words came before the answer. So what is flown depends neither on the speed of a machine nor on what else it does.

A turn ends with the step at which the vehicle tells its local position, and after ``_LONGEST_TURN_S`` in any case.
Vehicle time stands at zero until somebody has answered. Who does not answer within ``MOST_S`` of wall time is gone:
vehicle time goes on, and failsafes come as ever; whoever answers again is waited for again.
"""

from collections.abc import Iterator, Sequence
from functools import partial
from math import inf
from typing import Final

from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.server.ports import Notify

MOST_S: Final = 30.0
_AGAIN_S: Final = 1.0
"""Wall time after which a PING is sent again, with the same number: nobody may have listened yet."""

_LONGEST_TURN_S: Final = 0.04
_NUMBERS: Final = 1 << 32

Place = tuple[int, str]
"""The index of an endpoint, and one of its links."""


class Lockstep:
    """Says when vehicle time stands still. Wall time is an argument.

    Attributes:
        begun: Whether anybody has ever answered.
    """

    def __init__(self, endpoints: Sequence[Endpoint], notify: Notify) -> None:
        """Begin with the turn before the first step."""
        self._endpoints, self._notify = tuple(endpoints), notify
        self._longest = max(round(_LONGEST_TURN_S / self._endpoints[0].vehicle.config.step_s), 1)
        self._steps = self._number = 0
        self._since_s: float | None = None
        self._asked_s: dict[Place, float] = {}
        self._answered: set[Place] = set()
        self._clients: set[Place] = set()
        self.begun = False
        for index, endpoint in enumerate(self._endpoints):
            endpoint.on_message = partial(self._hear, index)

    def made(self) -> bool:
        """Note a step; return whether the turn is over with it."""
        self._steps += 1
        if self._steps < self._longest and not any(
            self._endpoints[index].tells_position(link) for index, link in self._places()
        ):
            return False
        self._steps = 0
        self._number = (self._number + 1) % _NUMBERS
        self._since_s = None
        self._asked_s.clear()
        self._answered.clear()
        return True

    def waits(self, now_s: float) -> bool:
        """Ask whoever has not been asked in this turn, and return whether anybody is waited for."""
        if self._steps:
            return False
        if self._since_s is None:
            self._since_s = now_s
        places = set(self._places())
        self._clients &= places
        for place in places - self._answered:
            if now_s - self._asked_s.get(place, -inf) >= _AGAIN_S:
                self._asked_s[place] = now_s
                index, link = place
                self._endpoints[index].ping(link, self._number)
        late = self._clients - self._answered
        if late and now_s - self._since_s >= MOST_S:
            self._clients -= late
            for _, link in sorted(late):
                self._notify(f"no answer for {MOST_S:g} s by {link}: vehicle time goes on without")
            late.clear()
        return bool(late) or not self.begun

    def _places(self) -> Iterator[Place]:
        return ((index, link) for index, endpoint in enumerate(self._endpoints) for link in endpoint.flight_links)

    def _hear(self, index: int, link: str, message: Message) -> None:
        if message.get_msgId() != mavlink.MAVLINK_MSG_ID_PING or message.target_system == 0:
            return
        place = (index, link)
        if place in self._asked_s and message.seq == self._number:
            self._answered.add(place)
            self._clients.add(place)
            self.begun = True
