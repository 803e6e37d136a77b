"""How a check before the flight looks on the terminal: one line where all is well, the table where it is not."""

from contextlib import suppress

from rich.console import Console

from mission.cli.screen import err
from mission.fly.preflight import Finding, Findings, Level

_COLOURS = {Level.GO: "green", Level.UNKNOWN: "dim", Level.CAUTION: "yellow", Level.NO_GO: "bold red"}
_LEVEL, _NAME = max(map(len, Level)), 13


def print_table(findings: Findings, console: Console) -> None:
    """Print all rows with their figures and what to do, and what follows."""
    for row in findings.rows:
        _print_row(row, console)
    colour, verdict = ("green", "GO") if findings.go else ("red", "NO-GO")
    console.print(f"[bold {colour}]{verdict}[/]")


def print_departure(findings: Findings, *, bundled: bool) -> None:
    """Print what a flight begins with; nobody stands beside the bundled vehicle, so its cautions are left out."""
    with suppress(OSError):
        if not findings.go:
            for row in findings.rows:
                if row.judgement.level in (Level.NO_GO, Level.CAUTION):
                    _print_row(row, err)
            return
        words = [f"forced: {row.row}" for row in findings.rows if row.forced]
        cautions = () if bundled else findings.of(Level.CAUTION)
        words += [f"caution: {', '.join(cautions)} (`mission check FILE --connect` says why)"] if cautions else []
        err.print(f"preflight go{''.join(f'; {each}' for each in words)}", markup=False)


def _print_row(row: Finding, console: Console) -> None:
    judgement = row.judgement
    console.print(f"{judgement.level.value:<{_LEVEL}}", style=_COLOURS[judgement.level], end="")
    forced = " (forced)" if row.forced else ""
    console.print(f"  {row.row:<{_NAME}}  {judgement.figure}{forced}", markup=False)
    if judgement.advice:
        console.print(f"{'':<{_LEVEL + _NAME + 4}}{judgement.advice}", markup=False)
