"""The page as a person uses it, in headless Chromium: a flight under way with its buttons, and one again."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from selenium.webdriver import Chrome
from selenium.webdriver.common.by import By

from mission.fly.requests import Request
from mission.view.replaying import planned
from mission.view.server import PageServer
from tests.support.chromium import chromium, logged, sized, wait
from tests.support.drawn_plans import PAPER_TOUR, SURVEY_TOUR, plan_of
from tests.support.drifting_plans import drifting_plan

EVIL = "</script><img src=x onerror=document.title='hacked'>"
PLAN = replace(plan_of(PAPER_TOUR), spec=replace(plan_of(PAPER_TOUR).spec, name=EVIL))
MOMENTS = [*planned(PLAN)][::150]
PRESENT = "return Bokeh.documents[0].get_model_by_name('present').data.x.length"
CURSOR = "const {x, y} = Bokeh.documents[0].get_model_by_name('cursor').data; return [x[0], y[0]]"
MODEL = "const {y0, ys} = Bokeh.documents[0].get_model_by_name"
TOLD = "at.dispatchEvent(new Event('input'))"
FLOWN = "return Bokeh.documents[0].get_model_by_name('flown').data.x.length"


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chrome]:
    yield from chromium(tmp_path_factory.mktemp("profile"))


def opened(browser: Chrome, server: PageServer, width: int = 1200) -> None:
    sized(browser, width)
    browser.get(server.address)
    wait(browser, "return document.body.dataset.ready === 'yes' && document.body.dataset.link === 'live'")


def text(browser: Chrome, selector: str) -> str:
    return browser.find_element(By.CSS_SELECTOR, selector).text


def test_a_flight_is_watched_and_commanded_by_buttons_that_ask_first(browser: Chrome) -> None:
    with PageServer(PLAN, "live") as server:
        server.feed.show(replace(MOMENTS[0], told=(EVIL,), battery_percent=73.0))
        opened(browser, server)
        wait(browser, "return document.querySelectorAll('#news li').length === 1")
        assert text(browser, "h1") == EVIL
        assert EVIL in text(browser, "#news")
        assert browser.title == EVIL
        assert text(browser, "[data-value=doing]").endswith("on the way to S1")
        assert text(browser, "[data-value=still]").startswith("come to S1")
        assert text(browser, "[data-value=battery]") == "73"
        assert text(browser, "#nearest").startswith("K1, ")
        assert browser.execute_script(PRESENT) >= 1
        assert browser.execute_script(CURSOR) == pytest.approx(PLAN.start_m, abs=0.4)

        browser.find_element(By.CSS_SELECTOR, "[data-request=land]").click()
        assert text(browser, "#question").startswith("Land? The vehicle lands at once, where it is.")
        browser.find_element(By.CSS_SELECTOR, "dialog [value=no]").click()
        browser.find_element(By.CSS_SELECTOR, "[data-request=hold]").click()
        browser.find_element(By.CSS_SELECTOR, "dialog [value=yes]").click()
        wait(browser, "return document.getElementById('answer').textContent === 'hold: asked'")
        wait(browser, "return performance.getEntriesByType('resource').some((each) => each.name.endsWith('/request'))")
        assert [server.feed.take(), server.feed.take()] == [Request.HOLD, None]
        server.feed.answer(Request.HOLD, "the vehicle holds", granted=True)
        wait(browser, "return document.getElementById('answer').textContent === 'hold: the vehicle holds'")

        for moment in MOMENTS[1:]:
            server.feed.show(moment)
        wait(browser, "return document.querySelector('[data-value=doing]').textContent.startsWith('in R')")
        assert browser.execute_script(FLOWN) > 1
        server.say_at_the_end("the flight is over: ACHIEVED")
    wait(browser, "return document.getElementById('state').textContent === 'the flight is over: ACHIEVED'")
    assert not browser.find_element(By.CSS_SELECTOR, "[data-request=land]").is_enabled()
    assert [entry for entry in logged(browser, "browser") if entry["level"] == "SEVERE"] == []


@pytest.mark.parametrize("width", [1200, 420])
def test_a_flight_is_seen_again_moment_by_moment(browser: Chrome, width: int) -> None:
    with PageServer(PLAN, "the flight of then", MOMENTS) as server:
        opened(browser, server, width)
        wait(browser, f"{FLOWN} === {len(MOMENTS)}")
        assert text(browser, "#state") == "the flight of then"
        assert not browser.find_elements(By.CSS_SELECTOR, "[data-request]")
        row = len(MOMENTS) // 2
        browser.execute_script(
            "const slider = document.getElementById('moment'); slider.value = arguments[0];"
            "slider.dispatchEvent(new Event('input'))",
            str(row),
        )
        assert browser.execute_script(CURSOR) == pytest.approx(MOMENTS[row].place_m, abs=1e-3)
        assert text(browser, "#time") == f"{MOMENTS[row].t_s:.1f} s"
        assert not browser.find_element(By.CSS_SELECTOR, "[data-value=battery]").is_displayed()
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width
        mesh = (
            "return Bokeh.documents[0].get_model_by_name('map').renderers.filter((each) => each.name === 'triangles')"
        )
        assert browser.execute_script(f"{mesh}.map((each) => each.visible)") == [True]
        [box] = [
            each for each in browser.find_elements(By.CSS_SELECTOR, "#layers label") if each.text.strip() == "triangles"
        ]
        box.click()
        assert browser.execute_script(f"{mesh}.map((each) => each.visible)") == [False]


def test_each_plan_of_a_flight_is_drawn_for_its_own_moments(browser: Chrome) -> None:
    other = plan_of(SURVEY_TOUR)
    moments = [MOMENTS[0], *[*planned(other)][::300]]
    with PageServer(PLAN, "the flight of then", moments) as server:
        opened(browser, server)
        for row, plan in ((len(moments) - 1, other), (0, PLAN)):
            browser.execute_script(
                "const slider = document.getElementById('moment'); slider.value = arguments[0];"
                "slider.dispatchEvent(new Event('input'))",
                str(row),
            )
            states = (
                "Bokeh.documents[0]?.get_model_by_name('automaton')?.renderers.map((each) => each.data_source.data)"
            )
            count = plan.shown_automaton.size
            wait(browser, f"return {states}?.some((data) => data.fill?.length === {count})")
            wait(browser, PRESENT)


def test_what_moves_and_its_triangles_are_where_they_are_at_each_moment(browser: Chrome) -> None:
    plan = drifting_plan()
    assert plan.moving is not None
    moments = [*planned(plan)][::150]
    with PageServer(plan, "the flight of then", moments) as server:
        opened(browser, server)
        wait(browser, f"{FLOWN} === {len(moments)}")
        for row in (0, 2, len(moments) - 1):
            browser.execute_script(f"const at = document.getElementById('moment'); at.value = {row}; {TOLD}")
            edges = browser.execute_script(f"{MODEL}('mesh').data; return y0.reduce((a, b) => a + b)")
            clock_s = moments[row].since_s
            vertices = plan.moving.vertices_at(clock_s)
            pairs = np.unique(np.sort(plan.partition.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
            assert edges == pytest.approx(vertices[pairs[:, 0], 1].sum(), abs=0.5)
            top = browser.execute_script(f"{MODEL}('area 2').data; return Math.max(...ys[0][0][0])")
            assert top == pytest.approx(28.0 + min(10.0, 0.5 * clock_s), abs=0.02)
