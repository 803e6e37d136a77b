"""What commands share on the terminal: one console for results, one for errors, and how faults look."""

from rich.console import Console
from rich.markup import escape

from mission.errors import FormulaSyntaxError, MissionError, SpecError

out = Console(highlight=False, soft_wrap=True)
err = Console(stderr=True, highlight=False, soft_wrap=True)


def count(number: int, noun: str) -> str:
    """``3 runs``, ``1 run``."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def print_error(error: MissionError, source: str = "") -> None:
    """Show a failure on standard error: what is wrong, where, and what to do about it."""
    prefix = f"{escape(source)}: " if source else ""
    if isinstance(error, SpecError):
        _print_faults(error)
    elif isinstance(error, FormulaSyntaxError):
        err.print(f"[bold red]error:[/] {escape(error.message)} (column {error.column})")
        err.print(f"  {escape(error.text)}\n  {' ' * (error.column - 1)}[bold red]^[/]")
        if error.hint:
            err.print(f"  {escape(error.hint)}")
    else:
        err.print(f"{prefix}[bold red]error:[/] {escape(str(error))}")


def _print_faults(error: SpecError) -> None:
    for fault in error.faults:
        place = ":".join(str(part) for part in (error.source, fault.line, fault.column) if part)
        where = " ".join(
            part for part in (f"{place}:" if place else "", f"{fault.path}:" if fault.path else "") if part
        )
        err.print(f"[bold]{escape(where)}[/] {escape(fault.message)}")
        if fault.hint:
            err.print(f"    {escape(fault.hint)}")
    err.print(f"[bold red]{count(len(error.faults), 'fault')}[/]")
