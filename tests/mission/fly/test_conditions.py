"""The link and the wind are written down once a second of the vehicle's time, with what was lost on the link."""

from types import SimpleNamespace
from typing import Any

from mission.fly.conditions import Conditions
from mission.link.values import Wind


def test_they_are_written_once_a_second_with_the_losses_of_ten() -> None:
    lines: list[tuple[float | None, dict[str, Any]]] = []
    arrival = SimpleNamespace(asked=0, answered=0, measured_s=0.05)
    vehicle = SimpleNamespace(clock=SimpleNamespace(newest_s=None), wind=None)
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
    assert (first["lost"], middle["lost"], last["lost"]) == (None, 0.0, 0.5)
    assert (first["wind_m_s"], last["wind_m_s"], last["wind_from_deg"]) == (None, 4.0, 270.0)
    assert last == {"kind": "conditions", "delay_s": 0.05, "lost": 0.5, "wind_m_s": 4.0, "wind_from_deg": 270.0}
