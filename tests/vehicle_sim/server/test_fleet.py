"""Several vehicles in one process: ids, places, noise, and one link for all."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from vehicle_sim import cli
from vehicle_sim.cli.command_line import build_parser
from vehicle_sim.errors import ConfigurationError
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.server.addresses import parse_address
from vehicle_sim.server.fleet import fleet_of, grid_place
from vehicle_sim.server.party import Fleet
from vehicle_sim.vehicle import VehicleConfig


def endpoints_of(count: int, *, system_id: int = 1, component_id: int = 1) -> list[Endpoint]:
    return fleet_of(VehicleConfig(), count=count, spacing_m=6.0, system_id=system_id, component_id=component_id)


def test_places_form_a_square_of_rows() -> None:
    assert [grid_place(i, 5, 2.0) for i in range(5)] == [(0, 0), (0, 2), (0, 4), (2, 0), (2, 2)]
    assert grid_place(0, 1, 2.0) == (0, 0)
    endpoints = endpoints_of(4)
    homes = [endpoint.vehicle.config.home for endpoint in endpoints]
    offsets = [ned_offset_m(homes[0], home) for home in homes]
    for offset, expected in zip(offsets, [(0, 0, 0), (0, 6, 0), (6, 0, 0), (6, 6, 0)], strict=True):
        assert offset == pytest.approx(expected, abs=1e-4)


def test_each_has_an_id_and_noise_of_its_own() -> None:
    endpoints = endpoints_of(3, system_id=7, component_id=5)
    assert [endpoint.system_id for endpoint in endpoints] == [7, 8, 9]
    assert {endpoint.component_id for endpoint in endpoints} == {5}
    for endpoint in endpoints:
        for _ in range(100):
            endpoint.advance()
    readings = {endpoint.vehicle.readings.imu for endpoint in endpoints}
    assert len(readings) == 3


def test_there_are_255_system_ids() -> None:
    assert len(endpoints_of(2, system_id=254)) == 2
    with pytest.raises(ConfigurationError, match="255"):
        endpoints_of(2, system_id=255)


class Ground:
    """A ground station on one link with all of them."""

    def __init__(self, endpoints: list[Endpoint]) -> None:
        self.endpoints, self.fleet = endpoints, Fleet(endpoints)
        self.fleet.add_link("all", Rates.SILENT)
        self.mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
        self.parser = mavlink.MAVLink(None)

    def ask(self, message: Message) -> list[Message]:
        self.fleet.receive("all", message.pack(self.mav))
        return self.heard()

    def heard(self) -> list[Message]:
        return [m for datagram in self.fleet.outgoing("all") for m in self.parser.parse_buffer(datagram) or ()]


def test_on_a_shared_link_each_answers_for_itself() -> None:
    ground = Ground(endpoints_of(3))
    for endpoint in ground.endpoints:
        endpoint.advance()
    assert [m.get_srcSystem() for m in ground.heard() if m.get_type() == "HEARTBEAT"] == [1, 2, 3]
    # Everyone answers what is addressed to everyone, one what is addressed to it, nobody what is for none of them.
    for target, answering in ((0, [1, 2, 3]), (2, [2]), (9, [])):
        request = mavlink.MAVLink_command_long_message(target, 1, mavlink.MAV_CMD_REQUEST_MESSAGE, 0, 148, *(0,) * 6)
        answers = ground.ask(request)
        assert [m.get_srcSystem() for m in answers if m.get_type() == "COMMAND_ACK"] == answering
    ground.ask(mavlink.MAVLink_param_set_message(3, 1, b"FS_GCS_ENABLE", 1.0, 9))
    assert [endpoint.vehicle.parameters["FS_GCS_ENABLE"] for endpoint in ground.endpoints] == [0, 0, 1]
    ground.fleet.remove_link("all")
    assert not any(endpoint._links for endpoint in ground.endpoints)


def test_component_ids_other_than_1() -> None:
    ground = Ground(endpoints_of(1, component_id=42))
    for component in (42, 0, 1):  # nobody ever heard of component 1, so it is the autopilot's business
        request = mavlink.MAVLink_command_long_message(1, component, 31000, 0, *(0,) * 7)
        assert [m.get_srcComponent() for m in ground.ask(request)] == [42]


def links_of(*arguments: str, index: int) -> list[str]:
    options = build_parser().parse_args(["--no-ground-station", *arguments])
    return [str(address) for address, _, _ in cli._links(options, index)]


def test_ports_are_numbered_as_the_simulators_do() -> None:
    assert links_of(index=2) == ["tcpin:127.0.0.1:5780"]
    assert links_of("--flavour", "px4", index=2) == ["udpin:127.0.0.1:14582", "udpout:127.0.0.1:14542"]
    assert links_of("--listen", "udpin:127.0.0.1:9000", "--port-step", "3", index=4) == ["udpin:127.0.0.1:9012"]
    assert links_of("--listen", "udpin:127.0.0.1:0", "--listen", "pty:", index=4) == ["udpin:127.0.0.1:0", "pty:"]
    for text in ("serial:/dev/ttyS0:57600", "tcp:127.0.0.1:65530"):
        with pytest.raises(ConfigurationError, match=r"--shared|begin lower"):
            parse_address(text).shifted(10)
