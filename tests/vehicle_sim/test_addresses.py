"""Addresses as users of MAVProxy and MAVSDK write them."""

import pytest

from vehicle_sim.addresses import Address, Scheme, parse_address
from vehicle_sim.errors import ConfigurationError


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("udpin:127.0.0.1:14550", Address(Scheme.UDP_IN, "127.0.0.1", 14550)),
        ("udp:0.0.0.0:14550", Address(Scheme.UDP_IN, "0.0.0.0", 14550)),  # noqa: S104 - the user's own choice
        ("udpin://127.0.0.1:0", Address(Scheme.UDP_IN, "127.0.0.1", 0)),
        ("udpout:localhost:14540", Address(Scheme.UDP_OUT, "localhost", 14540)),
        ("tcp:127.0.0.1:5760", Address(Scheme.TCP_OUT, "127.0.0.1", 5760)),
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
        "udpin:h:٣",
    ],
)
def test_what_is_no_address_says_what_to_write(text: str) -> None:
    with pytest.raises(ConfigurationError, match=r"udpin|PORT|port"):
        parse_address(text)
