"""Addresses in the forms of pymavlink, MAVProxy and MAVSDK."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import SpecError
from mission.link.address import Address, Scheme, parse_address


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("udpin:0.0.0.0:14550", Address(Scheme.UDP_IN, "0.0.0.0", 14550)),  # noqa: S104 - an address that users write
        ("udpin::14550", Address(Scheme.UDP_IN, "0.0.0.0", 14550)),  # noqa: S104 - the same
        ("udp:127.0.0.1:14550", Address(Scheme.UDP_IN, "127.0.0.1", 14550)),
        ("udpout:192.168.1.7:14540", Address(Scheme.UDP_OUT, "192.168.1.7", 14540)),
        ("UDPOUT:localhost:14540", Address(Scheme.UDP_OUT, "localhost", 14540)),
        ("tcp:127.0.0.1:5760", Address(Scheme.TCP_OUT, "127.0.0.1", 5760)),
        ("tcpin:127.0.0.1:0", Address(Scheme.TCP_IN, "127.0.0.1", 0)),
        ("udpin://0.0.0.0:14540", Address(Scheme.UDP_IN, "0.0.0.0", 14540)),  # noqa: S104 - the same
        ("udp://:14540", Address(Scheme.UDP_IN, "0.0.0.0", 14540)),  # noqa: S104 - the same
        ("udpout://10.0.0.1:14540", Address(Scheme.UDP_OUT, "10.0.0.1", 14540)),
        ("tcpout://10.0.0.1:5760", Address(Scheme.TCP_OUT, "10.0.0.1", 5760)),
        ("tcp://10.0.0.1:5760", Address(Scheme.TCP_OUT, "10.0.0.1", 5760)),
        ("udpout:[::1]:14550", Address(Scheme.UDP_OUT, "::1", 14550)),
        ("serial:/dev/ttyACM0:115200", Address(Scheme.SERIAL, "/dev/ttyACM0", 115200)),
        ("serial:///dev/ttyACM0:115200", Address(Scheme.SERIAL, "/dev/ttyACM0", 115200)),
        ("serial:/dev/serial/by-id/usb-x_if00", Address(Scheme.SERIAL, "/dev/serial/by-id/usb-x_if00", 57600)),
        ("/dev/ttyUSB0", Address(Scheme.SERIAL, "/dev/ttyUSB0", 57600)),
        ("/dev/ttyUSB0,921600", Address(Scheme.SERIAL, "/dev/ttyUSB0", 921600)),
        ("COM3:57600", Address(Scheme.SERIAL, "COM3", 57600)),
        ("serial:COM3:57600", Address(Scheme.SERIAL, "COM3", 57600)),
    ],
)
def test_forms(text: str, address: Address) -> None:
    assert parse_address(text) == address


@pytest.mark.parametrize(
    "text",
    [
        "",
        "14550",
        "udpin",
        "udpin:14550",
        "udpout:127.0.0.1",
        "udpout::14550",
        "udpout:127.0.0.1:0",
        "tcp:127.0.0.1:99999",
        "udpin:127.0.0.1:-1",
        "udpin:127.0.0.1:１４５５０",
        "http://127.0.0.1:80",
        "serial:",
        "serial:/dev/ttyUSB0:0",
        "/dev/ttyUSB0:fast",
        "udpin:a:b:14550",
    ],
)
def test_what_is_no_address_is_refused_with_the_forms(text: str) -> None:
    with pytest.raises(SpecError) as caught:
        parse_address(text)
    fault = caught.value.faults[0]
    assert repr(text) in fault.message
    assert "udpin:HOST:PORT" in fault.hint
    assert caught.value.exit_code == 2


@given(st.text(max_size=40))
def test_any_text_is_an_address_or_refused(text: str) -> None:
    try:
        address = parse_address(text)
    except SpecError:
        return
    assert parse_address(str(address)) == address
