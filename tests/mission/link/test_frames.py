"""The only ENU <-> NED conversion, against values that were written down by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.frames import Anchor, enu_from_ned, ned_from_enu, wrapped

NUMBERS = st.floats(-1e6, 1e6)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)


@pytest.mark.parametrize(
    ("enu", "ned"),
    [
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),  # east
        ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0)),  # north
        ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)),  # up
        ((3.0, -4.0, 12.0), (-4.0, 3.0, -12.0)),
    ],
)
def test_axes(enu: tuple[float, float, float], ned: tuple[float, float, float]) -> None:
    assert ned_from_enu(enu) == ned
    assert enu_from_ned(ned) == enu


@given(VECTORS)
def test_each_is_the_inverse_of_the_other_exactly(vector: tuple[float, float, float]) -> None:
    assert enu_from_ned(ned_from_enu(vector)) == vector
    assert ned_from_enu(enu_from_ned(vector)) == vector


@given(VECTORS, VECTORS)
def test_handedness_is_kept(a: tuple[float, float, float], b: tuple[float, float, float]) -> None:
    def cross(u: tuple[float, ...], v: tuple[float, ...]) -> tuple[float, float, float]:
        return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])

    # Both frames are right-handed: the vector product is the same vector in either.
    assert ned_from_enu(cross(a, b)) == pytest.approx(cross(ned_from_enu(a), ned_from_enu(b)))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_nan_stays_in_its_component(axis: int) -> None:
    vector = [1.0, 2.0, 3.0]
    vector[axis] = math.nan
    converted = ned_from_enu((vector[0], vector[1], vector[2]))
    assert sum(map(math.isnan, converted)) == 1
    assert math.isnan(converted[(1, 0, 2)[axis]])


@given(st.floats(-1e3, 1e3))
def test_wrapping_keeps_the_direction(angle: float) -> None:
    assert -math.pi <= wrapped(angle) < math.pi
    assert math.cos(wrapped(angle)) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped(angle)) == pytest.approx(math.sin(angle), abs=1e-9)


def test_an_anchor_ties_a_place_in_the_domain_to_a_place_in_the_local_frame() -> None:
    # The estimator's origin is 100 m north and 7 m below of where the vehicle stands, at (11, 9.5) of the domain.
    anchor = Anchor.between((-100.0, 0.0, -7.0), (11.0, 9.5, 0.0))
    assert anchor.to_vehicle((11.0, 9.5, 0.0)) == (-100.0, 0.0, -7.0)
    assert anchor.to_vehicle((12.0, 9.5, 5.0)) == (-100.0, 1.0, -12.0)  # a metre east, five metres up
    assert anchor.to_domain((-99.0, 0.0, -7.0)) == (11.0, 10.5, 0.0)  # a metre north


@given(VECTORS, VECTORS, VECTORS)
def test_an_anchor_goes_both_ways(
    vehicle: tuple[float, float, float], domain: tuple[float, float, float], point: tuple[float, float, float]
) -> None:
    anchor = Anchor.between(vehicle, domain)
    assert anchor.to_domain(anchor.to_vehicle(point)) == pytest.approx(point, abs=1e-6)
