"""Flights in lock-step that are replanned, and what is read from their records alone."""

import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

from mission.fly import FlightOptions, Progress, fly
from mission.fly.amending import Amendments
from mission.fly.replanner import Replanner, SynchronousReplanner
from mission.fly.requests import Requests
from mission.monitor.stage import Stage
from mission.plan import FlightPlan, plan_to_json
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from tests.support.faults import schedule_of
from tests.support.lockstep import LockstepVehicle, vehicle_of


class Replanned:
    """One flight, with what was reported of it and what was truly flown."""

    def __init__(
        self,
        plan: FlightPlan,
        flavour: str,
        *faults: str,
        replanner: Callable[[LockstepVehicle], Replanner] | None = None,
        at_step: Callable[["Replanned", float], None] | None = None,
        options: FlightOptions | None = None,
        amendments: Amendments | None = None,
        requests: Requests | None = None,
        drag_per_s: float = 0.3,
        parameters: Mapping[str, float] | None = None,
        wind_m_s: float = 0.0,
        wind_from_deg: float = 0.0,
    ) -> None:
        """Fly; ``at_step`` is called with the seconds since the trajectory began."""
        self.plan, self.flavour = plan, flavour
        self.flying_from_s: float | None = None
        self.told: tuple[str, ...] = ()
        self._at_step = at_step
        config = vehicle_of(flavour, drag_per_s=drag_per_s, wind_m_s=wind_m_s, wind_from_deg=wind_from_deg)
        if faults:
            config = replace(config, faults=schedule_of(*faults))
        self.vehicle = LockstepVehicle(config, at_step=self._step)
        for name, value in (parameters or {}).items():
            self.vehicle.vehicle.parameters.set(name, value)
        self.sink = io.BytesIO()
        self.texts: dict[int, str] = {}
        self.result = fly(
            plan,
            self.vehicle,
            self.vehicle,
            FlightRecord(self.sink, mission="replanned"),
            on_progress=self._look,
            options=options,
            amendments=amendments,
            requests=requests,
            on_plan=self.texts.__setitem__,
            replanner=replanner(self.vehicle) if replanner else SynchronousReplanner(self.vehicle.now_s),
        )

    def written(self, folder: Path, mission_text: str) -> Path:
        """The flight as ``mission fly`` leaves it, without its report."""
        (folder / "mission.yaml").write_text(mission_text)
        (folder / "plan.json").write_text(plan_to_json(self.plan))
        for number, text in self.texts.items():
            (folder / f"plan-{number}.json").write_text(text)
        (folder / "record.jsonl").write_bytes(self.sink.getvalue())
        return folder

    @property
    def lines(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.sink.getvalue().splitlines()]

    @property
    def record(self) -> Any:  # noqa: ANN401 - a Record
        return parse_record(self.sink.getvalue())

    def events(self, name: str) -> list[dict[str, Any]]:
        return [line for line in self.lines if line["kind"] == "event" and line["name"] == name]

    def entered(self) -> list[str]:
        """The regions by name that were entered, in order, from the positions and the shapes of the mission alone."""
        shapes = {region.name: self.plan.area_of(region.name) for region in self.plan.spec.regions}
        return entered(self.record.track.position_m.tolist(), shapes)

    def _look(self, progress: Progress) -> None:
        self.told = progress.told
        if progress.stage is Stage.FLY and self.flying_from_s is None:
            self.flying_from_s = self.vehicle.now_s()

    def _step(self, lockstep: LockstepVehicle) -> None:
        if self._at_step is not None and self.flying_from_s is not None and lockstep.vehicle.steps % 10 == 0:
            self._at_step(self, lockstep.now_s() - self.flying_from_s)


def entered(positions: Sequence[Sequence[float]], shapes: dict[str, Any]) -> list[str]:
    """The names of regions that positions lie in, each time that one is entered."""
    from shapely import Point  # noqa: PLC0415 - of this alone

    inside = [
        next((name for name, shape in shapes.items() if shape.covers(Point(east, north))), "")
        for east, north, _ in positions
    ]
    return [name for name, _ in groupby(inside) if name]
