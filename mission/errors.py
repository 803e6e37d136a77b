"""The failures of the planner, one class for each kind, carrying data and not prose.

Only the command line turns them into text and an exit code: 2 bad input, 3 no plan exists, 4 link or vehicle failure.
"""

import os
from dataclasses import dataclass


class MissionError(Exception):
    """Base of every failure that the planner raises on purpose."""

    exit_code = 1


@dataclass(frozen=True, order=True)
class Fault:
    """One thing that is wrong with a mission file.

    Attributes:
        line: One-based line in the file, 0 where the fault is the file as a whole.
        column: One-based column in that line, 0 where unknown.
        path: Dotted path of the value, such as ``regions.S1.triangle``; empty for the file as a whole.
        message: What is wrong.
        hint: What to write instead; may be empty.
    """

    line: int
    column: int
    path: str
    message: str
    hint: str = ""


class SpecError(MissionError):
    """A mission file, a formula or an argument that cannot be used; carries every fault found."""

    exit_code = 2

    def __init__(self, faults: tuple[Fault, ...], source: str = "") -> None:
        self.faults = tuple(sorted(faults))
        self.source = source
        super().__init__("; ".join(f.message for f in self.faults))


class FormulaSyntaxError(MissionError):
    """A formula that cannot be parsed.

    Attributes:
        text: The formula as given.
        column: One-based column of the first offending character.
        hint: What was expected there.
    """

    exit_code = 2

    def __init__(self, message: str, *, text: str, column: int, hint: str = "") -> None:
        self.message, self.text, self.column, self.hint = message, text, column, hint
        super().__init__(f"{message} (column {column})")


class AutomatonSizeError(MissionError):
    """A formula, an automaton, or one that these ask for, is too large to be built; the message says which bound."""

    exit_code = 2


class SearchSizeError(MissionError):
    """The best run of a mission is beyond an exact search; the message says which bound it meets."""

    exit_code = 2


class GeometryError(MissionError):
    """A domain, a region or a place on Earth that the geometry cannot work with; the message says which and why."""

    exit_code = 2


class NoPlanError(MissionError):
    """No run, no smoothing or no certificate exists for a well-formed mission; the message says why.

    Attributes:
        cause: Kind of the reason, a value of ``mission.plan.diagnosis.Cause``; empty where it has none.
        conjuncts: Parts of the specification that cannot be met together, as text; empty where unknown.
        restricted: Restricted regions that have a part in it.
        regions: Regions that cannot be reached, or not together.
    """

    exit_code = 3

    def __init__(
        self,
        message: str,
        *,
        cause: str = "",
        conjuncts: tuple[str, ...] = (),
        restricted: tuple[str, ...] = (),
        regions: tuple[str, ...] = (),
    ) -> None:
        self.cause, self.conjuncts, self.restricted, self.regions = cause, conjuncts, restricted, regions
        super().__init__(message)


class UnprovedError(NoPlanError):
    """A path has no smoothing that is proved.

    Attributes:
        counterexample: Triangles of a violating flight, in order; empty unless a word is to blame.
        where_s: Steering time at which the proof fails; None where something else is wrong with the path.
    """

    def __init__(self, message: str, *, counterexample: tuple[int, ...], where_s: float | None) -> None:
        super().__init__(message)
        self.counterexample, self.where_s = counterexample, where_s


class NoRollingStartError(NoPlanError):
    """No plan begins with the present velocity and acceleration; one that begins at rest there may."""


class LateError(NoPlanError):
    """No plan was found that keeps what its mission asks for in seconds; the message has a line for each bound."""


class LinkError(MissionError):
    """The MAVLink connection could not be opened, or was lost."""

    exit_code = 4


class VehicleError(MissionError):
    """The vehicle refused, or did not do what it acknowledged; carries its own words where it gave any."""

    exit_code = 4


class FlightError(MissionError):
    """A flight was given up for a failure on this side, of the program or of the machine; the cause is chained."""

    exit_code = 4


class RecordError(MissionError):
    """A file that is no record of a flight, or one that is damaged before its end.

    Attributes:
        line: One-based line of the record; 0 for the record as a whole.
    """

    exit_code = 2

    def __init__(self, message: str, *, line: int) -> None:
        self.line = line
        super().__init__(message)


def reason(error: Exception) -> str:
    """Why something failed: of what the system refused, its words alone, without number and name."""
    if not isinstance(error, OSError):
        return str(error)
    if error.errno is not None and error.errno > 0:
        return os.strerror(error.errno).lower()
    return error.strerror or str(error)
