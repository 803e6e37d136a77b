"""The report as a person uses it, in headless Chromium: what is seen, pointed at, clicked and typed."""

import io
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageColor
from selenium.webdriver import Chrome
from selenium.webdriver.common.keys import Keys

from mission.report.palette import FLOWN
from mission.report.reading import parse_record
from mission.report.report import write_report
from tests.support.chromium import chromium, logged, sized, wait
from tests.support.drawn_plans import PAPER_TOUR, flight_of, plan_of
from tests.support.drifting_plans import drifting_plan, drifting_record

EVIL = "</script><img src=x onerror=document.title='hacked'>"
PLACE = """
const [name, x, y] = arguments;
const view = Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name(name));
view.el.scrollIntoView({block: "center"});
const box = view.canvas_view.el.getBoundingClientRect();
return [box.x + view.frame.x_scale.compute(x), box.y + view.frame.y_scale.compute(y)].map(Math.round);
"""
"""Where a point of a plot is in the window."""
TOLD = "at.dispatchEvent(new Event('input'))"
CURSOR = "const {t, x, y} = Bokeh.documents[0].get_model_by_name('cursor').data; return [t[0], x[0], y[0]];"


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chrome]:
    """One Chromium for all tests, with a profile of its own and nothing that calls home."""
    yield from chromium(tmp_path_factory.mktemp("profile"))


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a flight of the paper's mission, the name of which is a trap."""
    plan = plan_of(PAPER_TOUR)
    plan = replace(plan, spec=replace(plan.spec, name=EVIL))
    folder = tmp_path_factory.mktemp("flight")
    header, *lines = flight_of(plan)[0].splitlines(keepends=True)
    stage = b'{"kind":"event","t_s":1.5,"name":"stage","stage":"flying"}\n'
    write_report(plan, parse_record(b"".join([header, stage, *lines])), folder, pictures=False)
    return folder / "report.html"


@pytest.fixture
def page(browser: Chrome, report: Path) -> Chrome:
    """The report, opened afresh in a window of a desk's size."""
    sized(browser, 1200)
    browser.get(report.as_uri())
    wait(browser, "return document.getElementById('flight').dataset.ready === 'yes'")
    return browser


def point(page: Chrome, plot: str, x: float, y: float, *, click: bool = False) -> list[float]:
    """Move the mouse to a point of a plot; what is shown then: time and place."""
    for kind in ("mouseMoved", *(("mousePressed", "mouseReleased") if click else ())):
        at_x, at_y = page.execute_script(PLACE, plot, x, y)
        button = {"button": "left", "clickCount": 1} if click and kind != "mouseMoved" else {}
        page.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": at_x, "y": at_y, **button})
    page.execute_async_script("requestAnimationFrame(() => setTimeout(arguments[0]))")
    shown: list[float] = page.execute_script(CURSOR)
    return shown


def words(page: Chrome) -> str:
    return str(page.execute_script("return document.querySelector('#flight output').textContent"))


def share_of(png: bytes, colour: str) -> float:
    """How much of a picture has a colour, or nearly."""
    seen = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=np.int64)
    return float((np.abs(seen - ImageColor.getrgb(colour)).max(axis=2) < 24).mean())


def test_it_opens_without_a_fault_and_asks_nothing_of_the_network(page: Chrome, report: Path) -> None:
    assert page.title == f"{EVIL}: flight"
    assert page.find_element("css selector", "h1").text == EVIL
    assert page.find_element("css selector", ".verdict").text.startswith("The specification was achieved.")
    assert [entry for entry in logged(page, "browser") if entry["level"] == "SEVERE"] == []
    asked = [json.loads(entry["message"])["message"] for entry in logged(page, "performance")]
    requests = [each["params"] for each in asked if each["method"] == "Network.requestWillBeSent"]
    urls = [each["request"]["url"] for each in requests if each["documentURL"] == report.as_uri()]
    assert report.as_uri() in urls
    assert [url for url in urls if not url.startswith(("file:", "data:", "blob:"))] == []


def test_the_map_shows_the_flown_path_until_it_is_switched_off(page: Chrome) -> None:
    plot, box = (page.find_element("css selector", name) for name in ("#map", "input[data-layer^=flown]"))
    before = share_of(plot.screenshot_as_png, FLOWN)
    box.click()
    page.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
    after = share_of(plot.screenshot_as_png, FLOWN)
    assert before > 1e-3
    assert after < 0.3 * before


def test_what_is_pointed_at_over_time_is_shown_on_the_map_and_in_words(page: Chrome) -> None:
    plan = plan_of(PAPER_TOUR)
    middle_s = 0.5 * plan.trajectory.duration_s
    t_s, x, y = point(page, "history 2", 12.0 + middle_s, 0.0)
    assert t_s == pytest.approx(12.0 + middle_s, abs=0.01 * plan.trajectory.duration_s)
    (there,), _, _ = plan.trajectory.state(np.array([t_s - 12.0]))
    assert (x, y) == pytest.approx(tuple(there), abs=plan.certificate.tube_m)
    assert words(page).startswith(f"{t_s:.1f} s")
    assert "speed over ground:" in words(page)


def test_what_is_pointed_at_on_the_map_is_shown_over_time(page: Chrome) -> None:
    plan = plan_of(PAPER_TOUR)
    (there,), _, _ = plan.trajectory.state(np.array([0.3 * plan.trajectory.duration_s]))
    t_s, x, y = point(page, "map", *there.tolist(), click=True)
    assert (x, y) == pytest.approx(tuple(there), abs=0.3)
    assert str(page.find_element("id", "moment").get_attribute("aria-valuetext")).startswith(f"{t_s:.1f} s")
    far = point(page, "map", 14.9, 0.1)
    assert far == [t_s, x, y]  # nothing was flown there


def test_keys_and_times_of_the_tables_move_through_the_flight(page: Chrome) -> None:
    slider = page.find_element("id", "moment")
    last = words(page)
    slider.send_keys(Keys.HOME)
    assert words(page) != last
    first_s = page.execute_script(CURSOR)[0]
    slider.send_keys(Keys.ARROW_RIGHT)
    assert page.execute_script(CURSOR)[0] > first_s
    moment = page.find_elements("css selector", "details[open] .moment")[1]
    moment.send_keys(Keys.ENTER)
    assert page.execute_script(CURSOR)[0] == pytest.approx(float(moment.text), abs=5.0)


def test_it_fits_a_phone_and_paper(page: Chrome) -> None:
    sized(page, 420)
    wait(page, "return document.documentElement.scrollWidth <= 420")
    assert all(
        each.rect["x"] + each.rect["width"] <= 420 for each in page.find_elements("css selector", ".plot, table")
    )
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        assert not page.find_element("id", "moment").is_displayed()
        assert page.find_element("id", "map").is_displayed()
    finally:
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def test_what_moves_is_where_it_was_at_the_moment_that_is_pointed_at(browser: Chrome, tmp_path: Path) -> None:
    plan = drifting_plan()
    record = drifting_record(plan)
    write_report(plan, record, tmp_path, pictures=False)
    browser.get((tmp_path / "report.html").as_uri())
    wait(browser, "return document.getElementById('flight').dataset.ready === 'yes'")
    for row in (0, 60, 300):
        browser.execute_script(f"const at = document.getElementById('moment'); at.value = {row}; {TOLD}")
        north_m = max(browser.execute_script("return Bokeh.documents[0].get_model_by_name('area 2').data.ys[0][0][0]"))
        clock_s = max(0.0, record.track.t_s[row] - 12.0)
        assert north_m == pytest.approx(28.0 + min(10.0, 0.5 * clock_s), abs=1e-2)
