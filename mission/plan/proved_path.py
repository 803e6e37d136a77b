"""From a run to a path with a proof."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Final

from mission.errors import UnprovedError
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.automata.rabin import Rabin
from mission.plan.covering import Covering
from mission.plan.deep_visits import DeepVisits
from mission.plan.loiter import Stop, loiter_stops, shallow_stop
from mission.plan.visits import covered_visits, earnest_visits, passage_at
from mission.planning.run import Run
from mission.spec.clearances import clearances
from mission.spec.finding import dotted, listed
from mission.spec.model import CORRIDOR, Extension, MissionSpec, Point, Smoothing
from mission.steering.certificate import Certificate
from mission.steering.joined import JoinedCurve
from mission.steering.path import LanesFrom, SteeringPath, build_path
from mission.steering.proved_smoothing import (
    FEWEST_FREQUENCIES,
    MOST_FREQUENCIES,
    ProvedCurve,
    fit_legs,
    smooth_with_proof,
)

FEWEST: Final = Smoothing(Extension.ODD, "auto")
"""How the path of the fields is smoothed where the mission does not say."""


@dataclass(frozen=True, eq=False)
class PathPlanner:
    """Plans the paths of one mission.

    Attributes:
        spec: The mission.
        partition: Its triangles.
        labelling: Their labels.
        covering: Covers the mission's regions; None where a visit is just that.
    """

    spec: MissionSpec
    partition: Partition
    labelling: Labelling
    covering: Covering | None = None

    def path(self, run: Run, automaton: Rabin, start_m: Point) -> SteeringPath:
        """Steer through a run whose word an automaton reads.

        Raises:
            NoPlanError: A region that it visits cannot be covered as the mission asks.
        """
        covers = covered_visits(self.spec, self.partition, self.labelling, automaton, run) if self.covering else {}
        lanes_in: dict[int, Sequence[LanesFrom]] = {
            index: tuple(partial(self.covering.lanes, region, passage) for region in regions)
            for index, regions in covers.items()
            if self.covering
            for passage in (passage_at(self.labelling, automaton, run, self.spec.semantics, index),)
        }
        earnest = earnest_visits(self.spec, self.partition, self.labelling, automaton, run)
        ends = set() if run.recurrent else {len(run.prefix)}  # there the vehicle stays where it settles
        for index in sorted(earnest.keys() - lanes_in.keys() - ends):
            passage = passage_at(self.labelling, automaton, run, self.spec.semantics, index)
            places = [self.deep.deeper(region, passage, run.states[index]) for region in earnest[index]]
            ways = tuple(partial(self.deep.way, deep_m=deep_m) for deep_m in places if deep_m is not None)
            lanes_in |= {index: ways} if ways else {}
        return build_path(
            self.partition,
            run,
            start_m=start_m,
            speed_m_s=self.spec.flight.speed_m_s,
            final_stay_s=self.spec.flight.final_stay_s,
            settle_in=frozenset(earnest),
            lanes_in=lanes_in,
        )

    @cached_property
    def deep(self) -> DeepVisits:
        """The roomiest places of regions."""
        return DeepVisits(self.spec, self.partition, self.labelling)

    def smoothed(
        self,
        path: SteeringPath,
        certify: Callable[[JoinedCurve], Certificate],
        *,
        joins: bool,
        share: float = 1.0,
        doubtful: bool = False,
    ) -> ProvedCurve:
        """Smooth a path and prove it, with as many frequencies as the mission asks for.

        Args:
            path: The path.
            certify: Proves a curve, or says what fails.
            joins: Whether the path has legs that must join each other or another path's; they are continued oddly then,
                whatever the mission asks for, for that keeps their ends.
            share: The part of the number of frequencies that the mission asks for, where it asks for one.
            doubtful: Whether it is likely that there is no proof, so that the most frequencies are tried first.

        Raises:
            UnprovedError: There is no proof.
        """
        legs = path.legs
        smoothing = FEWEST if self.spec.smoothing == CORRIDOR else self.spec.smoothing
        covers = any(len(leg.parts) > 1 for leg in legs)
        joined = joins or covers
        extension = Extension.ODD if joined else smoothing.extension

        def refuses(curve: JoinedCurve) -> str:
            return shallow_stop(self.stops(path, curve), self.spec.flight.tube_m)

        if smoothing.frequencies == "auto":
            try:
                # Beside lanes what fields steer is short, and each proof takes long.
                first = MOST_FREQUENCIES if doubtful else 1 if covers else FEWEST_FREQUENCIES
                return smooth_with_proof(legs, certify, extension=extension, first_frequencies=first, refuses=refuses)
            except UnprovedError as error:
                advised = f"{error}; {tube_advice(self.spec)}"
                raise UnprovedError(advised, counterexample=error.counterexample, where_s=error.where_s) from error
        frequencies = max(1, round(share * smoothing.frequencies))
        curve = fit_legs(legs, frequencies, extension)
        certificate = certify(curve)
        fault = f"the tube of {certificate.tube_m:g} m around it {certificate.reason}" if not certificate.holds else ""
        fault = fault or refuses(curve)
        if fault:
            raise UnprovedError(
                f"the path smoothed with {frequencies} frequencies is not proved to satisfy the mission: "
                f"{fault}; ask for more frequencies, or for `auto`; {tube_advice(self.spec)}",
                counterexample=certificate.counterexample,
                where_s=certificate.where_s,
            )
        return ProvedCurve(curve, certificate)

    def stops(self, path: SteeringPath, curve: JoinedCurve) -> tuple[Stop, ...]:
        """Where a smoothed path stands still."""
        return loiter_stops(path, curve, self.partition, self.labelling, self.spec.regions)


def tube_advice(spec: MissionSpec) -> str:
    """What may help where no curve is proved."""
    tube_m = spec.flight.tube_m
    if tube_m == 0.0:
        return (
            "a path without a tube may cut the corners of the regions that it visits: a `loiter_s` of theirs, or a "
            "`disturbance_m_s2` above 0, makes it go well inside"
        )
    return (
        f"the tube is {tube_m:g} m wide on each side, {_made_of(spec)}: less of either makes it "
        f"narrower{_less_clearance(spec)}"
    )


def _made_of(spec: MissionSpec) -> str:
    """What the tube is, with its keys."""
    disturbed, flight = "`disturbance_m_s2` times the square of `time_constant_s`", spec.flight
    if flight.margins.sum_m == 0.0:
        return disturbed
    margins = f"{flight.margins.sum_m:g} m of them by `flight.tube`"
    return f"{margins} and the rest {disturbed}" if flight.disturbance_m_s2 else margins


def _less_clearance(spec: MissionSpec) -> str:
    """That clearances take room away, where there are any: with their keys."""
    keys = [f"`{dotted(key)}: {metres:g}`" for key, metres in clearances(spec).items()]
    return f"; clearances leave less room, here {listed(keys)}" if keys else ""
