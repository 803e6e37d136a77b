"""``mission view``: a page with a flight that is over, moment by moment, or with a plan as if it were flown."""

import sys
import threading
import webbrowser
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mission.cli.busy import doing
from mission.cli.inputs import is_plan, planned, read_plan
from mission.cli.report import flight_in
from mission.cli.screen import err
from mission.plan import FlightPlan
from mission.view.replaying import planned as as_planned
from mission.view.replaying import recorded
from mission.view.server import PageServer


def run(arguments: Namespace) -> int:
    """Show it until Ctrl-C."""
    with doing("drawing the page"):
        server = _server(Path(arguments.shown))
    with server, suppress(KeyboardInterrupt):
        _tell(server, opens=arguments.open)
        err.print("Ctrl-C ends it", markup=False)
        _wait()
    return 0


@contextmanager
def live(plan: FlightPlan, *, opens: bool) -> Iterator[PageServer]:
    """The page of a flight that is about to begin, while this is entered."""
    with doing("drawing the page"):
        server = PageServer(plan, "live: the flight as it is flown")
    with server:
        _tell(server, opens=opens)
        yield server


def _wait() -> None:
    threading.Event().wait()


def _tell(server: PageServer, *, opens: bool) -> None:
    """Say where the page is; open it if that is wanted."""
    sys.stderr.write(f"the page is {server.address}\n")  # however little is to be said
    if opens:
        webbrowser.open(server.address)


def _server(shown: Path) -> PageServer:
    if shown.is_dir():
        plan, record, _ = flight_in(shown)
        return PageServer(plan, f"the flight of {shown.resolve().name}", recorded(plan, record))
    plan = read_plan(shown)[0] if is_plan(shown) else planned(str(shown))
    return PageServer(plan, "the plan, as if it were flown exactly", as_planned(plan))
