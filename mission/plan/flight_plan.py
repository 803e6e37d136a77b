"""The plan of a flight: everything that was decided, and the proof; what flying, drawing and checking start from."""

from dataclasses import dataclass
from functools import cached_property

from mission.geometry.arrays import BoolArray, IntArray
from mission.geometry.location import Locator
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.automaton import BuchiAutomaton, CompiledAutomaton, compile_to_alphabet
from mission.logic.formula import Formula
from mission.logic.safety import safety_of
from mission.plan.cautions import cautions
from mission.plan.homeward import Homeward, ends_of_flight
from mission.plan.tasks import DroppedTask
from mission.planning.run import Run
from mission.planning.transition_system import TransitionSystem
from mission.spec.domain import restricted_triangles
from mission.spec.model import MissionSpec, Point
from mission.steering.certificate import Certificate, Prover
from mission.steering.joined import JoinedCurve
from mission.steering.path import SteeringPath
from mission.steering.trajectory import Trajectory

_NO_WAY_BACK = (
    "the flight ends where its laps do: no way back to where it may end is proved to violate nothing; "
    "a region of kind `home` that can be reached would be one"
)


@dataclass(frozen=True, eq=False)
class FlightPlan:
    """One planned flight.

    Attributes:
        spec: The mission.
        start_m: Where the flight begins, ENU in the domain.
        partition: The domain's triangles.
        labelling: Their labels.
        formula: What the flight satisfies: the mission's formula and its tasks, but for those that were dropped.
        automaton: A Büchi automaton of the formula.
        refutation: One of its negation.
        product_states: Number of states of the product, reachable or not.
        product_states_reachable: How many of them can be reached from the start.
        shortest_runs: How many runs have the least cost.
        run_index: Which of them is flown.
        run: That run.
        path: The path that steers through it; of a recurrent run, the way to the lap, the lap, and the way back.
        stops: Pairs (curve parameter, seconds) at which the vehicle loiters.
        trajectory: The smoothed path with its time law.
        certificate: The proof that every flight within the tube satisfies the formula; of a recurrent run, that it does
            if the lap is repeated for ever.
        dropped: The soft tasks that could not be met, in the order of the file.
        homeward: The way back of a recurrent run; None where there is none on which nothing is violated.
    """

    spec: MissionSpec
    start_m: Point
    partition: Partition
    labelling: Labelling
    formula: Formula
    automaton: BuchiAutomaton
    refutation: BuchiAutomaton
    product_states: int
    product_states_reachable: int
    shortest_runs: int
    run_index: int
    run: Run
    path: SteeringPath
    stops: tuple[tuple[float, float], ...]
    trajectory: Trajectory
    certificate: Certificate
    dropped: tuple[DroppedTask, ...] = ()
    homeward: Homeward | None = None

    @property
    def specification(self) -> str:
        """The formula as text: as it was written, where the mission has no tasks."""
        return str(self.formula) if self.spec.tasks else self.spec.formula

    @property
    def curve(self) -> JoinedCurve:
        """The smoothed path, each leg once."""
        return self.trajectory.curve

    @property
    def certified(self) -> JoinedCurve:
        """What the certificate is about: the path, but for the way back from the laps."""
        lap = self.trajectory.lap
        return self.curve if lap is None else JoinedCurve(self.curve.legs[: lap + 1])

    @property
    def system(self) -> TransitionSystem:
        """T of this domain, its restricted triangles closed."""
        return TransitionSystem.from_partition(self.partition, self.labelling, self.restricted)

    @property
    def successors(self) -> IntArray:
        """The transition map of T, shape (M, 4)."""
        return self.system.successors

    @cached_property
    def restricted(self) -> BoolArray:
        """Triangles that must never be entered, shape (M,)."""
        return restricted_triangles(self.spec, self.labelling)

    @cached_property
    def locator(self) -> Locator:
        """Point location in the domain."""
        return Locator(self.partition)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the writer of the mission may not have meant, in words; empty where nothing is odd."""
        start = int(self.labelling.letter_of[self.run.states[0]])
        return (
            *cautions(self.formula, self.labelling.letters, start, self.spec.semantics),
            *((_NO_WAY_BACK,) if self.run.recurrent and not self._returns else ()),
        )

    @property
    def _returns(self) -> bool:
        ends = ends_of_flight(self.spec, self.labelling, self.restricted, self.run.states[0])
        return self.homeward is not None and bool(ends[self.homeward.run.suffix[0]])

    @cached_property
    def compiled(self) -> CompiledAutomaton:
        """The automaton over the letters of the domain."""
        return compile_to_alphabet(self.automaton, self.labelling.letters)

    @cached_property
    def compiled_refutation(self) -> CompiledAutomaton:
        """The automaton of the negation over the letters of the domain."""
        return compile_to_alphabet(self.refutation, self.labelling.letters)


def tube_of(spec: MissionSpec) -> float:
    """Half width of the tube on each axis, w tau^2: the bound of the tracking error of Eq. 12 under a disturbance w."""
    return spec.flight.disturbance_m_s2 * spec.flight.time_constant_s**2


def prover_of(
    spec: MissionSpec,
    partition: Partition,
    labelling: Labelling,
    refutation: CompiledAutomaton,
    restricted: BoolArray,
) -> Prover:
    """The prover of a mission with its tube."""
    return Prover(
        partition,
        labelling,
        refutation=refutation,
        semantics=spec.semantics,
        restricted=restricted,
        tube_m=tube_of(spec),
    )


def certify_again(plan: FlightPlan) -> Certificate:
    """Prove a plan's trajectory anew, from the trajectory, the domain and the formula alone."""
    prover = prover_of(plan.spec, plan.partition, plan.labelling, plan.compiled_refutation, plan.restricted)
    return prover.certify(plan.certified, repeats=plan.trajectory.lap is not None)


def certify_homeward_again(plan: FlightPlan, certificate: Certificate) -> Certificate | None:
    """Prove the way back from a plan's laps anew; None where there is none.

    Args:
        plan: The plan.
        certificate: Of its laps, as from ``certify_again``.

    Raises:
        AutomatonSizeError: As in ``safety_of``.
    """
    if len(plan.curve.legs) == len(plan.certified.legs):
        return None
    safety = safety_of(plan.compiled, len(plan.labelling.letters))
    prover = prover_of(plan.spec, plan.partition, plan.labelling, safety.refutation(), plan.restricted)
    reached = prover.reached(plan.certified, certificate)
    return prover.certify(JoinedCurve(plan.curve.legs[len(plan.certified.legs) :]), begins=reached)
