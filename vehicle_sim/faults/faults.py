"""The faults of one vehicle: parameters, schedule and commands, composed to what is wrong now."""

from vehicle_sim.faults.conditions import Conditions, conditions_of
from vehicle_sim.faults.injection import FailureType, FailureUnit, InjectedFailures
from vehicle_sim.faults.schedule import KINDS, NO_FAULTS, Schedule, ScheduledFault, Since
from vehicle_sim.parameters import ParameterStore


class Faults:
    """What is wrong with one vehicle and its world; `conditions` is the present state of it.

    Parameters say what is wrong from now on, scheduled faults come on top of it, and injected failures have the last
    word.
    """

    def __init__(self, parameters: ParameterStore, schedule: Schedule = NO_FAULTS) -> None:
        """Begin at vehicle time 0 with what the parameters say."""
        self._parameters = parameters
        self._revision = parameters.revision
        self._of_parameters = conditions_of(parameters)
        self._scheduled = tuple(fault for fault in schedule.faults if KINDS[fault.kind].apply is not None)
        self._of_links = tuple(fault for fault in schedule.faults if KINDS[fault.kind].apply is None)
        self._began_s: dict[Since, float] = {Since.BOOT: 0.0}
        self._injected = InjectedFailures()
        self._stale = False
        self.conditions: Conditions = self._of_parameters

    @property
    def link_faults(self) -> tuple[ScheduledFault, ...]:
        """The faults of links; they act on packets."""
        return self._of_links

    def strength(self, fault: ScheduledFault, now_s: float) -> float:
        """Return how strongly a scheduled fault acts now, 0 while its event has not happened."""
        began_s = self._began_s.get(fault.since)
        return 0.0 if began_s is None else fault.strength(now_s - began_s - fault.at_s)

    def inject(self, unit: FailureUnit, how: FailureType, instance: int) -> bool:
        """Set or take back a failure by command, and return whether there is such a failure."""
        self._stale = True
        return self._injected.inject(unit, how, instance)

    def reboot(self) -> None:
        """Count from time 0 again; failures that were set by command are forgotten."""
        self._began_s = {Since.BOOT: 0.0}
        self._injected = InjectedFailures()
        self._stale = True

    def advance(self, now_s: float, *, armed: bool, flying: bool) -> bool:
        """Bring `conditions` up to date and return whether they have changed."""
        if armed:
            self._began_s.setdefault(Since.ARMING, now_s)
        if flying:
            self._began_s.setdefault(Since.TAKEOFF, now_s)
        changed = self._revision != self._parameters.revision
        if changed:
            self._revision = self._parameters.revision
            self._of_parameters = conditions_of(self._parameters)
        if not (changed or self._stale or self._scheduled):
            return False
        self._stale = False
        now = self._of_parameters
        for fault in self._scheduled:
            share, apply = self.strength(fault, now_s), KINDS[fault.kind].apply
            if share > 0.0 and apply is not None:
                now = apply(now, fault.values, share)
        now = self._injected.apply(now)
        if now == self.conditions:
            return False
        self.conditions = now
        return True
