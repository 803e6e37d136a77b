"""From the best runs to a smooth path with a proof: in the corridor of the shortest path, or by the paper's fields."""

from dataclasses import dataclass, replace
from functools import cached_property, partial

from mission.errors import MissionError, NoPlanError, NoRollingStartError, SearchSizeError
from mission.geometry.arrays import BoolArray
from mission.logic.automata.automaton import compile_to_alphabet
from mission.logic.automata.safety import safety_of
from mission.plan.beginning import Beginning
from mission.plan.best_runs import BestRuns
from mission.plan.corridor_back import way_back_in_corridor
from mission.plan.corridor_path import CorridorPlanner
from mission.plan.covering import CoveredVisit
from mission.plan.detour import MOST_SEARCHES, Avoided, flown_run
from mission.plan.flight_plan import prover_of
from mission.plan.homeward import Homeward
from mission.plan.kept import Kept
from mission.plan.passed import run_along
from mission.plan.passing_stops import with_passing_stops
from mission.plan.progress import NoStagesError
from mission.plan.proved_path import PathPlanner, tube_advice
from mission.plan.proved_run import PassedOver, ProvedRun, proved_run
from mission.plan.shortest_way import RunSearch
from mission.plan.way_back import way_back
from mission.planning.run import Run
from mission.spec.model import CORRIDOR
from mission.spec.specification import Specification
from mission.steering.certificate import Certificate
from mission.steering.joined import JoinedCurve
from mission.steering.known_laws import KnownLaw
from mission.steering.layered_paths import NoWayError
from mission.steering.path import SteeringPath
from mission.steering.polyline import Polyline
from mission.steering.proved_smoothing import ProvedCurve
from mission.steering.prover import Prover


@dataclass(frozen=True, eq=False)
class Steered:
    """A run with its smooth path and its proof; the attributes are those of ``FlightPlan`` of the same names.

    Attributes:
        curve: The smoothed path, each leg once, the way back from laps among them.
        lap: Which leg is the lap; None where there is none.
        searched: The run of the search through whose corridor, or by whose fields, it leads.
        avoided: The triangles that were closed because no run through them is proved.
        known: Laws of pieces of the curve that are known.
    """

    run: Run
    searched: Run
    run_index: int
    among: BestRuns
    path: SteeringPath | Polyline
    curve: JoinedCurve
    lap: int | None
    certificate: Certificate
    homeward: Homeward | None
    stops: tuple[tuple[float, float], ...]
    covers: tuple[CoveredVisit, ...]
    passed_over: tuple[PassedOver, ...] = ()
    avoided: tuple[Avoided, ...] = ()
    instead: str = ""
    known: tuple[KnownLaw, ...] = ()

    @property
    def proofs(self) -> tuple[Certificate, ...]:
        """Of the whole curve, one after the other."""
        return (self.certificate, *((self.homeward.certificate,) if self.homeward else ()))


@dataclass(frozen=True, eq=False)
class Steering:
    """What the steering of one mission starts from.

    Attributes:
        planner: Of the mission, by fields.
        restricted: Shape (M,), triangles that must not be entered.
        specification: What the flight satisfies.
        search: Searches runs.
        found: The best ones.
        index: Which of them was asked for.
        free: Whether another one will do.
        kept: What is flown as it was in a plan before.
    """

    planner: PathPlanner
    restricted: BoolArray
    specification: Specification
    search: RunSearch
    found: BestRuns
    index: int
    free: bool
    kept: Kept

    def steered(self, begins: Beginning) -> Steered:
        """A run with its smooth path and its proof, as the mission asks for it.

        Where no curve in a corridor is proved, or the words of the mission count triangles, the path of the fields is
        flown instead, which begins at rest.

        Args:
            begins: Where the flight begins, and with which motion.

        Raises:
            NoRollingStartError: Nothing is proved that begins with this motion.
            NoPlanError: Nothing is proved.
        """
        instead = ""
        if begins.moves and self.planner.spec.smoothing != CORRIDOR:
            raise NoRollingStartError("the path of the fields begins at rest")
        if self.planner.spec.smoothing == CORRIDOR:
            try:
                return self._in_corridor(self.found, self.index, begins)
            except (NoStagesError, NoWayError, NoPlanError) as error:
                instead, roomier = str(error), self._roomier(error, begins)
            if roomier is not None:
                return roomier
            if begins.moves:
                raise NoRollingStartError(instead)
            if begins.stays:
                raise NoPlanError(instead)
        try:
            return self._by_fields(instead, begins)
        except NoPlanError as error:
            if instead in {"", str(error)}:
                raise
            raise NoPlanError(
                f"no curve in a corridor is proved: {instead}; and of fields in triangles instead, {error}",
                cause=error.cause,
                conjuncts=error.conjuncts,
                restricted=error.restricted,
                regions=error.regions,
            ) from error

    @cached_property
    def _corridors(self) -> CorridorPlanner:
        """In those of the best runs: what is found for one beginning is there for another."""
        return self._corridors_of(self.found)

    def _corridors_of(self, found: BestRuns) -> CorridorPlanner:
        of, automaton = self.planner, found.product.automaton
        return CorridorPlanner(of.spec, of.partition, of.labelling, self.restricted, automaton, of.covering, self.kept)

    @cached_property
    def _prover(self) -> Prover:
        of = self.planner
        refutation = compile_to_alphabet(self.specification.refutation, of.labelling.letters)
        return prover_of(of.spec, of.partition, of.labelling, refutation, self.restricted)

    def _in_corridor(self, found: BestRuns, index: int, begins: Beginning) -> Steered:
        of, automaton = self.planner, found.product.automaton
        planner = self._corridors if found is self.found else self._corridors_of(found)
        run, locator = found.runs[index], self.search.maps.locator
        flown = planner.path(run, begins, partial(self._prover.certify, repeats=run.recurrent))
        path, curve, homeward = flown.planned, flown.curve, None
        if flown.lap is not None:
            # In T: the lap may begin elsewhere than the one that was searched.
            onward = partial(self.search.homeward, replace(found, way=None))
            back = way_back_in_corridor(planner, onward, safety_of(automaton.whole), run, flown)
            if back is not None:
                homeward = Homeward(run_along([back.curve], locator), back.homeward.certificate)
                path, curve = path.then(back.planned), JoinedCurve((*curve.legs, back.curve))
        proofs = (flown.certificate, *((homeward.certificate,) if homeward else ()))
        return Steered(
            run=run_along(flown.curve.legs, locator, lap=flown.lap is not None),
            searched=run,
            run_index=index,
            among=found,
            path=path,
            curve=curve,
            lap=flown.lap,
            certificate=flown.certificate,
            homeward=homeward,
            stops=with_passing_stops(flown.stops, curve, proofs, (of.partition, of.labelling), of.spec.regions),
            covers=flown.covers,
            known=flown.known,
        )

    def _roomier(self, refused: MissionError, begins: Beginning) -> Steered | None:
        """A path in the corridor of a run that keeps out of where the tube does not fit; None where none is found.

        Raises:
            NoPlanError: There is no such run. As the tube touches something else at all times, words are possible in
                which nothing of these is read, and the mission accepts none of them: no other path is proved either.
        """
        here = int(self.planner.labelling.letter_of[self.search.maps.triangle])
        error, unfit = refused, frozenset[int]()
        while self.free and isinstance(error, NoStagesError) and not error.unfit <= unfit | {here}:
            unfit |= error.unfit - {here}
            try:
                found = self.search.best(self.specification, unfit=unfit)
            except SearchSizeError:
                return None
            except NoPlanError as none:
                if here in error.unfit:
                    return None
                raise NoPlanError(f"{refused}; {tube_advice(self.planner.spec)}") from none
            try:
                steered = self._in_corridor(found, 0, begins)
            except (NoStagesError, NoWayError, NoPlanError) as again:
                error = again
                continue
            avoided = (Avoided(triangle, str(refused)) for triangle in self.search.of_letters(unfit))
            return replace(steered, passed_over=(PassedOver(self.index, str(refused)),), avoided=tuple(avoided))
        return None

    def _by_fields(self, instead: str, begins: Beginning) -> Steered:
        planner, prover = self.planner, self._prover

        def smoothed(tried: Run, path: SteeringPath, doubtful: bool) -> ProvedCurve:  # noqa: FBT001 - as proved_run has it
            certify = partial(prover.certify, repeats=tried.recurrent)
            return planner.smoothed(path, certify, joins=tried.recurrent, doubtful=doubtful)

        def proved_of(best: BestRuns) -> ProvedRun:
            steered = partial(planner.path, automaton=best.product.automaton.whole, start_m=begins.place_m)
            if best is self.found:
                return proved_run(best.runs, self.index, steered, smoothed, others=self.free)
            return proved_run(best.runs, 0, steered, smoothed, others=False, doubtful=True)

        flown = flown_run(
            self.found,
            proved_of,
            partial(self.search.best, self.specification),
            start=self.search.maps.triangle,
            most_searches=MOST_SEARCHES if self.free else 0,
        )
        chosen, path, proved = flown.proved.run, flown.proved.path, flown.proved.proved
        curve, homeward = proved.curve, None
        if chosen.recurrent:
            safety = safety_of(flown.among.product.automaton.whole)
            onward = partial(self.search.homeward, flown.among, lap_triangle=chosen.suffix[0])
            back = way_back(planner, onward, safety, self.restricted, laps=chosen, proved=proved)
            if back is not None:
                homeward, path = back.homeward, path.then(back.path)
                curve = JoinedCurve((*curve.legs, *back.curve.legs))
        proofs = (proved.certificate, *((homeward.certificate,) if homeward else ()))
        ground = planner.partition, planner.labelling
        stops = tuple((stop.s, stop.seconds) for stop in planner.stops(path, curve))
        return Steered(
            run=chosen,
            searched=chosen,
            run_index=flown.proved.index,
            among=flown.among,
            path=path,
            curve=curve,
            lap=path.repeated_leg,
            certificate=proved.certificate,
            homeward=homeward,
            stops=with_passing_stops(stops, curve, proofs, ground, planner.spec.regions),
            covers=planner.covering.visits(path) if planner.covering else (),
            passed_over=flown.passed_over,
            avoided=flown.avoided,
            instead=instead,
        )
