"""The pictures of a plan and of its flight: the paper's Figures 2 to 10, for any mission."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from matplotlib.figure import Figure

from mission.plan import FlightPlan
from mission.report.figures.automaton import automaton
from mission.report.figures.canvas import WRITERS
from mission.report.figures.coverage import coverage
from mission.report.figures.histories import control_signals, time_histories, tracked_states
from mission.report.figures.moments import flown_moments, planned_moments, true_moments
from mission.report.figures.partition import annotated_partition
from mission.report.figures.paths import flown_path, planned_path, smoothed_path
from mission.report.figures.quotient import quotient
from mission.report.figures.simulated import true_control, true_path, true_states
from mission.report.reading import Record
from mission.simulate import Simulation
from mission.spec.model import FIELD
from mission.whole_file import write_whole


@dataclass(frozen=True)
class Picture:
    """A picture in a folder.

    Attributes:
        file: Its name there, as PNG.
        title: What it is.
        caption: What is seen in it.
        by_field: What is, of a flight that is led by the field; empty where that is the same.
        without_tube: What is, where no tube is proved; empty where that is the same.
    """

    file: str
    title: str
    caption: str
    by_field: str = ""
    without_tube: str = ""

    def of(self, plan: FlightPlan) -> "Picture":
        """The same with the caption for this plan."""
        if plan.spec.flight.guidance == FIELD:
            return replace(self, caption=self.by_field or self.caption)
        return self if plan.certificate.tube_m > 0.0 else replace(self, caption=self.without_tube or self.caption)


@dataclass(frozen=True)
class _OfPlan:
    picture: Picture
    draw: Callable[[FlightPlan], Figure]


@dataclass(frozen=True)
class _OfFlight:
    picture: Picture
    draw: Callable[[FlightPlan, Record], Figure]


@dataclass(frozen=True)
class _OfCoverage:
    """Drawn where a plan covers regions, with its flight where there is one."""

    picture: Picture
    draw: Callable[[FlightPlan, Record | None], Figure]


@dataclass(frozen=True)
class _OfMotion:
    """Drawn where something moves."""

    picture: Picture
    draw: Callable[[FlightPlan], Figure]


@dataclass(frozen=True)
class _OfFlightAndMotion:
    """Drawn of a flight where something moves."""

    picture: Picture
    draw: Callable[[FlightPlan, Record], Figure]


_Entry = _OfPlan | _OfFlight | _OfCoverage | _OfMotion | _OfFlightAndMotion

PICTURES: tuple[_Entry, ...] = (
    _OfPlan(
        Picture(
            "02_partition.png",
            "Partition",
            "The domain, cut into triangles. Survey regions and home are filled, restricted regions hatched. Unless "
            "there are too many, each triangle shows its number over its three vertices, counter-clockwise.",
        ),
        annotated_partition,
    ),
    _OfPlan(
        Picture(
            "03_quotient.png",
            "Quotient",
            "The transition system: one state for each triangle, and a move to each neighbour that may be entered. "
            "Control u\u2c7c leaves a triangle through the facet opposite its j-th vertex.",
        ),
        quotient,
    ),
    _OfPlan(
        Picture(
            "04_automaton.png",
            "Automaton",
            "The Büchi automaton of the specification. A flight satisfies that if its word can be read from the "
            "arrow on the left so that a state with a double circle is met again and again; where there are several "
            "automata, for each part of the specification one, in all of them.",
        ),
        automaton,
    ),
    _OfPlan(
        Picture(
            "05_planned_path.png",
            "Planned path",
            "The shortest path that does what the run does; or, where the mission asks for the Fourier series, what "
            "the steering law flies through the triangles of the run. Its direction jumps.",
        ),
        planned_path,
    ),
    _OfPlan(
        Picture(
            "06_time_histories.png",
            "Planned and smoothed path over time",
            "The planned path and the smoothed one. The jumps of the velocity are what the smoothing removes.",
        ),
        time_histories,
    ),
    _OfPlan(
        Picture(
            "07_smoothed_path.png",
            "Smoothed path",
            "The path that the vehicle is asked to track, in the tube that the certificate speaks of.",
            "A path that does what the mission asks. It is not flown: at each moment the field leads on from where the "
            "vehicle is, and no tube is proved.",
            "The path that the vehicle is asked to track. There is no tube: the mission counts on no disturbance.",
        ),
        smoothed_path,
    ),
    _OfFlight(
        Picture(
            "08_tracked_states.png",
            "Tracked states",
            "Position and velocity, asked for and reported, and the error of the position against the tube.",
            "Position and velocity as they were reported, and the velocity that the field asked for.",
            "Position and velocity, asked for and reported, and the error of the position.",
        ),
        tracked_states,
    ),
    _OfFlight(
        Picture(
            "09_control_signals.png",
            "Control signals",
            "The acceleration of the setpoints, and the one that follows from the attitude that the vehicle reported.",
            "The acceleration that follows from the attitude that the vehicle reported, and the tilt.",
        ),
        control_signals,
    ),
    _OfFlight(
        Picture(
            "10_flown_path.png",
            "Flown path",
            "Where the vehicle reported to be, strong, over the trajectory that it was asked to fly, thin; how far "
            "it was from where it should be then, by colour.",
            "Where the vehicle reported to be, strong, over the path of the plan, thin, which it was not asked to fly.",
        ),
        flown_path,
    ),
    _OfCoverage(
        Picture(
            "11_coverage.png",
            "Coverage",
            "The lanes of the regions that are to be covered. After a flight also what was farther than half the "
            "distance between lanes from where the vehicle reported to be on them, and where images were taken.",
        ),
        coverage,
    ),
    _OfMotion(
        Picture(
            "12_moments.png",
            "The flight at several moments",
            "Where triangles and regions are at several moments of the motion and of the flight, by the clock of the "
            "trajectory; what is flown by then is strong, what is still to come is thin.",
        ),
        planned_moments,
    ),
    _OfFlightAndMotion(
        Picture(
            "13_flown_moments.png",
            "What was flown, at several moments",
            "Where triangles and regions were at several moments of the motion and of the flight, and where the "
            "vehicle had reported to be by then; what it reported later is thin.",
        ),
        flown_moments,
    ),
)


def save_all(
    plan: FlightPlan, record: Record | None, folder: Path, formats: Sequence[str] = ("png",)
) -> tuple[Picture, ...]:
    """Draw the pictures of a plan, and of its flight where there is a record, into a folder; return what was drawn.

    Args:
        plan: The plan.
        record: The record of its flight, or None for a plan that was not flown.
        folder: Made if it is not there.
        formats: Of ``png``, ``svg``, ``pdf``; each picture is written in each.

    Raises:
        OSError: The folder cannot be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    for entry in PICTURES:
        if isinstance(entry, _OfPlan):
            figure = entry.draw(plan)
        elif isinstance(entry, _OfMotion):
            if plan.moving is None:
                continue
            figure = entry.draw(plan)
        elif isinstance(entry, _OfCoverage):
            if not plan.covers:
                continue
            figure = entry.draw(plan, record)
        elif isinstance(entry, _OfFlightAndMotion) and plan.moving is None:
            continue
        elif record is not None:
            figure = entry.draw(plan, record)
        else:
            continue
        _write(figure, folder / entry.picture.file, formats)
        drawn.append(entry.picture.of(plan))
    return tuple(drawn)


_SIMULATED: Final = {
    "08_true_states.png": true_states,
    "09_true_control.png": true_control,
    "10_true_path.png": true_path,
}


def save_simulated(
    plan: FlightPlan, simulation: Simulation, folder: Path, formats: Sequence[str] = ("png",)
) -> tuple[Path, ...]:
    """Draw Figures 8 to 10 of a simulated flight into a folder, in each of these formats; return what was drawn.

    Where something moves, also where it is at several moments.

    Raises:
        OSError: The folder cannot be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    drawn = _SIMULATED if plan.moving is None else {**_SIMULATED, "11_true_moments.png": true_moments}
    files = [_write(draw(plan, simulation), folder / name, formats) for name, draw in drawn.items()]
    return tuple(file for written in files for file in written)


def _write(figure: Figure, file: Path, formats: Sequence[str]) -> list[Path]:
    """Write a picture in each format, beside each other."""
    files = [file.with_suffix(f".{name}") for name in formats]
    for name, each in zip(formats, files, strict=True):
        write_whole(each, WRITERS[name](figure))
    return files
