"""What a page says of a moment, of a flight under way, of one from its record, and of a plan."""

import json
from dataclasses import replace
from functools import cache
from typing import Any

from mission.fly.requests import Request
from mission.fly.result import Progress
from mission.monitor.stage import Stage
from mission.monitor.time_bounds import BoundNow
from mission.monitor.verdict import Verdict
from mission.plan import FlightPlan
from mission.report.interactive.of_flight import scene_of
from mission.report.reading import parse_record
from mission.view.drawing import figures
from mission.view.feed import Answer, Feed
from mission.view.moments import Narrator, doing, still
from mission.view.replaying import planned, recorded
from mission.view.show import Show
from tests.support.drawn_plans import PAPER_TOUR, PATROL_TOUR, SURVEY_TOUR, flight_of, plan_of

PLAN = plan_of(PAPER_TOUR)


def at(plan: FlightPlan = PLAN, **values: Any) -> Progress:  # noqa: ANN401 - of any field
    return replace(first_of(plan), **values)


@cache
def first_of(plan: FlightPlan) -> Progress:
    return next(planned(plan))


def letters(*names: str) -> tuple[frozenset[str], ...]:
    return tuple(frozenset({name} if name else ()) for name in names)


def test_words_say_where_the_vehicle_is_and_what_it_must_still_do() -> None:
    over = at(word=letters("S2", ""), done=0, total=2, awaited=("S1",))
    assert doing(over, PLAN) == "over open ground, on the way to S1"
    assert still(over, PLAN) == "come to S1 (0 of 2 steps are done)"
    inside = at(word=letters("S2", "", "S1"), done=1, total=2, awaited=("R",))
    assert doing(inside, PLAN) == "in S1, on the way to R"
    assert doing(replace(inside, held=True), PLAN) == "holding, as was asked, in S1"
    home = at(word=letters("S2", "", "S1", "R"), done=2, total=2, awaited=(), verdict=Verdict.OPEN)
    assert doing(home, PLAN) == "in R, on the way to where it ends"
    assert still(home, PLAN) == "break no rule up to the end (2 of 2 steps are done)"
    assert still(replace(home, verdict=Verdict.TRUE), PLAN).startswith("nothing more")
    assert still(replace(home, verdict=Verdict.FALSE), PLAN).startswith("in vain")


def test_what_is_left_to_do_in_time_is_said_and_what_was_missed() -> None:
    flown = at(bounds=(BoundNow("F[0,60] S1", met=None, at_s=60.0, will=False),), since_s=20.0)
    assert still(flown, PLAN).endswith("; F[0,60] S1 open, 40 s left")
    late = replace(flown, bounds=(BoundNow("F[0,60] S1", met=False, at_s=60.0),))
    assert still(late, PLAN) == "in vain: F[0,60] S1 missed at 60.0 s"
    waits = at(stage=Stage.READY, waiting_for="no position yet")
    assert doing(waits, PLAN) == "waiting for position and health: no position yet"


def test_laps_are_counted_in_words() -> None:
    plan = plan_of(PATROL_TOUR)
    flying = at(plan, laps=1, laps_asked=3, done=0, total=0)
    assert still(flying, plan).endswith("1 of 3 laps are flown")
    assert "as many laps as wanted" in still(replace(flying, laps_asked=None), plan)


def test_on_laps_the_next_region_is_that_of_the_loop() -> None:
    plan = plan_of(PATROL_TOUR)
    flying = at(plan, laps=1, laps_asked=3, word=letters("base", "", "pond", "", "base", "", "pond", ""))
    assert doing(flying, plan) == "over open ground, on the way to base"
    assert doing(replace(flying, word=(*flying.word, *letters("base"))), plan) == "in base, on the way to pond"
    assert doing(replace(flying, laps=3), plan) == "over open ground, on the way to where it ends"


def test_the_automaton_is_where_the_word_leads() -> None:
    """F (S1 & F R): the flight begins in S2, and is done once S1 and R have been seen in that order."""
    narrator, machine = Narrator(PLAN), PLAN.shown_automaton
    told = [narrator.moment(moment) for moment in planned(PLAN)]
    assert told[0]["states"] == sorted(machine.initial)
    assert set(told[-1]["states"]) & machine.accepting
    # The same letters at once, as for who looks late, lead to the same states.
    assert Narrator(PLAN).moment(at(word=[*planned(PLAN)][-1].word))["states"] == told[-1]["states"]
    json.dumps(told, allow_nan=False)


def test_another_plan_begins_with_a_word_of_its_own() -> None:
    narrator, other = Narrator(PLAN), replace(PLAN)
    narrator.moment(at(word=letters("S2", "", "S1")))
    moment = narrator.moment(at(plan=other, word=()))
    assert (moment["plan"], moment["states"]) == (2, sorted(PLAN.shown_automaton.initial))
    assert narrator.moment(at(plan=PLAN, stage=Stage.STANDBY, word=()))["plan"] == 3  # planned anew for where it stands


def test_a_replay_has_the_places_of_the_record_and_what_was_known_there() -> None:
    plan = plan_of(SURVEY_TOUR)
    header, *lines = flight_of(plan)[0].splitlines(keepends=True)
    flying = b'{"kind":"event","t_s":0.0,"name":"stage","stage":"flying"}\n'
    at_s = json.loads(lines[-1])["t_s"]
    said = f'{{"kind":"event","t_s":{at_s},"name":"intention","reason":"going on"}}\n'
    charge = f'{{"kind":"charge","t_s":{at_s},"percent":61,"drawn_mah":null}}\n'
    record = parse_record(b"".join([header, flying, *lines, said.encode(), charge.encode()]))
    moments = [*recorded(plan, record)]
    assert (moments[0].told, moments[0].battery_percent) == ((), None)
    assert (moments[-1].told, moments[-1].battery_percent) == (("going on",), 61.0)
    places = [moment.place_m for moment in moments]
    assert places == [(x, y) for x, y in record.track.position_m[:, :2].tolist()]
    assert [moment.t_s for moment in moments] == record.track.t_s.tolist()
    assert moments[-1].word[-1] == {"base"}
    near = moments[len(moments) // 2]
    assert near.nearest is not None
    assert near.place_m is not None
    assert near.nearest[0] in {"school", "mast"}
    assert [each.name for each in scene_of(plan, None).areas if each.name == near.nearest[0]]
    assert all(moment.error_m is None or moment.error_m < 0.5 for moment in moments)


def test_long_flights_are_thinned_to_what_a_page_can_hold() -> None:
    long = parse_record(flight_of(PLAN, reports=2000)[0])
    moments = [*recorded(PLAN, long)]
    assert len(moments) == 1500
    assert (moments[0].t_s, moments[-1].t_s) == (long.track.t_s[0], long.track.t_s[-1])


def test_what_is_kept_for_late_pages_is_bounded_and_ends_with_now() -> None:
    show, moment = Show(PLAN), at()
    for count in range(0, 5000, 10):
        told = tuple(map(str, range(count // 10)))
        show.add([replace(moment, t_s=float(count + k), told=told) for k in range(10)])
    kept = json.loads(show.all)
    assert len(kept["moments"]) <= 2000
    assert kept["moments"][-1]["t"] == 4999.0
    assert [words for _, words in kept["news"]] == [str(k) for k in range(299, 499)]


def test_a_message_tells_of_later_moments_what_has_changed() -> None:
    first, second = at(t_s=1.0), at(t_s=1.1)
    answers = [Answer(Request.HOLD, "why not", granted=False)]
    message = json.loads(Show(PLAN).add([first, second], answers))
    assert message["moments"][1] == {"t": 1.1}
    assert message["answers"] == ["hold: refused, why not"]
    assert Show(PLAN).add([]) == ""


def test_a_feed_that_nobody_reads_keeps_the_newest() -> None:
    feed = Feed()
    for k in range(1000):
        feed.show(at(t_s=float(k)) if k > 990 else at())
    assert [moment.t_s for moment in feed.moments()][-2:] == [998.0, 999.0]
    assert feed.moments() == []
    assert [feed.ask(Request.LAND) for _ in range(9)] == [True] * 8 + [False]


def test_the_figures_have_the_mesh_the_fields_and_every_state() -> None:
    told = figures(PLAN)
    json.dumps(told, allow_nan=False)
    edges = {tuple(sorted(pair)) for a, b, c in PLAN.partition.triangles.tolist() for pair in ((a, b), (b, c), (c, a))}
    document = json.dumps(told["documents"])
    assert f'"shape": [{len(edges)}]' in document
    assert set(told["states"]) == {str(state) for state in range(PLAN.shown_automaton.size)}


def test_a_plan_of_laps_is_shown_to_the_end_of_one() -> None:
    moments = [*planned(plan_of(PATROL_TOUR))]
    assert len(moments) == 1500
    assert moments[-1].word[-1] == {"base"}
