import numpy as np
import pytest

from vehicle_sim.dynamics.wind import Wind, blowing_from
from vehicle_sim.noise import GaussMarkov, Normals
from vehicle_sim.signals import Vector


def test_streams_repeat_and_differ_by_seed_and_source() -> None:
    def first(seed: int, source: int) -> list[float]:
        normals = Normals(seed, source)
        return [normals.draw() for _ in range(1500)]

    assert first(4, 1) == first(4, 1)
    assert first(4, 1) != first(5, 1)
    assert first(4, 1) != first(4, 2)


def test_gauss_markov_has_its_deviation_and_correlation() -> None:
    process = GaussMarkov(Normals(1, 1), std=2.0, time_s=1.0, step_s=0.1)
    values = np.array([process.step() for _ in range(200_000)])
    assert values.std() == pytest.approx(2.0, rel=0.03)
    lag = np.mean(values[10:] * values[:-10]) / np.mean(values**2)
    assert lag == pytest.approx(np.exp(-1.0), abs=0.02)


@pytest.mark.parametrize(("from_deg", "expected"), [(0, (-5, 0, 0)), (90, (0, -5, 0)), (180, (5, 0, 0))])
def test_wind_is_named_by_where_it_comes_from(from_deg: float, expected: Vector) -> None:
    assert blowing_from(5.0, from_deg) == pytest.approx(expected, abs=1e-12)


def test_gusts_blow_about_the_steady_wind() -> None:
    wind = Wind(Normals(3, 5), gust_m_s=1.5, step_s=0.1)
    wind.steady_ned_m_s = (4.0, -2.0, 0.0)
    air = np.array([wind.step() for _ in range(100_000)])
    assert np.allclose(air.mean(axis=0), (4.0, -2.0, 0.0), atol=0.1)
    assert np.allclose(air.std(axis=0), (1.5, 1.5, 0.75), rtol=0.05)


def test_calm_air_stands_still_until_gusts_are_asked_for() -> None:
    wind = Wind(Normals(3, 5), gust_m_s=0.0, step_s=0.1)
    assert {wind.step() for _ in range(10)} == {(0.0, 0.0, 0.0)}
    wind.set_gusts(1.0)
    assert len({wind.step() for _ in range(10)}) == 10
