"""The word that was flown, letter by letter, and what each brought to the automaton of the mission, in plain words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mission.monitor.verdict import Progress, Verdict
from mission.plan import FlightPlan
from mission.report.reading import Record
from mission.report.replay import replay

Letter = tuple[str, ...] | None


@dataclass(frozen=True)
class Passage:
    """A stretch with equal labels, and what was known when it began.

    Attributes:
        t_s: When, on the vehicle's clock.
        regions: Where, by name; empty in the open, None outside of the domain.
        progress: How far the automata had come, with this letter.
        verdict: On every continuation.
    """

    t_s: float
    regions: Letter
    progress: Progress
    verdict: Verdict

    def values(self) -> dict[str, Any]:
        """The same as values for JSON."""
        return {
            "t_s": self.t_s,
            "regions": None if self.regions is None else list(self.regions),
            "done": self.progress.done,
            "total": self.progress.total,
            "awaited": list(self.progress.awaited),
            "so_far": self.verdict.value,
        }


def passages(plan: FlightPlan, record: Record) -> list[Passage]:
    """The stretches of a flight, found again by the monitors that watched it."""
    found: list[Passage] = []
    last: tuple[int, Letter] | None = None
    for t_s, judged in replay(plan, record):
        monitor = judged.monitor
        place = monitor.whereabouts
        if place is None and not monitor.violations:
            continue
        regions = None if place is None else tuple(sorted(plan.labelling.label(place.triangle)))
        if (now := (id(monitor), regions)) != last:
            last = now
            found.append(Passage(t_s, regions, monitor.progress, monitor.verdict))
    return found


def told(found: Sequence[Passage]) -> list[str]:
    """What each stretch brought, in a few words; empty where that is nothing."""
    words = []
    before: Passage | None = None
    for passage in found:
        words.append(_brought(passage, before))
        before = passage
    return words


def _brought(passage: Passage, before: Passage | None) -> str:
    now = passage.progress
    if passage.verdict is not Verdict.OPEN and (before is None or before.verdict is not passage.verdict):
        if passage.verdict is Verdict.TRUE:
            return "from here on nothing can undo it: whatever follows satisfies the mission"
        return "from here on the mission can no longer be satisfied"
    if passage.verdict is not Verdict.OPEN:
        return ""
    done = now.done - (before.progress.done if before else 0)
    awaits = f"waits for {' or '.join(now.awaited)}" if now.awaited else "waits for nothing more"
    if done > 0:
        return f"step {now.done} of {now.total}; {awaits}"
    if done < 0:
        return f"back to {now.done} of {now.total} steps; {awaits}"
    return awaits if before is None or before.progress.awaited != now.awaited else ""


def in_short(found: Sequence[Passage]) -> str:
    """The regions that were passed, in their order, as one sentence; empty where none was."""
    stops = [(passage, ", ".join(passage.regions)) for passage in found if passage.regions]
    named = [
        f"{name} ({passage.t_s:.0f} s)" for k, (passage, name) in enumerate(stops) if not k or stops[k - 1][1] != name
    ]
    return f"The vehicle was in {', then in '.join(named)}." if named else ""
