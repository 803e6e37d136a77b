"""The whole table of a check before the flight, judged without I/O."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final

from mission.errors import Fault, MissionError, SpecError
from mission.fly.preflight.failsafes import FAILSAFE_ROWS
from mission.fly.preflight.limits import LIMIT_ROWS
from mission.fly.preflight.rows import ARDUPILOT, PX4, Asked, Judgement, Level, Row, Told
from mission.fly.preflight.surroundings import SURROUNDING_ROWS

ROWS: Final[tuple[Row, ...]] = (*SURROUNDING_ROWS, *LIMIT_ROWS, *FAILSAFE_ROWS)

PARAMETERS: Final[Mapping[str, tuple[tuple[str, ...], ...]]] = {
    autopilot: tuple(
        dict.fromkeys(
            tuple(name for name, _ in setting.names[autopilot])
            for row in ROWS
            for setting in row.settings
            if autopilot in setting.names
        )
    )
    for autopilot in (ARDUPILOT, PX4)
}
"""What is read of each autopilot: each parameter under all names that it may have."""


@dataclass(frozen=True)
class Finding:
    """A row, judged.

    Attributes:
        row: Its name.
        judgement: What is thought of it.
        forced: Whether a no-go was overridden.
    """

    row: str
    judgement: Judgement
    forced: bool = False

    @property
    def forbids(self) -> bool:
        """Whether it keeps the vehicle on the ground."""
        return self.judgement.level is Level.NO_GO and not self.forced

    @property
    def words(self) -> str:
        """The row, its figures and what to do, as a sentence of a message."""
        advice = f" ({self.judgement.advice})" if self.judgement.advice else ""
        return f"{self.row}: {self.judgement.figure}{advice}"

    def values(self) -> dict[str, object]:
        """The same for records and for programs."""
        return {
            "row": self.row,
            "level": self.judgement.level.value,
            "figure": self.judgement.figure,
            "advice": self.judgement.advice,
            "forced": self.forced,
        }


@dataclass(frozen=True)
class Findings:
    """All rows, in the order of the table."""

    rows: tuple[Finding, ...]

    @property
    def go(self) -> bool:
        """Whether the vehicle may fly."""
        return not self.forbidding

    @property
    def forbidding(self) -> tuple[Finding, ...]:
        """The rows that keep it on the ground."""
        return tuple(row for row in self.rows if row.forbids)

    @property
    def forced_text(self) -> str:
        """What it flies against, in plain words; empty where there is nothing."""
        forced = [f"{row.row} ({row.judgement.figure})" for row in self.rows if row.forced]
        return f"flown against the check before the flight: {', '.join(forced)}" if forced else ""

    def of(self, level: Level) -> tuple[str, ...]:
        """The names of the rows of a level."""
        return tuple(row.row for row in self.rows if row.judgement.level is level)

    def values(self) -> dict[str, object]:
        """The same for records and for programs."""
        return {"go": self.go, "rows": [row.values() for row in self.rows]}


class NoGoError(MissionError):
    """The check before the flight found what forbids it; nothing was armed.

    Attributes:
        findings: The whole table.
        exit_code: 2 where the mission file alone is to blame, 4 where the vehicle is.
    """

    def __init__(self, findings: Findings) -> None:
        self.findings = findings
        self.exit_code = 2 if all(row.judgement.blames_file for row in findings.forbidding) else 4
        super().__init__(f"no-go, nothing was armed: {'; '.join(row.words for row in findings.forbidding)}")


def judged(asked: Asked, told: Told, forced: Collection[str] = ()) -> Findings:
    """Judge each row; of those in ``forced`` a no-go does not count."""
    judgements = ((row.name, row.judge(asked, told)) for row in ROWS)
    return Findings(
        tuple(
            Finding(name, judgement, forced=name in forced and judgement.level is Level.NO_GO)
            for name, judgement in judgements
        )
    )


def check_forced(forced: Collection[str]) -> None:
    """Refuse names that no row has.

    Raises:
        SpecError: There is one.
    """
    names = [row.name for row in ROWS]
    faults = tuple(
        Fault(0, 0, "--force", f"there is no row {name!r}", f"write one of {', '.join(names)}")
        for name in forced
        if name not in names
    )
    if faults:
        raise SpecError(faults)
