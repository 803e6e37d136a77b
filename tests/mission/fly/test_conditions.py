"""The link and the wind are written down once a second of the vehicle's time, with what was lost on the link."""

from types import SimpleNamespace
from typing import Any

from mission.fly.conditions import Conditions
from mission.geometry.geodesy import LatLon, place_at_offset
from mission.link.frames import Anchor
from mission.link.values import Origin, TruePlace, Wind


def test_they_are_written_once_a_second_with_the_losses_of_ten() -> None:
    lines: list[tuple[float | None, dict[str, Any]]] = []
    arrival = SimpleNamespace(asked=0, answered=0, measured_s=0.05)
    vehicle = SimpleNamespace(clock=SimpleNamespace(newest_s=None), wind=None, true_place=None)
    record = SimpleNamespace(write=lambda kind, t_s, **values: lines.append((t_s, {"kind": kind, **values})))
    conditions: Any = Conditions(SimpleNamespace(vehicle=vehicle, contact=SimpleNamespace(arrival=arrival)), record)  # type: ignore[arg-type]
    conditions.turn()
    assert lines == []
    for tenth in range(301):
        vehicle.clock.newest_s = tenth / 10
        arrival.asked += 1
        arrival.answered += tenth < 150 or tenth % 2
        vehicle.wind = Wind(4.0, 270.0) if tenth >= 200 else None
        conditions.turn()
    assert [t_s for t_s, _ in lines] == [float(second) for second in range(31)]
    first, middle, last = lines[0][1], lines[12][1], lines[30][1]
    assert (first["lost"], middle["lost"], last["lost"]) == (None, 0.0, 0.489)
    assert (first["wind_m_s"], last["wind_m_s"], last["wind_from_deg"]) == (None, 4.0, 270.0)
    assert last == {"kind": "conditions", "delay_s": 0.05, "lost": 0.489, "wind_m_s": 4.0, "wind_from_deg": 270.0}


def test_the_true_place_of_a_simulated_vehicle_is_written_in_the_domain_each_time_that_it_is_told() -> None:
    lines: list[tuple[float | None, Any]] = []
    vehicle = SimpleNamespace(clock=SimpleNamespace(newest_s=7.0), wind=None, true_place=None, origin=None)
    arrival = SimpleNamespace(asked=0, answered=0, measured_s=0.0)
    session = SimpleNamespace(vehicle=vehicle, contact=SimpleNamespace(arrival=arrival), guidance=None)
    record = SimpleNamespace(write=lambda kind, t_s, **values: lines.append((t_s, values)) if kind == "truth" else None)
    conditions: Any = Conditions(session, record)  # type: ignore[arg-type]
    origin = LatLon(47.4, 8.5)
    told = place_at_offset(origin, 30.0, 20.0)
    for known in (False, True):
        vehicle.true_place = TruePlace(told.latitude_deg, told.longitude_deg)
        if known:
            vehicle.origin = Origin(47.4, 8.5, 400.0)
            session.guidance = SimpleNamespace(anchor=Anchor((-5.0, -10.0, 0.0)))
        conditions.turn()
        conditions.turn()
    assert lines == [(7.0, {"m": [40.0, 25.0]})]
    vehicle.true_place = TruePlace(91.0, 8.5)
    conditions.turn()
    assert len(lines) == 1
