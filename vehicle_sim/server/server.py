"""Vehicles in real time: sockets polled between small batches of steps, paced on absolute deadlines.

Step k is due at start + k * step / speed. Where the machine cannot keep that up, the start is moved: vehicle time
slows instead of jumping, and whoever runs the program is told so once. With patience, it also slows for a client that
the machine has kept from its turn; in lock-step, it stands still until each client has had its turn.
"""

import select
from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

from vehicle_sim.autopilot import Mode
from vehicle_sim.clock import Clock
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.server.lockstep import Lockstep
from vehicle_sim.server.patience import Patience, Source, StreamKind
from vehicle_sim.server.ports import Notify, Port

_BATCH_S: Final = 0.02
"""Vehicle time between two looks at the sockets, at most: a client's reaction is never later than that."""

_LONGEST_WAIT_S: Final = 0.1
_MOST_LAG_S: Final = 0.1
_JUDGED_AFTER_S: Final = 2.0
_TOLERATED_SLOWDOWN: Final = 0.05
_AWAITED: Final = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: StreamKind.HEARTBEAT,
    mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: StreamKind.SETPOINT,
    mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: StreamKind.SETPOINT,
}


class Pacer:
    """Says how many steps are due, and slows vehicle time where they cannot be made.

    Attributes:
        slowed_to: The speed that the machine really reaches, None while it keeps up.
    """

    def __init__(self, *, step_s: float, speed: float, now_s: float) -> None:
        """Start now.

        Raises:
            ValueError: The speed is not positive.
        """
        if not speed > 0.0:
            raise ValueError("the speed is a positive multiple of real time")
        self._interval_s = step_s / speed
        self._most_lag_s = _MOST_LAG_S + self._interval_s  # a step that is not due yet is no lag
        self._speed = speed
        self._begun_s = now_s
        self._start_s = now_s
        self._made = 0
        self.slowed_to: float | None = None

    def due(self, now_s: float) -> int:
        """Return how many steps are due now."""
        lag_s = now_s - self._start_s - self._made * self._interval_s
        if lag_s > self._most_lag_s:
            self._start_s += lag_s - self._most_lag_s
            lag_s = self._most_lag_s
            self._judge(now_s)
        return max(int(lag_s / self._interval_s), 0)

    def stand_still(self, now_s: float) -> None:
        """Let no step be due now: time that was waited on purpose is not made up for."""
        lag_s = now_s - self._start_s - self._made * self._interval_s
        if lag_s > 0.0:
            self._start_s += lag_s
            self._judge(now_s)

    def _judge(self, now_s: float) -> None:
        elapsed_s = now_s - self._begun_s
        lost = (self._start_s - self._begun_s) / elapsed_s
        if elapsed_s >= _JUDGED_AFTER_S and lost > _TOLERATED_SLOWDOWN:
            self.slowed_to = self._speed * (1.0 - lost)

    def made(self, steps: int) -> None:
        """Note that so many steps were made."""
        self._made += steps

    def wait_s(self, now_s: float) -> float:
        """Return how long nothing is due."""
        due_s = self._start_s + (self._made + 1) * self._interval_s
        return min(max(due_s - now_s, 0.0), _LONGEST_WAIT_S)


class Server:
    """Runs endpoints over their ports until told to stop; all of them step together."""

    def __init__(
        self,
        endpoints: Sequence[Endpoint],
        ports: Sequence[Port],
        *,
        clock: Clock,
        notify: Notify,
        patience: Sequence[Patience] = (),
        lockstep: Lockstep | None = None,
    ) -> None:
        """Serve.

        Args:
            endpoints: The vehicles, all of one step length.
            ports: Who opened them closes them.
            clock: Real time.
            notify: Takes sentences for whoever runs the program.
            patience: One for each vehicle: decides when vehicle time waits, above real time only. It never does
                without.
            lockstep: Decides whether vehicle time stands still, at any speed, where clients are to have their turn.

        Raises:
            ValueError: There is no vehicle, not one patience for each, or patience and lock-step together.
        """
        if not endpoints or (patience and len(patience) != len(endpoints)):
            raise ValueError("serve at least one vehicle, with one patience for each or none at all")
        if patience and lockstep is not None:
            raise ValueError("in lock-step nobody is late: there is nothing to be patient about")
        self._endpoints, self._ports = tuple(endpoints), tuple(ports)
        self._clock, self._notify = clock, notify
        self._lockstep = lockstep
        self._patient = list(zip(endpoints, patience, strict=True)) if patience else []
        for endpoint, patient in self._patient:
            endpoint.on_message = partial(_hear, endpoint, patient)

    def run(self, speed: float, stopping: Callable[[], bool]) -> None:
        """Let vehicle time pass at `speed` times real time until `stopping` returns true."""
        step_s = self._endpoints[0].vehicle.config.step_s
        batch = max(round(_BATCH_S / step_s), 1)
        began_s = self._clock.now_s()
        pacer = Pacer(step_s=step_s, speed=speed, now_s=began_s)
        told = False
        while not stopping():
            now_s = self._clock.now_s()
            if self._lockstep is not None and not self._lockstep.begun:
                began_s, pacer = now_s, Pacer(step_s=step_s, speed=speed, now_s=now_s)  # nobody is there yet
            late = speed > 1.0 and self._wait_for_clients(now_s)
            if late:
                pacer.stand_still(now_s)
            waits = late or (self._lockstep is not None and self._lockstep.waits(now_s))
            pacer.made(self._advance(0 if waits else min(pacer.due(now_s), batch), now_s))
            self._flush()
            if pacer.slowed_to is not None and not told:
                told = True
                waited = max((patient.waited_s for _, patient in self._patient), default=0.0) / (now_s - began_s)
                self._notify(
                    f"this machine cannot keep up {speed:g} times real time: "
                    f"vehicle time runs at about {pacer.slowed_to:.3g} times"
                    + (f", {waited:.0%} of the time waiting for clients" if waited else "")
                )
            self._poll(_LONGEST_WAIT_S if waits else pacer.wait_s(self._clock.now_s()))

    def _advance(self, steps: int, now_s: float) -> int:
        """Make so many steps, or those that are left of the turn; return how many."""
        for made in range(1, steps + 1):
            for endpoint in self._endpoints:
                endpoint.advance()
            if self._lockstep is not None and self._lockstep.made():
                self._lockstep.waits(now_s)  # which asks at once
                return made
        return steps

    def _wait_for_clients(self, now_s: float) -> bool:
        """Whether any vehicle waits; each is asked, for each counts how long."""
        waiting = [
            patient.waits(endpoint.vehicle.time_s, now_s, by_setpoints=endpoint.vehicle.autopilot.mode is Mode.GUIDED)
            for endpoint, patient in self._patient
        ]
        return any(waiting)

    def _flush(self) -> None:
        for port in self._ports:
            port.flush()

    def _poll(self, wait_s: float) -> None:
        """Wait for the next step or the next message, whichever is first, and answer what has come."""
        owners = {source: port for port in self._ports for source in port.sockets()}
        ready, _, _ = select.select(list(owners), [], [], wait_s)
        for source in ready:
            owners[source].read(source)
        if ready:
            self._flush()


def _hear(endpoint: Endpoint, patience: Patience, link: str, message: Message) -> None:
    kind = _AWAITED.get(message.get_msgId())
    if kind is not None:
        source = Source(link, message.get_srcSystem(), message.get_srcComponent(), kind)
        patience.hear(source, endpoint.vehicle.time_s)
