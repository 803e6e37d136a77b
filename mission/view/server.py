"""The page's server: on loopback, in a thread of its own, beside the flight and never in its way."""

import asyncio
import json
import logging
import threading
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from types import TracebackType
from typing import Any, ClassVar, Final, Self
from weakref import WeakSet

from bokeh.resources import Resources
from tornado.httpserver import HTTPServer
from tornado.ioloop import PeriodicCallback
from tornado.iostream import IOStream
from tornado.netutil import bind_sockets
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from mission.fly.requests import Request
from mission.fly.result import Progress
from mission.plan import FlightPlan
from mission.report.interactive.embedding import moving_script
from mission.view.drawing import figures
from mission.view.feed import Feed
from mission.view.guard import Guard
from mission.view.page import asset, page
from mission.view.show import Show

_EVERY_MS: Final = 100.0
_MOST_BYTES: Final = 4096
_MOST_PAGES: Final = 32
_MOST_DRAWN: Final = 4
_LEAVES_WITHIN_S: Final = 2.0
_MOST_LINES: Final = 128
"""So many connections there are at once: a flight needs files, too, of which a program may have few."""
_ASKS_WITHIN_S: Final = 20.0
"""Whoever has not asked by then is cut off: connections that are begun and left would take all that there can be."""
_KINDS: Final[Mapping[str, str]] = {"js": "text/javascript", "css": "text/css"}


class PageServer:
    """Shows one plan's flight to whoever has the address.

    Attributes:
        address: Of the page, with its secret; say it to nobody else.
        feed: What passes between the page and a flight that is under way.
    """

    def __init__(self, plan: FlightPlan, shown: str, moments: Iterable[Progress] | None = None) -> None:
        """Take a port of loopback.

        Args:
            plan: What is flown at first.
            shown: What the page shows, in plain words.
            moments: Those of a flight that is over, of which nothing can be asked; None for one that is to come.

        Raises:
            OSError: There is no port.
        """
        self.feed, self._show = Feed(), Show(plan)
        self._shown, self._live = shown, moments is None
        self._show.add(moments or (), all_of_them=True)
        self._sockets = bind_sockets(0, "127.0.0.1")
        self._guard = Guard(self._sockets[0].getsockname()[1])
        self._drawn = {1: _json(figures(plan))}
        self._pages: set[_Moments] = set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._over = asyncio.Event()
        self._last_words = "the program that showed this has ended"
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._run, name="page", daemon=True)
        self.address = self._guard.address

    def __enter__(self) -> Self:
        self._thread.start()
        self._ready.wait()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._loop is not None:
            with suppress(RuntimeError):  # it has ended by itself
                self._loop.call_soon_threadsafe(self._over.set)
        self._thread.join(_LEAVES_WITHIN_S)

    def say_at_the_end(self, words: str) -> None:
        """Let pages be told this when the server ends."""
        self._last_words = words

    # What runs in the thread.

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        finally:
            self._ready.set()

    async def _serve(self) -> None:
        # What browsers do wrong is answered to them, and nobody's terminal is written over.
        logging.getLogger("tornado").addHandler(logging.NullHandler())
        logging.getLogger("tornado").propagate = False
        self._loop = asyncio.get_running_loop()
        server = _FewLines(
            self._application(),
            max_body_size=_MOST_BYTES,
            max_header_size=4 * _MOST_BYTES,
            idle_connection_timeout=_ASKS_WITHIN_S,
            body_timeout=_ASKS_WITHIN_S,
        )
        server.add_sockets(self._sockets)
        pushing = PeriodicCallback(self._push, _EVERY_MS)
        pushing.start()
        self._ready.set()
        await self._over.wait()
        pushing.stop()
        self._push()
        for each in list(self._pages):
            each.send(_json({"over": self._last_words}))
            each.close()
        server.stop()
        with suppress(TimeoutError):  # of pages that hang
            await asyncio.wait_for(server.close_all_connections(), _LEAVES_WITHIN_S / 2)

    def _application(self) -> Application:
        about = {"guard": self._guard}
        texts: dict[str, Callable[[], str]] = {
            "": lambda: page(self._show.narrator.plans[0], self._shown, live=self._live),
            "moving.js": moving_script,
            "page.js": lambda: asset("page.js"),
            "page.css": lambda: asset("page.css"),
            "bokeh.js": lambda: "\n".join(Resources(mode="inline", components=["bokeh"]).js_raw),
        }
        routes: list[Any] = [
            (r"/([^/]+)/(|moving\.js|page\.js|page\.css|bokeh\.js)", _Text, about | {"texts": texts}),
            (r"/([^/]+)/figures", _Figures, about | {"drawn": self._figures}),
            (r"/([^/]+)/moments", _Moments, about | {"pages": self._pages, "all_so_far": lambda: self._show.all}),
        ]
        if self._live:
            routes.append((r"/([^/]+)/request", _Command, about | {"feed": self.feed}))
        return Application(
            routes,
            default_handler_class=_Unknown,
            default_handler_args=about,
            log_function=lambda _: None,
            websocket_max_message_size=_MOST_BYTES,
        )

    def _figures(self, number: int) -> str:
        """Of a plan that was flown, numbered from 1; those that were drawn last are kept.

        Raises:
            IndexError: There is none of this number.
        """
        if number not in self._drawn:
            plan = dict(enumerate(self._show.narrator.plans, 1)).get(number)
            if plan is None:
                raise IndexError(number)
            self._drawn = dict([*self._drawn.items()][1 - _MOST_DRAWN :]) | {number: _json(figures(plan))}
        return self._drawn[number]

    def _push(self) -> None:
        """Tell all pages what has come up."""
        if message := self._show.add(self.feed.moments(), self.feed.answers()):
            for each in list(self._pages):
                each.push(message)


class _FewLines(HTTPServer):
    """Closes connections beyond so many at once."""

    def initialize(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - the library's own
        super().initialize(*arguments, **options)
        self._lines: WeakSet[IOStream] = WeakSet()

    def handle_stream(self, stream: IOStream, address: tuple[Any, ...]) -> None:
        if sum(not line.closed() for line in self._lines) >= _MOST_LINES:
            stream.close()
            return
        self._lines.add(stream)
        super().handle_stream(stream, address)


class _Guarded(RequestHandler):
    """Answers only those that the guard lets in."""

    commands: ClassVar[bool] = False
    sends_origin: ClassVar[bool] = False

    def initialize(self, guard: Guard) -> None:
        self.guard = guard

    def set_default_headers(self) -> None:
        self.clear_header("Server")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("X-Frame-Options", "DENY")
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.set_header("Cross-Origin-Opener-Policy", "same-origin")
        self.set_header("Cache-Control", "no-store")

    def prepare(self) -> None:
        self.set_header("Content-Security-Policy", self.guard.policy)
        token = self.path_args[0] if self.path_args else ""
        why = self.guard.refusal(token, self.request.headers, commands=self.commands, sends_origin=self.sends_origin)
        if why:
            self.set_status(403)
            self.finish(f"{why}\n")

    def write_error(self, status_code: int, **_: object) -> None:
        """No traceback, and no page of the library's."""
        self.finish(f"{status_code}: {self._reason}\n")


class _Unknown(_Guarded):
    """What nothing here is called."""

    def prepare(self) -> None:
        self.set_status(403)
        self.finish("this address is not known here\n")


class _Text(_Guarded):
    """The page and what it is made of."""

    def initialize(self, guard: Guard, texts: Mapping[str, Callable[[], str]]) -> None:  # type: ignore[override]
        super().initialize(guard)
        self._texts = texts

    def get(self, _token: str, name: str) -> None:
        kind = _KINDS.get(name.rpartition(".")[2], "text/html")
        self.set_header("Content-Type", f"{kind}; charset=utf-8")
        self.finish(self._texts[name]())


class _Figures(_Guarded):
    """The figures of one plan."""

    def initialize(self, guard: Guard, drawn: Callable[[int], str]) -> None:  # type: ignore[override]
        super().initialize(guard)
        self._drawn = drawn

    def get(self, _token: str) -> None:
        try:
            text = self._drawn(int(self.get_query_argument("plan", "1")))
        except (ValueError, IndexError) as error:
            raise HTTPError(404, reason="there is no such plan") from error
        self.set_header("Content-Type", "application/json; charset=utf-8")
        self.finish(text)


class _Command(_Guarded):
    """What is asked of the flight."""

    commands, sends_origin = True, True

    def initialize(self, guard: Guard, feed: Feed) -> None:  # type: ignore[override]
        super().initialize(guard)
        self._feed = feed

    def post(self, _token: str) -> None:
        try:
            request = Request(json.loads(self.request.body)["request"])
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise HTTPError(400, reason="this asks for nothing that a flight can do") from error
        if not self._feed.ask(request):
            raise HTTPError(503, reason="too much that was asked for waits already")
        self.set_status(202)
        self.finish()


class _Moments(_Guarded, WebSocketHandler):
    """One page's line. A page that does not read is told nothing until it does, and then all at once."""

    sends_origin = True

    def initialize(  # type: ignore[override]
        self, guard: Guard, pages: "set[_Moments]", all_so_far: Callable[[], str]
    ) -> None:
        super().initialize(guard)
        self._pages, self._all_so_far = pages, all_so_far
        self._sent: asyncio.Future[None] | None = None
        self._behind = False

    def open(self, *_: str) -> None:
        if len(self._pages) >= _MOST_PAGES:
            self.close(reason="too many pages are open")
            return
        self._pages.add(self)
        self.send(self._all_so_far())

    def on_message(self, _message: str | bytes) -> None:
        """Nothing is asked for here."""

    def on_close(self) -> None:
        self._pages.discard(self)

    def push(self, message: str) -> None:
        """Send something, unless what was sent before is still on its way."""
        if self._sent is not None and not self._sent.done():
            self._behind = True
        elif self._behind:
            self._behind = False
            self.send(self._all_so_far())
        else:
            self.send(message)

    def send(self, message: str) -> None:
        """Send something, whatever is on its way."""
        try:
            self._sent = asyncio.ensure_future(self.write_message(message))
        except WebSocketClosedError:
            self._pages.discard(self)
            return
        self._sent.add_done_callback(lambda sent: sent.cancelled() or sent.exception())


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False, separators=(",", ":"))
