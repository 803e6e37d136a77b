"""How much commands say, and in which form."""

import argparse


def add_voice(command: argparse.ArgumentParser, more: str, document: str = "") -> None:
    """Add the options: less, more, or one JSON document.

    Args:
        command: What is said by.
        more: What more it says where that is asked for.
        document: The keys of the document, beside ``exit_code``; none is offered where this is empty.
    """
    group = command.add_argument_group("what is said")
    loudness = group.add_mutually_exclusive_group()
    loudness.add_argument("-q", "--quiet", action="store_true", help="only what is wrong; the exit code tells the rest")
    loudness.add_argument("-v", "--verbose", action="store_true", help=f"also {more}")
    if document:
        command.set_defaults(document=True)  # of a failure, too
        group.add_argument(
            "--json",
            action="store_true",
            help=f"print one JSON document instead of lines; its keys: exit_code, {document}; "
            "error and faults where the command fails",
        )
