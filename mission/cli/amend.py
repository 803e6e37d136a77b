"""``mission amend``: hand changes of its mission to a flight that another process flies."""

import sys
import time
from argparse import Namespace
from collections.abc import Iterator
from io import TextIOWrapper
from pathlib import Path
from typing import Final

from mission.cli.inputs import bad_file
from mission.cli.screen import err, out
from mission.errors import LinkError, reason
from mission.fly.amendments import answer_to, hand_in, withdraw
from mission.report.record import RECORD_FILE, is_written
from mission.spec.yaml_tree import MAX_BYTES

_HINT: Final = "name the folder that `mission fly` says at its beginning, such as flights/survey-20250131-120000"
_LOOK_S: Final = 0.01
_SLOWER: Final = 1.1
"""So much later than the last time the answer is looked for: many who wait must not keep a flight from answering."""
_SLOWEST_S: Final = 0.2
_STDIN: Final = "-"


def run(arguments: Namespace) -> int:
    """Hand in a mission file, or the lines of standard input, each as it comes; 0 where all was accepted."""
    folder = Path(arguments.folder)
    if not (folder / RECORD_FILE).is_file():
        raise bad_file(folder, "this is not the folder of a flight", _HINT)
    accepted = [_handed_in(folder, request, arguments.within) for request in _requests(arguments.file)]
    return 0 if all(accepted) else 1


def _requests(file: str) -> Iterator[dict[str, object]]:
    if file != _STDIN:
        try:
            content = Path(file).read_bytes()[: MAX_BYTES + 1]
        except OSError as error:
            raise bad_file(Path(file), f"cannot be read: {reason(error)}", "name a mission file") from error
        yield {"mission": content.decode("utf-8-sig", "replace")}
        return
    if isinstance(sys.stdin, TextIOWrapper):
        sys.stdin.reconfigure(errors="replace")
    for line in sys.stdin:
        if line.strip() and not line.lstrip().startswith("#"):
            yield {"lines": [line.strip()]}


def _handed_in(folder: Path, request: dict[str, object], within_s: float) -> bool:
    """Hand in one request, and say what came of it.

    Raises:
        LinkError: Nothing came of it in time, or nobody flies there.
    """
    began_s = time.monotonic()
    try:
        name = hand_in(folder, **request)  # type: ignore[arg-type]
    except OSError as error:
        raise bad_file(folder, f"cannot be written to: {reason(error)}", "make the folder writable") from error
    answer, flown, pause_s = None, is_written(folder), _LOOK_S
    try:
        while (answer := answer_to(folder, name)) is None and flown and time.monotonic() - began_s <= within_s:
            time.sleep(pause_s)
            pause_s = min(_SLOWER * pause_s, _SLOWEST_S)
            flown = is_written(folder)
    finally:
        if answer is None:
            withdraw(folder, name)
    if answer is None and not flown:
        raise LinkError(f"no program flies {folder}: its flight is over, or was left for `mission fly --resume`")
    if answer is None:
        raise LinkError(f"no flight answered within {within_s:g} s: is the one of {folder} over?")
    (out if answer.accepted else err).print(
        f"{'accepted' if answer.accepted else 'refused'}  {answer.words}", markup=False
    )
    return answer.accepted
