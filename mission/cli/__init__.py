"""The program ``mission``: the commands, and the only place of the planner that prints.

Exit codes: 0 achieved, 1 flown but not achieved, 2 bad input, 3 no plan exists, 4 link or vehicle failure; 130 after
Ctrl-C, 143 after SIGTERM, 129 after SIGHUP, and 141 where the reader of a pipe, such as ``head``, went away, as is the
custom. A flight is told by what came of it, whoever reads that.
Whatever takes time to import is imported once the signals are watched, or when it is asked for, so that neither
``mission --help`` waits nor an early Ctrl-C shows a traceback.
"""

import sys
from collections.abc import Sequence
from contextlib import suppress

from mission.cli.busy import doing
from mission.cli.signals import EndingSignals
from mission.cli.streams import output_failure, take_streams

BAD_INPUT = 2
INTERRUPTED = 130
READER_GONE = 141


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Args:
        argv: The arguments. By default those of the process, which then is to end with that code: its standard streams
            are taken over.

    Raises:
        SystemExit: The arguments ask for no command, or for none that there is.
    """
    with EndingSignals(for_good=argv is None) as signals:
        try:
            if argv is None:
                take_streams()
            code = _run(sys.argv[1:] if argv is None else argv)
            sys.stdout.flush()
        except SystemExit:
            with suppress(OSError):
                sys.stdout.flush()
            failure = output_failure()
            if failure is None:
                raise
            code = _told(failure)
        except OSError as error:
            code = _told(error)
        except KeyboardInterrupt:
            # What flies takes signals for itself, and has said what was interrupted.
            code = signals.exit_code or INTERRUPTED
        except BaseException:
            # An interruption of an import may come out as something else.
            if not signals.exit_code:
                raise
            code = signals.exit_code
        return signals.exit_code or code


def _run(arguments: Sequence[str]) -> int:
    import shlex  # noqa: PLC0415 - see above
    from importlib import import_module  # noqa: PLC0415 - see above

    from mission.cli.arguments import build_parser, with_negative_pairs  # noqa: PLC0415
    from mission.errors import MissionError, NoPlanError  # noqa: PLC0415

    parser = build_parser()
    options = parser.parse_args(with_negative_pairs(arguments))
    options.command_line = shlex.join(["mission", *arguments])
    if options.command is None:
        parser.print_help(sys.stderr)
        return BAD_INPUT
    try:
        name = getattr(options, "module", options.command)  # a keyword of Python cannot name one
        with doing("loading"):
            command = import_module(f"mission.cli.{name}")
            from mission.cli.screen import speak  # noqa: PLC0415 - the terminal library is loaded when it is needed
        speak(options)
        return int(command.run(options))
    except MissionError as error:
        from mission.cli.mission_input import shown  # noqa: PLC0415 - see above
        from mission.cli.screen import error_values, print_error, print_json  # noqa: PLC0415 - see above

        if getattr(options, "document", False) and options.json:
            print_json(error_values(error))
        # A refusal to plan is about the mission file; a failure of the link is not.
        print_error(error, shown(getattr(options, "file", None) or "") if isinstance(error, NoPlanError) else "")
        return error.exit_code
    except OSError as error:
        if getattr(options, "document", False) and options.json and not isinstance(error, BrokenPipeError):
            from mission.cli.screen import print_json  # noqa: PLC0415 - see above

            print_json({"exit_code": BAD_INPUT, "error": _words(error), "faults": []})
        raise


def _told(error: OSError) -> int:
    """Say what the system refused, unless it is that nobody reads; the exit code."""
    if isinstance(error, BrokenPipeError):
        return READER_GONE
    from mission.printable import printable  # noqa: PLC0415 - see above

    print(printable(f"error: {_words(error)}"), file=sys.stderr)  # noqa: T201 - the program's voice, when its terminal library has failed
    return BAD_INPUT


def _words(error: OSError) -> str:
    return f"{error.strerror or error}{f': {error.filename}' if error.filename else ''}"
