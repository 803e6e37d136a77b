"""``mission new``: a mission file from a few answers, or from options alone."""

import sys
from argparse import ArgumentTypeError, Namespace
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final, TypeVar

from rich.prompt import Prompt

from mission.cli.busy import doing
from mission.cli.importing import drawing_in, free, tell
from mission.cli.inputs import write_named
from mission.cli.option_values import extent, positive
from mission.cli.screen import err, out, print_error, print_warnings
from mission.decimals import decimal
from mission.draft.cameras import ALTITUDE_M
from mission.draft.drafting import SPEED_M_S
from mission.draft.trials import draft_that_plans
from mission.draft.wishes import ALL, ROLES, VISIT, Drawings, Wishes, names_in, plain_field, wished
from mission.errors import Fault, MissionError, SpecError
from mission.interchange.features import Drawing
from mission.printable import printable

_STDOUT: Final = "-"
_EXTENT: Final = "120,80"
_NAME: Final = "mission"

Answer = TypeVar("Answer")


def run(arguments: Namespace) -> int:
    """Ask what no option says where somebody can answer, plan what comes of it, and write it if it plans."""
    asks = sys.stdin is not None and sys.stdin.isatty()
    try:
        drawings = _drawings(arguments, asks=asks)
        drawn = wished(drawings, _wishes(arguments, drawings, asks=asks))
        target = _target(arguments, drawings[0][0], asks=asks)
    except EOFError:
        hint = "give the answers as options, see mission new --help"
        raise SpecError((Fault(0, 0, "", "not all questions were answered: nothing is written", hint),)) from None
    with doing("drafting and planning"):
        trial = draft_that_plans(drawn, arguments.name or " and ".join(file for file, _ in drawings))
    if trial.error is not None:
        err.print("it does not plan: nothing is written; `mission import` writes what there is, to be mended")
        raise _without_lines(trial.error)
    if target is None:
        out.out(trial.draft.text, end="", highlight=False)
    else:
        write_named("--out", target, trial.draft.text)
        tell(trial, target)
        out.out(f"    to fly it: mission fly {printable(str(target))}", highlight=False)
    print_warnings(trial.draft.remarks)
    return 0


def _drawings(arguments: Namespace, *, asks: bool) -> Drawings:
    """What the mission is made of: drawings, or a rectangle.

    Raises:
        SpecError: A drawing cannot be read, or its extent is given, too.
    """
    if arguments.drawings and arguments.extent is not None:
        raise SpecError((Fault(0, 0, "--extent", "a drawing says itself how far it reaches", "leave it out"),))
    if arguments.drawings:
        return [_drawing(file) for file in arguments.drawings]
    if arguments.extent is None and asks:
        words = "Which file draws the area, such as farm.kml? (Enter: none, a plain rectangle)"
        drawing = _asked(words, "", lambda text: _drawing(text) if text else None)
        if drawing is not None:
            return [drawing]
    extent_m = arguments.extent or _answered("How far does it reach, EAST,NORTH in metres?", _EXTENT, extent, asks=asks)
    return [(_NAME, plain_field(*extent_m))]


def _drawing(file: str) -> tuple[str, Drawing]:
    return Path(file).stem, drawing_in(Path(file))


def _wishes(arguments: Namespace, drawings: Drawings, *, asks: bool) -> Wishes:
    """What is wanted of them, by options or by answers."""
    wishes = Wishes(
        {wish: tuple(getattr(arguments, wish)) for wish in ROLES},
        altitude_m=arguments.altitude,
        speed_m_s=arguments.speed,
    )
    if not asks:
        return wishes
    names = names_in(drawings)
    told = ", ".join(f"{name} ({role or 'not told'})" for name, role in names.items())
    err.print(f"There are: {told}", markup=False)
    for wish, words, default in (
        ("avoid", "Which are never to be entered? (names with commas between; Enter: those that are restricted)", ""),
        ("home", "In which does the flight begin and end? (Enter: as drawn, or a place with room around it)", ""),
        (VISIT, "Which are to be visited? (all: what is for nothing else)", ALL),
    ):
        if not wishes.names[wish]:
            wishes = _asked(words, default, _wanting(wishes, wish, drawings))
    drawn = [drawing for _, drawing in drawings]
    altitude_m = max((each.altitude_m for each in drawn if each.altitude_m), default=ALTITUDE_M)
    speed_m_s = max((each.speed_m_s for each in drawn if each.speed_m_s), default=SPEED_M_S)
    return replace(
        wishes,
        altitude_m=wishes.altitude_m or _asked("How high, in metres?", decimal(altitude_m), positive),
        speed_m_s=wishes.speed_m_s or _asked("How fast, in m/s?", decimal(speed_m_s), positive),
    )


def _wanting(wishes: Wishes, wish: str, drawings: Drawings) -> Callable[[str], Wishes]:
    """Reads names into a wish, if there are such."""

    def read(text: str) -> Wishes:
        names = tuple(name.strip() for name in text.split(",") if name.strip())
        wanted = replace(wishes, names={**wishes.names, wish: names})
        wished(drawings, wanted)
        return wanted

    return read


def _target(arguments: Namespace, stem: str, *, asks: bool) -> Path | None:
    """Where it is to be written; None for standard output.

    Raises:
        SpecError: There is a file already.
    """
    if arguments.out == _STDOUT:
        return None
    if arguments.out is None:
        return _answered("Where is it to be written?", f"{stem}.yaml", _to(force=arguments.force), asks=asks)
    return free(Path(arguments.out), force=arguments.force)


def _to(*, force: bool) -> Callable[[str], Path]:
    return lambda text: free(Path(text), force=force)


def _answered(words: str, default: str, read: Callable[[str], Answer], *, asks: bool) -> Answer:
    """What is answered, or the default where nobody can."""
    return _asked(words, default, read) if asks else read(default)


def _asked(words: str, default: str, read: Callable[[str], Answer]) -> Answer:
    """Ask until the answer can be read.

    Raises:
        EOFError: Nobody answers any more.
    """
    while True:
        text = Prompt.ask(words, console=err, default=default, show_default=bool(default))
        try:
            return read(text.strip())
        except ArgumentTypeError as error:
            err.print(f"    {error}", markup=False)
        except MissionError as error:
            print_error(error)


def _without_lines(error: MissionError) -> MissionError:
    """The same without places in a file that nobody has."""
    if not isinstance(error, SpecError):
        return error
    return SpecError(tuple(replace(fault, line=0, column=0) for fault in error.faults), error.source)
