"""``mission calibrate``: fly a figure of eight, measure how it is followed, and say what the tube has to be."""

import math
from argparse import Namespace
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path

from mission.cli.inputs import write_named
from mission.cli.mission_input import mission_in
from mission.cli.screen import err, out, tube_costs
from mission.cli.vehicle_link import UNHEARD, check_vehicle_options, link_options, link_to, warn
from mission.decimals import measure
from mission.errors import Fault, LinkError, SpecError
from mission.fly import FlightOptions, Progress, StopSignals
from mission.fly.calibration import Calibration, Spread, calibrate
from mission.monitor.stage import Stage
from mission.plan.figure_of_eight import figure_of_eight
from mission.printable import printable
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

_OPEN_FIELD = """\
name: Open field
domain: {boundary: [[-60, -60], [60, -60], [60, 60], [-60, 60]]}
regions: {field: {kind: area, centre: [0, 0], radius_m: 50}}
mission: {formula: "true"}
start: {position_m: [0, 0]}
"""


def run(arguments: Namespace) -> int:
    """Fly, print what was measured, and write it as a part of a mission file."""
    check_vehicle_options(arguments)
    target = None if arguments.out is None else Path(arguments.out)
    if target is not None and target.exists() and not arguments.force:
        hint = "choose another name, or say --force to write over it"
        raise SpecError((Fault(0, 0, "--out", f"{target} is there already", hint),))
    spec = parse_mission(_OPEN_FIELD.encode()) if arguments.file is None else mission_in(arguments.file)
    figure_of_eight(spec)  # there may be no room; then nothing takes off
    heard = _Heard()
    link = link_options(arguments)
    with StopSignals() as stop, ExitStack() as stack:
        vehicle, transport, clock = link_to(arguments, link, spec, stack)
        try:
            found = calibrate(
                spec,
                transport,
                clock,
                options=FlightOptions(link=link, land_when_stopped=vehicle is not None),
                on_progress=heard.show,
                vehicle_failure=None if vehicle is None else vehicle.failure,
                stop_request=stop.take,
                on_warning=warn,
            )
        except LinkError:
            if not heard.at_all:
                err.print(f"    {UNHEARD}", markup=False)
            raise
    if link.signatures is not None:
        link.signatures.end()
    _print_found(found, spec)
    if target is None:
        out.out(f"\n{found.fragment(spec)}", end="", highlight=False)
    else:
        write_named("--out", target, found.fragment(spec))
        out.print(f"written to {printable(str(target))}", markup=False)
    return 0


class _Heard:
    """Says each stage of the flight once.

    Attributes:
        at_all: Whether a vehicle was heard.
    """

    def __init__(self) -> None:
        self.at_all = False
        self._said = ""

    def show(self, moment: Progress) -> None:
        """Take one moment."""
        self.at_all = self.at_all or moment.stage is not Stage.CONNECT
        if moment.stage.value != self._said:
            self._said = moment.stage.value
            with suppress(OSError):
                err.print(self._said, markup=False)


def _print_found(found: Calibration, spec: MissionSpec) -> None:
    flight = replace(spec.flight, disturbance_m_s2=0.0, margins=found.margins)
    more_m = math.sqrt(2.0) * (flight.tube_m - spec.flight.tube_m)
    apart = "behind" if found.lag_s >= 0.0 else "ahead of"
    share = f"{measure(abs(more_m))} m {'more' if more_m > 0.0 else 'less'}"
    lines = [
        ("flown", f"three times a figure of eight in {found.duration_s:.0f} s, at up to {found.speed_m_s:.2f} m/s"),
        ("following", _spread(found.position_m, "m")),
        ("velocity", _spread(found.velocity_m_s, "m/s")),
        (
            "delay",
            f"{abs(found.lag_s):.2f} s {apart} the trajectory on the whole",
        ),
        ("drag", f"{found.drag_per_s:.2f} of the speed each second, by its lean"),
        ("wind", _wind(found.wind_m_s)),
        ("tube", f"{measure(flight.tube_m)} m per axis, for this wind and with a quarter in reserve"),
        *(("", line) for line in tube_costs(flight)),
        (
            "",
            f"{share} of clearance than the mission's own tube takes",
        ),
    ]
    for name, words in lines:
        out.print(f"{name:<10}{words}", markup=False)


def _spread(spread: Spread, unit: str) -> str:
    return (
        f"half of the time within {spread.half:.2f} {unit} per axis, 99 % within {spread.most:.2f} {unit}, "
        f"at most {spread.largest:.2f} {unit}"
    )


def _wind(wind_m_s: tuple[float, float] | None) -> str:
    if wind_m_s is None:
        return "not known: there is too little drag to tell it"
    east, north = wind_m_s
    from_deg = math.degrees(math.atan2(-east, -north)) % 360.0
    return f"{math.hypot(east, north):.1f} m/s from {from_deg:.0f} degrees"
