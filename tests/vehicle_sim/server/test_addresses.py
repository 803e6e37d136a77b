"""Addresses as users of MAVProxy and MAVSDK write them."""

import pytest

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.policy import SigningPolicy
from vehicle_sim.server.addresses import Address, Scheme, parse_address


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("udpin:127.0.0.1:14550", Address(Scheme.UDP_IN, "127.0.0.1", 14550)),
        ("udp:0.0.0.0:14550", Address(Scheme.UDP_IN, "0.0.0.0", 14550)),  # noqa: S104 - the user's own choice
        ("udpin://127.0.0.1:0", Address(Scheme.UDP_IN, "127.0.0.1", 0)),
        ("udpout:localhost:14540", Address(Scheme.UDP_OUT, "localhost", 14540)),
        ("tcp:127.0.0.1:5760", Address(Scheme.TCP_OUT, "127.0.0.1", 5760)),
        ("pty:", Address(Scheme.PTY, "", 0)),
        ("serial:/dev/ttyUSB0:115200", Address(Scheme.SERIAL, "/dev/ttyUSB0", 115200)),
        ("serial:/dev/ttyUSB0", Address(Scheme.SERIAL, "/dev/ttyUSB0", 57600)),
        (
            "udpin:0.0.0.0:14550,signing=allowed",
            Address(Scheme.UDP_IN, "0.0.0.0", 14550, SigningPolicy.ALLOWED),  # noqa: S104 - the user's own choice
        ),
        ("pty:,signing=off", Address(Scheme.PTY, "", 0, SigningPolicy.OFF)),
        ("tcpin:[::1]:5760", Address(Scheme.TCP_IN, "::1", 5760)),
    ],
)
def test_addresses(text: str, address: Address) -> None:
    assert parse_address(text) == address
    assert parse_address(str(address)) == address


@pytest.mark.parametrize(
    "text",
    [
        "",
        "14550",
        "udpin",
        "udpin:",
        "udpin:14550",
        "udpin:h:",
        "udpin:h:x",
        "udpin:h:65536",
        "udpin:h:-1",
        "udpout:h:0",
        "ftp:h:1",
        "serial:",
        "serial:/dev/ttyS0:fast",
        "udpin:h:٣",
    ],
)
def test_what_is_no_address_says_what_to_write(text: str) -> None:
    with pytest.raises(ConfigurationError, match=r"udpin|PORT|port|DEVICE"):
        parse_address(text)


@pytest.mark.parametrize("text", ["udpin:h:1,signing", "udpin:h:1,signing=maybe", "udpin:h:1,", "udpin:h:1,speed=1"])
def test_what_is_no_policy_says_what_to_write(text: str) -> None:
    with pytest.raises(ConfigurationError, match="signing=required, allowed or off"):
        parse_address(text)


def test_what_stays_on_the_machine() -> None:
    local = ["udpin:127.0.0.1:1", "tcpin:localhost:1", "udpin:[::1]:1", "pty:", "serial:/dev/ttyS0"]
    assert all(parse_address(text).is_local for text in local)
    assert not any(parse_address(text).is_local for text in ("udpin:0.0.0.0:1", "udpout:192.168.1.2:1"))
