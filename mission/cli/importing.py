"""``mission import``: a mission file from what other programs have drawn."""

from argparse import Namespace
from pathlib import Path

from mission.cli.inputs import bad_file, write_named
from mission.cli.screen import count, out, print_warnings
from mission.draft.drafting import draft_mission
from mission.errors import Fault, SpecError, reason
from mission.interchange.features import Drawing
from mission.interchange.reading import MAX_BYTES, read_drawing
from mission.printable import printable
from mission.spec.loader import parse_mission


def run(arguments: Namespace) -> int:
    """Read all files, and write or print one mission."""
    in_metres = True if arguments.metres else None
    drawings = [(Path(file).stem, _drawing(Path(file), in_metres=in_metres)) for file in arguments.files]
    text = draft_mission(drawings, " and ".join(file for file, _ in drawings))
    remarks = tuple(remark for _, drawing in drawings for remark in drawing.remarks)
    if arguments.out is None:
        out.out(text, end="", highlight=False)
        print_warnings(remarks)
    else:
        target = Path(arguments.out)
        if target.exists() and not arguments.force:
            hint = "choose another name, or say --force to write over it"
            raise SpecError((Fault(0, 0, "--out", f"{target} is there already", hint),))
        write_named("--out", target, text)
        asked = sum(line.lstrip().startswith("#") and "?" in line for line in text.splitlines())
        out.out(f"{printable(str(target))}: {count(asked, 'question')} in it, as comments", highlight=False)
        print_warnings(remarks)
    parse_mission(text.encode(), arguments.out or "")
    return 0


def _drawing(file: Path, *, in_metres: bool | None) -> Drawing:
    try:
        with file.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = reason(error) if isinstance(error, OSError) else str(error)
        raise bad_file(file, f"cannot be read: {why}", "check the path") from error
    return read_drawing(content, str(file), in_metres=in_metres)
