"""The flight loop against a scripted vehicle, with the record that it leaves."""

import io
from typing import TYPE_CHECKING

from mission.fly import FlightOptions, FlightResult, Progress, StopRequest, fly
from mission.plan import FlightPlan
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from tests.support.scripted_vehicle import ScriptedVehicle

if TYPE_CHECKING:
    from collections.abc import Callable

    from mission.fly.recording import RecordWriter
    from mission.monitor.stage import Stage


class Flight:
    """One call of ``fly``, with the record that it leaves whether it returns or raises."""

    def __init__(self, vehicle: ScriptedVehicle, plan: FlightPlan) -> None:
        self.vehicle, self.plan = vehicle, plan
        self.progress: list[Progress] = []
        self.at_stage: dict[Stage, Callable[[], None]] = {}
        self.options = FlightOptions()
        self.stop_request: Callable[[], StopRequest | None] | None = None
        self.vehicle_failure: Callable[[], str] | None = None
        self.warnings: list[str] = []
        self.recorder: Callable[[FlightRecord], RecordWriter] = lambda record: record
        self.sink = io.BytesIO()

    def run(self) -> FlightResult:
        def watch(progress: Progress) -> None:
            self.progress.append(progress)
            act = self.at_stage.pop(progress.stage, None)
            if act is not None:
                act()

        return fly(
            self.plan,
            self.vehicle,
            self.vehicle,
            self.recorder(FlightRecord(self.sink, mission="small")),
            options=self.options,
            on_progress=watch,
            vehicle_failure=self.vehicle_failure,
            stop_request=self.stop_request,
            on_warning=self.warnings.append,
        )

    @property
    def record(self) -> Record:
        return parse_record(self.sink.getvalue())
