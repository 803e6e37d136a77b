"""What commands share on the terminal: consoles for results, for asides and for what is wrong, and how faults look."""

import json
import math
import sys
from argparse import Namespace
from dataclasses import asdict
from typing import Any

from rich.cells import cell_len
from rich.console import Console
from rich.markup import escape

from mission.cli.mission_input import line_of
from mission.decimals import count, decimal, measure
from mission.errors import Fault, FormulaSyntaxError, MissionError, SpecError
from mission.printable import printable, shows
from mission.spec.model import Flight

_EXCERPT = 96
_BEFORE = 64


class _Console(Console):
    """A console that leaves it to the program what happens when the reader of a pipe goes away."""

    def on_broken_pipe(self) -> None:
        """Pass the error on; rich would end the program here."""
        raise  # noqa: PLE0704 - rich calls this while it handles the BrokenPipeError

    def print(self, *objects: Any, **options: Any) -> None:  # noqa: ANN401 - rich's own
        """Print; whatever the words are made of, the terminal obeys none of them. Line ends are the program's own."""
        super().print(*map(_shown, objects), **options)

    def out(self, *objects: Any, **options: Any) -> None:  # noqa: ANN401 - rich's own
        """Print without markup and wrapping, and as harmlessly."""
        super().out(*map(_shown, objects), **options)


def _shown(content: object) -> object:
    return printable(content, keep="\n") if isinstance(content, str) else content


out = _Console(highlight=False, soft_wrap=True, emoji=False)
err = _Console(stderr=True, highlight=False, soft_wrap=True, emoji=False)
_wrong = _Console(stderr=True, highlight=False, soft_wrap=True, emoji=False)


def speak(options: Namespace) -> None:
    """Say as much as the options of a command ask for.

    With ``quiet``, only what is wrong. With ``json`` nothing but what ``print_json`` prints is a result.
    """
    err.quiet = getattr(options, "quiet", False)
    out.quiet = err.quiet or getattr(options, "json", False)


def print_json(document: object) -> None:
    """Print the one document of a command, on a line; a number that is not finite is null in it."""
    finite = json.loads(json.dumps(document), parse_constant=lambda _: None)
    sys.stdout.write(json.dumps(finite) + "\n")


def error_values(error: MissionError) -> dict[str, object]:
    """A failure for programs."""
    faults = error.faults if isinstance(error, SpecError) else ()
    return {"exit_code": error.exit_code, "error": str(error), "faults": [asdict(fault) for fault in faults]}


def reach(tube_m: float) -> str:
    """Which vehicles a proof is about."""
    if tube_m == 0.0:
        return "for a vehicle exactly on the smoothed path (disturbance_m_s2 is 0)"
    return f"within {tube_m:g} m per axis of the smoothed path"


def tube_text(flight: Flight) -> str:
    """What the tube is made of; empty where it has no width."""
    parts = [f"{decimal(share_m)} m for {cause}" for cause, share_m in flight.tube_causes]
    return f"{measure(flight.tube_m)} m per axis: {' + '.join(parts)}" if parts else ""


def tube_costs(flight: Flight) -> tuple[str, ...]:
    """Each cause of the tube and what it takes of the room, which is most beside a slanting outline."""
    room = [(cause, share_m, math.sqrt(2.0) * share_m) for cause, share_m in flight.tube_causes]
    return tuple(
        f"{decimal(share_m)} m for {cause}, up to {measure(room_m)} m of clearance" for cause, share_m, room_m in room
    )


def print_error(error: MissionError, source: str = "") -> None:
    """Show a failure on standard error: what is wrong, where, and what to do about it.

    Args:
        error: The failure.
        source: The file that it is about, where the error does not name it itself.
    """
    if isinstance(error, SpecError):
        for fault in error.faults:
            _print_fault(fault, error.source or source)
        if len(error.faults) > 1:
            _wrong.print(f"[bold red]{count(len(error.faults), 'fault')}[/]")
    elif isinstance(error, FormulaSyntaxError):
        _wrong.print(f"[bold red]error:[/] {escape(str(error))}")
        _print_pointed(error.text, error.column)
        if error.hint:
            _wrong.print(f"    {escape(error.hint)}")
    else:
        place = f"[bold]{escape(printable(source))}:[/] " if source else ""
        _wrong.print(f"{place}[bold red]error:[/] {escape(str(error))}")


def print_warnings(warnings: tuple[str, ...], source: str = "") -> None:
    """Show on standard error what the writer of a mission may not have meant."""
    place = f"[bold]{escape(printable(source))}:[/] " if source else ""
    for warning in warnings:
        err.print(f"{place}[bold yellow]warning:[/] {escape(warning)}")


def _print_fault(fault: Fault, source: str) -> None:
    place = ":".join(str(part) for part in (source, fault.line, fault.column) if part)
    where = printable(" ".join(f"{part}:" for part in (place, fault.path) if part))
    _wrong.print(f"[bold]{escape(where)}[/] {escape(fault.message)}" if where else f"error: {escape(fault.message)}")
    if fault.line and fault.column:
        _print_excerpt(source, fault.line, fault.column)
    if fault.hint:
        _wrong.print(f"    {escape(fault.hint)}")


def _print_excerpt(source: str, line: int, column: int) -> None:
    """The line of the file with a caret under the place; nothing where the file cannot be read any more."""
    try:
        text = line_of(source, line).decode("utf-8-sig" if line == 1 else "utf-8", "replace")
    except OSError:
        return
    _print_pointed(text, column)


def _print_pointed(text: str, column: int) -> None:
    """A line, or the part of it around a column, with a caret under that."""
    begin = max(0, column - 1 - _BEFORE)
    # A file may hold what would move the cursor or colour the terminal.
    shown = "".join(c if shows(c) else " " if c in "\t\r\n" else "?" for c in text[begin : begin + _EXCERPT])
    _wrong.print(f"    [dim]|[/] {escape(shown.rstrip())}")
    _wrong.print(f"    [dim]|[/] {' ' * cell_len(shown[: column - 1 - begin])}[bold red]^[/]")
