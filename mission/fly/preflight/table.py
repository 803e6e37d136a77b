"""The whole table of a check before the flight, judged without I/O."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final

from mission.errors import Fault, MissionError, SpecError
from mission.fly.preflight.failsafes import FAILSAFE_ROWS
from mission.fly.preflight.limits import LIMIT_ROWS
from mission.fly.preflight.rows import ARDUPILOT, PX4, Asked, Judgement, Level, Row, Told
from mission.fly.preflight.surroundings import SURROUNDING_ROWS
from mission.spec.finding import rather

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
        firm: Whether it cannot be.
    """

    row: str
    judgement: Judgement
    forced: bool = False
    firm: bool = False

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
    """Judge each row; of those in ``forced`` a no-go does not count, where the row gives way at all."""
    return Findings(tuple(_judged(row, row.judge(asked, told), forced) for row in ROWS))


def _judged(row: Row, judgement: Judgement, forced: Collection[str]) -> Finding:
    gives_way = row.name in forced and not row.firm and judgement.level is Level.NO_GO
    return Finding(row.name, judgement, forced=gives_way, firm=bool(row.firm))


def check_forced(forced: Collection[str]) -> None:
    """Refuse names that no row has, and those of rows that do not give way.

    Raises:
        SpecError: There is one.
    """
    names = [row.name for row in ROWS if not row.firm]
    firm = {row.name: row.firm for row in ROWS if row.firm}
    faults = [
        Fault(0, 0, "--force", f"the row {name!r} does not give way", firm[name])
        if name in firm
        else Fault(0, 0, "--force", f"there is no row {name!r}", rather(name, names, "rows", most=len(names)))
        for name in forced
        if name not in names
    ]
    if faults:
        raise SpecError(tuple(faults))
