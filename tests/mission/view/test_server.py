"""The page's server over loopback: who is let in, what is answered, and that a flight never waits for a page."""

import asyncio
import http.client
import json
import socket
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any
from urllib.parse import urlsplit

import pytest
from tornado.httpclient import HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from mission.fly.requests import Request
from mission.fly.result import Progress
from mission.view import server as of_server
from mission.view.feed import Answer
from mission.view.replaying import planned
from mission.view.server import PageServer
from mission.view.show import Show
from tests.support.drawn_plans import PAPER_TOUR, plan_of

NAMED = "</script><img src=x onerror=alert(1)>"
PLAN = replace(plan_of(PAPER_TOUR), spec=replace(plan_of(PAPER_TOUR).spec, name=NAMED))
MOMENTS = [*planned(PLAN)][::100]


@pytest.fixture(scope="module")
def live() -> Iterator[PageServer]:
    with PageServer(PLAN, "live") as server:
        yield server


def asked(
    server: PageServer, method: str, name: str, *, token: str = "", body: bytes = b"", **headers: str
) -> tuple[int, str, dict[str, str]]:
    """The answer to a request as the page makes it, but for what is given; underscores in names stand for hyphens."""
    address = urlsplit(server.address)
    own = {"Origin": f"http://{address.netloc}", "X-Mission-Token": address.path.strip("/")} if method == "POST" else {}
    own |= {key.replace("_", "-"): value for key, value in headers.items()}
    line = http.client.HTTPConnection(address.hostname or "", address.port or 0, timeout=20)
    try:
        line.request(method, f"/{token or address.path.strip('/')}/{name}", body, {k: v for k, v in own.items() if v})
        reply = line.getresponse()
        return reply.status, reply.read().decode(), {key.lower(): value for key, value in reply.getheaders()}
    finally:
        line.close()


def wish(request: str) -> bytes:
    return json.dumps({"request": request}).encode()


def test_the_page_and_what_it_is_made_of_come_from_here_alone(live: PageServer) -> None:
    status, text, headers = asked(live, "GET", "")
    assert status == 200
    assert NAMED not in text
    assert "&lt;/script&gt;" in text
    policy = dict(part.strip().split(" ", 1) for part in headers["content-security-policy"].split(";"))
    assert (policy["default-src"], policy["script-src"], policy["frame-ancestors"]) == ("'none'", "'self'", "'none'")
    assert (headers["referrer-policy"], headers["x-content-type-options"]) == ("no-referrer", "nosniff")
    assert headers["cache-control"] == "no-store"
    for name, kind in (("page.js", "text/javascript"), ("page.css", "text/css"), ("bokeh.js", "text/javascript")):
        status, text, headers = asked(live, "GET", name)
        assert (status, headers["content-type"]) == (200, f"{kind}; charset=utf-8")
        assert len(text) > 1000
    told = json.loads(asked(live, "GET", "figures")[1])
    assert {"triangles", "fields of the run", "smoothed"} <= set(told["layers"])
    assert len(told["states"]) == PLAN.shown_automaton.size
    for number in ("2", "0", "-1", "x"):
        assert asked(live, "GET", f"figures?plan={number}")[0] == 404


def test_what_is_put_into_the_page_is_not_filled_in_itself() -> None:
    plan = replace(PLAN, spec=replace(PLAN.spec, name="{{buttons}} {{shown}}"))
    with PageServer(plan, "the flight of \udcff{{figures}}") as server:
        status, text, _ = asked(server, "GET", "")
    assert status == 200
    assert "<h1>{{buttons}} {{shown}}</h1>" in text
    assert 'data-shown="the flight of \\udcff{{figures}}"' in text
    assert text.count('id="buttons"') == 1


def test_it_listens_on_loopback_and_its_address_cannot_be_guessed(live: PageServer) -> None:
    address = urlsplit(live.address)
    assert address.hostname == "127.0.0.1"
    assert len(address.path.strip("/")) >= 43  # 256 bits
    with PageServer(PLAN, "another") as other:
        assert urlsplit(other.address).path != address.path


@pytest.mark.parametrize("name", ["", "page.js", "figures", "moments", "request", "nothing"])
def test_nothing_is_told_to_whoever_does_not_know_the_token(live: PageServer, name: str) -> None:
    status, text, _ = asked(live, "GET", name, token="guessed")  # noqa: S106 - that is no secret
    assert status == 403
    assert text == "this address is not known here\n"


@pytest.mark.parametrize(
    "headers",
    [
        {"X_Mission_Token": ""},
        {"X_Mission_Token": "guessed"},
        {"Origin": ""},
        {"Origin": "null"},
        {"Origin": "http://evil.example"},
        {"Origin": "http://localhost:1"},
        {"Host": "evil.example"},
        {"Host": "localhost"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
    ],
    ids=str,
)
def test_nothing_is_commanded_from_elsewhere(live: PageServer, headers: dict[str, str]) -> None:
    status, _, _ = asked(live, "POST", "request", body=wish("land"), **headers)
    assert status == 403
    assert live.feed.take() is None


@pytest.mark.parametrize("host", ["evil.example", "localhost", "127.0.0.1"])
def test_the_page_is_not_shown_under_another_name(live: PageServer, host: str) -> None:
    """A name of another site that was pointed here, which makes this that site's origin."""
    assert asked(live, "GET", "", Host=host)[0] == 403


@pytest.mark.parametrize(("method", "name"), [("GET", "request"), ("PUT", "request"), ("POST", ""), ("DELETE", "")])
def test_commands_are_posts_alone(live: PageServer, method: str, name: str) -> None:
    assert asked(live, method, name)[0] in {403, 405}
    assert live.feed.take() is None


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b'{"request": "explode"}', b'{"request": []}', b"[" * 3000])
def test_what_asks_for_nothing_that_can_be_done_is_refused(live: PageServer, body: bytes) -> None:
    status, text, _ = asked(live, "POST", "request", body=body)
    assert status == 400
    assert "Traceback" not in text
    assert live.feed.take() is None


def test_what_is_too_large_is_not_read(live: PageServer) -> None:
    status, _, _ = asked(live, "POST", "request", body=b" " * 5000 + wish("hold"))
    assert status in {400, 413}
    assert live.feed.take() is None


@pytest.mark.parametrize("begun", ["", "GET /", "POST /{token}/request HTTP/1.1\r\nContent-Length: 9\r\n{own}\r\n{{"])
def test_who_begins_to_ask_and_never_ends_is_cut_off(begun: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(of_server, "_ASKS_WITHIN_S", 0.05)
    with PageServer(PLAN, "live") as server:
        address = urlsplit(server.address)
        token = address.path.strip("/")
        own = f"Host: {address.netloc}\r\nOrigin: http://{address.netloc}\r\nX-Mission-Token: {token}\r\n"
        with socket.create_connection((address.hostname or "", address.port or 0), timeout=20) as line:
            line.sendall(begun.format(token=token, own=own).encode())
            assert line.recv(1) == b""
        assert server.feed.take() is None


def test_of_too_many_connections_the_last_are_closed_and_there_is_room_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(of_server, "_MOST_LINES", 2)
    with PageServer(PLAN, "live") as server:
        address = urlsplit(server.address)
        lines = [socket.create_connection((address.hostname or "", address.port or 0), timeout=20) for _ in range(3)]
        assert lines[2].recv(1) == b""
        lines[0].sendall(b"none\r\n\r\n")  # is no request: the server has closed the line once that is read
        while lines[0].recv(100):
            pass
        assert asked(server, "GET", "page.css")[0] == 200
        for line in lines:
            line.close()


def test_a_request_reaches_the_flight_once_and_of_too_many_the_last_are_refused(live: PageServer) -> None:
    assert asked(live, "POST", "request", body=wish("hold"))[0] == 202
    assert [live.feed.take(), live.feed.take()] == [Request.HOLD, None]
    statuses = [asked(live, "POST", "request", body=wish("land"))[0] for _ in range(10)]
    assert statuses == [202] * 8 + [503] * 2
    assert [live.feed.take() for _ in range(9)] == [Request.LAND] * 8 + [None]


def test_a_replay_shows_all_and_commands_nothing() -> None:
    with PageServer(PLAN, "the flight of then", MOMENTS) as server:
        assert 'data-live="no"' in asked(server, "GET", "")[1]
        assert "data-request" not in asked(server, "GET", "")[1]
        assert asked(server, "POST", "request", body=wish("land"))[0] == 403
        assert server.feed.take() is None
        [first] = heard(server, lambda messages: len(messages) == 1)
        assert first["fresh"]
        assert len(first["moments"]) == len(MOMENTS)
        assert first["moments"][0]["doing"].endswith("on the way to S1")
        assert set(first["moments"][1]) < set(first["moments"][0])  # later ones tell what has changed


def heard(server: PageServer, enough: Callable[[list[dict[str, Any]]], bool]) -> list[dict[str, Any]]:
    """What a page is told until that is enough, or the line is closed."""

    async def listen() -> list[dict[str, Any]]:
        line, messages = await connected(server), list[dict[str, Any]]()
        while not enough(messages) and (message := await line.read_message()) is not None:
            messages.append(json.loads(message))
        await closed(line)
        return messages

    return asyncio.run(asyncio.wait_for(listen(), 20))


async def closed(line: WebSocketClientConnection) -> None:
    line.close()
    while await line.read_message() is not None:
        pass


async def connected(server: PageServer) -> WebSocketClientConnection:
    address = urlsplit(server.address)
    headers = {"Origin": f"http://{address.netloc}"}
    return await websocket_connect(HTTPRequest(f"ws://{address.netloc}{address.path}moments", headers=headers))


def test_late_pages_are_told_what_was_and_all_are_told_what_comes(live: PageServer) -> None:
    live.feed.show(replace(MOMENTS[0], told=("taking off to the north",)))
    first = heard(live, lambda messages: any(each["news"] for each in messages))
    live.feed.show(MOMENTS[1])
    live.feed.answer(Request.HOLD, "the vehicle holds", granted=True)
    told = heard(live, lambda messages: any(each["answers"] for each in messages))
    for messages in (first, told):
        assert messages[0]["fresh"]
        assert "taking off to the north" in [words for each in messages for _, words in each["news"]]
    times = [each["t"] for message in told for each in message["moments"] if "t" in each]
    assert times == [round(moment.t_s or 0.0, 2) for moment in MOMENTS[:2]]
    assert [each for message in told for each in message["answers"]] == ["hold: the vehicle holds"]


def test_another_origin_is_told_nothing(live: PageServer) -> None:
    upgrade = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec_WebSocket_Version": "13",
        "Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ==",
    }
    for origin in ("http://evil.example", "null", ""):
        assert asked(live, "GET", "moments", body=b"", **upgrade, Origin=origin)[0] == 403


def test_pages_that_hang_and_twenty_that_are_open_do_not_hold_the_flight_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """The flight's part is done while the server's thread is kept from everything."""
    busy, free = threading.Event(), threading.Event()

    class Stuck(Show):
        def add(self, moments: Iterable[Progress], answers: Sequence[Answer] = (), *, all_of_them: bool = False) -> str:
            if not all_of_them:
                busy.set()
                free.wait(20)
            return super().add(moments, answers, all_of_them=all_of_them)

    monkeypatch.setattr(of_server, "Show", Stuck)
    with PageServer(PLAN, "live") as server:
        address = urlsplit(server.address)
        pages = [socket.create_connection((address.hostname or "", address.port or 0)) for _ in range(20)]
        server.feed.show(MOMENTS[0])
        assert busy.wait(20)
        for _ in range(5000):  # no call of the flight waits for what the server cannot do now
            server.feed.show(MOMENTS[1])
            assert server.feed.take() is None
            server.feed.answer(Request.HOLD, "no", granted=False)
        assert len(server.feed.moments()) == 256  # the newest are kept
        free.set()
        for page in pages:
            page.close()


def test_a_page_that_reads_nothing_is_told_again_once_it_does() -> None:
    """Nothing is kept for it meanwhile."""
    sent: list[str] = []

    async def read_late() -> None:
        arrives: asyncio.Future[None] = asyncio.get_running_loop().create_future()

        def write(message: str) -> asyncio.Future[None]:
            sent.append(message)
            return arrives

        page = object.__new__(of_server._Moments)
        vars(page).update(
            _sent=None,
            _behind=False,
            _all_so_far=lambda: "all so far",
            write_message=write,
        )
        for message in ("first", "second", "third"):
            page.push(message)
        arrives.set_result(None)
        page.push("fourth")
        page.push("fifth")

    asyncio.run(read_late())
    assert sent == ["first", "all so far", "fifth"]


def test_at_the_end_pages_are_told_how_it_ended() -> None:
    def over(server: PageServer) -> None:
        server.feed.show(MOMENTS[1])
        server.say_at_the_end("the flight is over: ACHIEVED")
        server.__exit__(None, None, None)

    async def listen(server: PageServer) -> list[dict[str, Any]]:
        line = await connected(server)
        messages = [json.loads(str(await line.read_message()))]
        await asyncio.get_running_loop().run_in_executor(None, over, server)
        while (message := await line.read_message()) is not None:
            messages.append(json.loads(message))
        line.close()
        return messages

    server = PageServer(PLAN, "live").__enter__()
    messages = asyncio.run(asyncio.wait_for(listen(server), 20))
    assert messages[-1] == {"over": "the flight is over: ACHIEVED"}
    assert any(message["moments"] for message in messages[:-1])
