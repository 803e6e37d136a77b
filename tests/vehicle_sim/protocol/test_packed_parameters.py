"""ArduPilot's packed parameters, against a decoder of their own and pymavlink's."""

from string import ascii_uppercase
from struct import calcsize

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.unpacked import LAYOUTS, MAGIC, MAGIC_WITH_DEFAULTS, unpacked
from vehicle_sim.parameters import Flavour, Parameter, ParameterKind, ParameterStore, default_parameters
from vehicle_sim.protocol.packed_parameters import Excerpt, excerpt_of, packed

KINDS = {ParameterKind.INT8: 1, ParameterKind.INT16: 2, ParameterKind.INT32: 3, ParameterKind.REAL32: 4}
NAMES = st.text(ascii_uppercase[:3] + "_1", min_size=1, max_size=16)
VALUES = st.integers(-128, 127)


@st.composite
def stores(draw: st.DrawFn) -> ParameterStore:
    names = draw(st.lists(NAMES, min_size=1, max_size=40, unique=True))
    store = ParameterStore(
        Flavour.ARDUPILOT,
        [Parameter(name, draw(st.sampled_from(list(KINDS))), draw(VALUES), -128, 127, "") for name in names],
    )
    for name in draw(st.lists(st.sampled_from(names))):
        store.set(name, draw(VALUES))
    return store


EXCERPTS = st.builds(Excerpt, st.integers(0, 39), st.integers(0, 45), st.booleans())


@given(stores(), st.integers(1, 239), EXCERPTS)
def test_what_is_packed_is_read_back(store: ParameterStore, block: int, asked: Excerpt) -> None:
    start, count, with_defaults = asked.start % len(store), asked.count, asked.with_defaults
    magic, total, parameters = unpacked(packed(store, Excerpt(start, count, with_defaults), block))
    names = store.names[start : start + count] if count else store.names[start:]
    assert (magic, total) == (MAGIC_WITH_DEFAULTS if with_defaults else MAGIC, len(store))
    assert [parameter.name for parameter in parameters] == list(names)
    for parameter in parameters:
        definition = store.definition(parameter.name)
        assert parameter.kind == KINDS[definition.kind]
        assert parameter.value == store[parameter.name]
        assert parameter.default == (definition.default if with_defaults else parameter.value)


@given(stores(), st.integers(8, 239))
def test_no_value_lies_across_two_blocks_and_padding_is_the_least(store: ParameterStore, block: int) -> None:
    data = packed(store, Excerpt(), block)
    for parameter in unpacked(data)[2]:
        length = calcsize(LAYOUTS[parameter.kind])
        assert parameter.value_at // block == (parameter.value_at + length - 1) // block
        assert parameter.padding < length
        if parameter.padding:
            assert parameter.value_at % block == 0


def test_a_file_byte_for_byte() -> None:
    store = ParameterStore(
        Flavour.ARDUPILOT,
        [
            Parameter("ABC_X", ParameterKind.INT8, 1, 0, 9, ""),
            Parameter("ABC_YZ", ParameterKind.INT16, -2, -9, 9, ""),
            Parameter("Q", ParameterKind.REAL32, 0.5, 0, 9, ""),
        ],
    )
    store.set("ABC_X", 3)
    header, with_defaults = "1b67 0300 0300", "1c67 0300 0300"
    y, q = "02 14 595a feff", "04 00 51 0000003f"
    assert packed(store, Excerpt(), 239) == bytes.fromhex(f"{header} 01 40 4142435f58 03 {y} {q}")
    assert packed(store, Excerpt(with_defaults=True), 239) == bytes.fromhex(
        f"{with_defaults} 11 40 4142435f58 03 01 {y} {q}"
    )
    # In blocks of 19 bytes, the value of ABC_YZ would begin with the last byte of the first block.
    assert packed(store, Excerpt(), 19) == bytes.fromhex(f"{header} 01 40 4142435f58 03 00 {y} {q}")
    assert packed(store, Excerpt(1, 1), 239) == bytes.fromhex("1b67 0100 0300 02 50 4142435f595a feff")


def test_pymavlink_reads_the_vehicles_parameters_as_they_are() -> None:
    mavftp = pytest.importorskip("pymavlink.mavftp")
    store = default_parameters(Flavour.ARDUPILOT)
    store.set("WPNAV_SPEED", 321.5)
    read = mavftp.MAVFTP.ftp_param_decode(packed(store, Excerpt(with_defaults=True), 80))
    assert [(name.decode(), value) for name, value, _ in read.params] == [(name, store[name]) for name in store]
    assert {name.decode(): value for name, value, _ in read.defaults} == {
        name: store.definition(name).stored(store.definition(name).default) for name in store
    }


@pytest.mark.parametrize(
    ("query", "excerpt"),
    [
        ("", Excerpt()),
        ("withdefaults=1", Excerpt(with_defaults=True)),
        ("start=3&count=2&withdefaults=0", Excerpt(3, 2)),
        ("count=5&other=7&start=", Excerpt(0, 5)),
    ],
)
def test_what_is_asked_for(query: str, excerpt: Excerpt) -> None:
    assert excerpt_of(query) == excerpt


@pytest.mark.parametrize("query", ["start=65535", "count=99999999999999999999", "withdefaults=2"])
def test_what_cannot_be_served_is_refused(query: str) -> None:
    with pytest.raises(ValueError, match="no vehicle"):
        excerpt_of(query)


def test_nothing_comes_after_the_last_parameter() -> None:
    store = default_parameters(Flavour.ARDUPILOT)
    with pytest.raises(ValueError, match="none from index"):
        packed(store, Excerpt(len(store)), 239)
