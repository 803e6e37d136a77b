"""The monitor of a plan's flight, fed stage by stage: in flight by what is told, afterwards by the record of it."""

from mission.monitor.laps import Laps
from mission.monitor.monitor import Monitor
from mission.monitor.stage import GUARDED, WATCHED, Stage
from mission.plan import FlightPlan
from mission.spec.model import FIELD, Point


class FlightMonitor:
    """Decides what of a flight is judged.

    The word begins when the trajectory does, at its start, and ends on the ground; while the vehicle climbs and settles
    there, it must only not leave the domain or enter a restricted region. What a standing vehicle's position estimate
    does before take-off is not the flight.

    Attributes:
        monitor: The word flown so far.
    """

    def __init__(self, plan: FlightPlan, laps_before: int = 0, *, begun: bool = False) -> None:
        """Watch from the ground, or from where another plan was flown, as ``Monitor`` has it."""
        self.monitor = Monitor(
            plan.locator,
            plan.labelling,
            satisfied_by=plan.required.satisfied_by,
            automata=plan.compiled_parts,
            whole=plan.deterministic,
            refutation=plan.compiled_refutation,
            semantics=plan.spec.semantics,
            restricted=plan.restricted,
            counter=laps_of(plan, laps_before, begun=begun),
            laps=laps_asked(plan, laps_before),
            timed=plan.required.timed,
            moving=plan.moving,
        )
        self._flying = False

    def report(self, stage: Stage | None, t_s: float, position_m: Point) -> None:
        """Take a position into account that was reported in a stage; None before the first."""
        self._flying |= stage is Stage.FLY
        if stage in WATCHED and self._flying:
            self.monitor.observe(t_s, position_m)
        elif stage in GUARDED:
            self.monitor.guard(t_s, position_m)

    def known(self) -> dict[str, object]:
        """What is known now, as values for a record: the verdict on every continuation, and the progress."""
        progress = self.monitor.progress
        return {
            "so_far": self.monitor.verdict,
            "done": progress.done,
            "total": progress.total,
            "awaited": progress.awaited,
        }


def laps_of(plan: FlightPlan, before: int = 0, *, begun: bool = False) -> Laps:
    """What counts the laps of a plan's flight, from the ground or from where another plan was flown."""
    return Laps(
        plan.deterministic,
        plan.labelling,
        suffix=plan.run.suffix if plan.run.recurrent else (),
        any_way=plan.spec.flight.guidance == FIELD,
        before=before,
        begun=begun,
    )


def laps_asked(plan: FlightPlan, before: int = 0) -> int | None:
    """How many laps are to be flown in all; None where nobody has said."""
    return None if plan.trajectory.laps is None else before + plan.trajectory.laps
