"""The check in a flight: what is read while the vehicle makes ready, and judged once, before it is armed."""

from collections.abc import Callable, Collection
from dataclasses import dataclass

from mission.fly.preflight.known import asked_of, told_of
from mission.fly.preflight.table import PARAMETERS, Findings, NoGoError, judged
from mission.fly.recording import RecordWriter
from mission.link.contact import Contact
from mission.link.identity import LinkOptions
from mission.plan import FlightPlan


@dataclass(frozen=True)
class Checks:
    """How a flight is checked before.

    Attributes:
        forced: Names of rows whose no-go does not count.
        on_findings: Called with the table, before anything follows from it.
    """

    forced: Collection[str] = ()
    on_findings: Callable[[Findings], None] | None = None


class Gate:
    """Lets a flight begin or not.

    Attributes:
        findings: The table; None before it is judged.
    """

    def __init__(self, contact: Contact, checks: Checks) -> None:
        """Begin to read."""
        self.findings: Findings | None = None
        self._contact, self._checks = contact, checks
        contact.parameters.wanted = PARAMETERS

    @property
    def open(self) -> bool:
        """Whether all that can be known is known, so that ``judge`` may be called."""
        return self._contact.parameters.complete

    def judge(self, plan: FlightPlan, link: LinkOptions, record: RecordWriter, *, fenced: bool) -> None:
        """Judge the vehicle, and write it down; ``fenced`` where the flight sets a geofence of its own.

        Raises:
            NoGoError: It is not to be armed.
        """
        findings = judged(asked_of(plan, link, fenced=fenced), told_of(self._contact, plan), self._checks.forced)
        self.findings = findings
        record.write("event", self._contact.vehicle.clock.newest_s, name="preflight", **findings.values())
        if self._checks.on_findings is not None:
            self._checks.on_findings(findings)
        if not findings.go:
            raise NoGoError(findings)

    @property
    def forced_text(self) -> str:
        """What it flies against, in plain words; empty where there is nothing."""
        return "" if self.findings is None else self.findings.forced_text
