"""Flights in lock-step whose program is killed at a moment, and that are taken up again from what was written."""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import groupby

from shapely import Point

from mission.fly import FlightOptions, FlightResult, StopRequest, fly
from mission.fly.amending import Amendments
from mission.fly.replanner import SynchronousReplanner
from mission.fly.resuming import Unfinished, unfinished
from mission.plan import FlightPlan, plan_from_json
from mission.report.reading import LaterPlan, Record, parse_record
from mission.report.record import FlightRecord
from tests.support.fault_grid import Bench, Fault, FullDisk, KilledError
from tests.support.lockstep import LINK
from vehicle_sim.faults import NO_FAULTS
from vehicle_sim.parameters import Flavour


class Killed:
    """A flight whose program is killed (as by kill -9) at a time of the vehicle's clock."""

    def __init__(
        self,
        plan: FlightPlan,
        flavour: Flavour,
        at_s: float,
        options: FlightOptions | None = None,
        parameters: Mapping[str, float] | None = None,
        *,
        ends_laps_at_s: float = math.inf,
    ) -> None:
        self.plan = plan
        self.bench = Bench(Fault.KILLED, at_s, flavour, NO_FAULTS, wind=False)
        for name, value in (parameters or {}).items():
            self.bench.vehicle.parameters.set(name, value)
        self.plans: dict[int, FlightPlan] = {}
        self.options, self._ends_laps_at_s = options, ends_laps_at_s
        self.result: FlightResult | None = None
        with suppress(KilledError):
            self.result = self._fly(FlightRecord(self.bench.sink, mission="killed"))

    def leave(self, for_s: float) -> None:
        """Let time pass without anybody."""
        vehicle = self.bench.vehicle
        until_s = vehicle.time_s + for_s
        while vehicle.time_s < until_s:
            self.bench.endpoint.advance()
            self.bench.endpoint.outgoing(LINK)

    @property
    def record(self) -> Record:
        """What was written, with the plans beside it."""
        record = parse_record(self._whole)
        later = tuple(
            LaterPlan(at_s, self.plans[number], laps, begun) for at_s, number, laps, begun in record.takeovers
        )
        return replace(record, later=later)

    @property
    def _whole(self) -> bytes:
        data = self.bench.sink.getvalue()
        return data[: data.rfind(b"\n") + 1]

    def resume(self, killed_at_s: float = math.inf, amendments: Amendments | None = None) -> FlightResult:
        """Go on from the record, up to another kill."""
        bench, left = self.bench, unfinished(self.plan, self.record)
        written = self._whole
        bench.sink, bench.dead, bench.happened, bench.at_s = FullDisk(), False, False, killed_at_s
        bench.sink.write(written)
        record = FlightRecord(bench.sink, mission="killed", begins=False)
        return self._fly(record, left, amendments)

    def _fly(
        self, record: FlightRecord, left: Unfinished | None = None, amendments: Amendments | None = None
    ) -> FlightResult:
        return fly(
            self.plan,
            self.bench,
            self.bench,
            record,
            options=self.options,
            unfinished=left,
            on_plan=self._keep,
            amendments=amendments,
            replanner=SynchronousReplanner(self.bench.now_s),
            stop_request=self._wish,
        )

    def _wish(self) -> StopRequest | None:
        """The user's, once: to return after the lap."""
        if self.bench.now_s() < self._ends_laps_at_s:
            return None
        self._ends_laps_at_s = math.inf
        return StopRequest("enough", after_lap=True)

    def _keep(self, number: int, text: str) -> None:
        self.plans[number] = plan_from_json(text)

    def entered(self) -> list[str]:
        """The names of regions that were entered, in order, from the positions that were reported alone."""
        shapes = {region.name: self.plan.area_of(region.name) for region in self.plan.spec.regions}
        track = self.record.track
        inside = [
            next((name for name, shape in shapes.items() if shape.covers(Point(*place[:2]))), "")
            for place in track.position_m
        ]
        return [name for name, _ in groupby(inside) if name]
