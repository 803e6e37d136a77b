"""``mission import``: a mission file from what other programs have drawn."""

from argparse import Namespace
from pathlib import Path

from mission.cli.busy import doing
from mission.cli.extent import extent
from mission.cli.inputs import bad_file, unwritable, write_named
from mission.cli.screen import out, print_error, print_warnings
from mission.decimals import count
from mission.draft.trials import Trial, draft_that_plans
from mission.errors import Fault, SpecError, reason
from mission.interchange.features import Drawing
from mission.interchange.reading import MAX_BYTES, read_drawing
from mission.printable import printable


def run(arguments: Namespace) -> int:
    """Read all files, and write or print one mission; where that has no plan, the exit code says so."""
    target = None if arguments.out is None else free(Path(arguments.out), force=arguments.force)
    in_metres = True if arguments.metres else None
    drawings = [(Path(file).stem, drawing_in(Path(file), in_metres=in_metres)) for file in arguments.files]
    with doing("drafting and planning"):
        trial = draft_that_plans(drawings, " and ".join(file for file, _ in drawings))
    text = trial.draft.text
    if target is None:
        out.out(text, end="", highlight=False)
    else:
        write_named("--out", target, text)
        tell(trial, target)
    print_warnings(trial.draft.remarks)
    if trial.error is None:
        return 0
    print_warnings(("the mission does not plan as it is; its first lines say so, too",), source=arguments.out or "")
    print_error(trial.error, source=arguments.out or "")
    return trial.error.exit_code


def free(target: Path, *, force: bool) -> Path:
    """The name of a file that is to be written.

    Raises:
        SpecError: There is one already, which is not to be written over, or no file can have that name.
    """
    there = True
    try:
        target.lstat()
    except FileNotFoundError:
        there = False
    except (OSError, ValueError) as error:  # too long, or with a character that no name has
        raise unwritable("--out", target, error) from error
    if not target.parent.is_dir():
        raise SpecError((Fault(0, 0, "--out", f"there is no folder {target.parent}", "make it, or name another"),))
    if there and not force:
        hint = "choose another name, or say --force to write over it"
        raise SpecError((Fault(0, 0, "--out", f"{target} is there already", hint),))
    return target


def tell(trial: Trial, target: Path) -> None:
    """Say what was written, and whether it plans."""
    asked = sum(line.lstrip().startswith("#") and "?" in line for line in trial.draft.text.splitlines())
    questions = f"{count(asked, 'question')} in it, as comments" if asked else "written, with no question open"
    out.out(f"{printable(str(target))}: {questions}", highlight=False)
    if trial.plan is not None:
        out.out(f"    it plans as it is: {extent(trial.plan, 1)}, proved", highlight=False)


def drawing_in(file: Path, *, in_metres: bool | None = None) -> Drawing:
    """What a file of another program draws (``read_drawing``).

    Raises:
        SpecError: It cannot be read, or draws nothing that is known.
    """
    try:
        with file.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = reason(error) if isinstance(error, OSError) else str(error)
        raise bad_file(file, f"cannot be read: {why}", "check the path") from error
    return read_drawing(content, str(file), in_metres=in_metres)
