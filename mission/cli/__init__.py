"""The program ``mission``: the commands, and the only place of the planner that prints.

Exit codes: 0 achieved, 1 flown but not achieved, 2 bad input, 3 no plan exists, 4 link or vehicle failure; 130 after
Ctrl-C and 141 where the reader of a pipe, such as ``head``, went away, as is the custom.
Commands are imported when they are asked for, so that ``mission --help`` stays quick.
"""

import importlib
import io
import os
import sys
from collections.abc import Sequence

from mission.cli.arguments import build_parser, with_negative_wind
from mission.errors import MissionError, NoPlanError

BAD_INPUT = 2
INTERRUPTED = 130
READER_GONE = 141


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; ``argv`` defaults to the program's own arguments."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal without, say, an umlaut gets a question mark instead of an exception.
            stream.reconfigure(errors="replace")
    parser = build_parser()
    arguments = parser.parse_args(with_negative_wind(sys.argv[1:] if argv is None else argv))
    if arguments.command is None:
        parser.print_help(sys.stderr)
        return BAD_INPUT
    try:
        command = importlib.import_module(f"mission.cli.{arguments.command}")
        code = int(command.run(arguments))
        sys.stdout.flush()
    except MissionError as error:
        from mission.cli.screen import print_error  # noqa: PLC0415 - the terminal library is loaded when it is needed

        # A refusal to plan is about the mission file; a failure of the link is not.
        print_error(error, getattr(arguments, "file", "") if isinstance(error, NoPlanError) else "")
        return error.exit_code
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        _silence(sys.stdout)
        return READER_GONE
    except OSError as error:
        _silence(sys.stdout)
        print(f"error: {error.strerror or error}{f': {error.filename}' if error.filename else ''}", file=sys.stderr)  # noqa: T201 - the program's voice, when its terminal library has failed
        return BAD_INPUT
    return code


def _silence(stream: object) -> None:
    """Let what is still buffered go nowhere, so that the interpreter's last flush does not fail once more."""
    if isinstance(stream, io.TextIOWrapper):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
