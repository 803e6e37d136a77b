"""MAVLink FTP as ground stations use it: what there is, how it is read, how all else is refused."""

from zlib import crc32

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support import file_client as ftp
from tests.support.drawn_cases import tried
from tests.support.file_client import FileClient
from tests.support.recorded import entries_of
from tests.support.station import Station, endpoint_of
from tests.support.unpacked import unpacked
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.file_sessions import MOST_SESSIONS
from vehicle_sim.protocol.files import BLOCKS_PER_STEP

PACKED = b"@PARAM/param.pck"


def client_of(flavour: Flavour) -> FileClient:
    return FileClient(Station(endpoint_of(flavour)))


def fly_by_the_ground(client: FileClient, seconds: float = 1.0) -> bytes:
    """Arm and disarm; return the log of it."""
    station = client.station
    station.wait_for_position()
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    station.run(seconds)
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0) == mavlink.MAV_RESULT_ACCEPTED
    station.run(0.1)
    return bytes(station.endpoint.recorder.logs[-1].data)


@pytest.fixture(params=Flavour)
def client(request: pytest.FixtureRequest) -> FileClient:
    return client_of(request.param)


@pytest.fixture
def ardupilot() -> FileClient:
    return client_of(Flavour.ARDUPILOT)


@pytest.fixture
def px4() -> FileClient:
    return client_of(Flavour.PX4)


def log_path(client: FileClient) -> bytes:
    """Walk from the root to the only log."""
    path = b""
    steps = ("APM", "LOGS") if client.station.endpoint.table.flavour is Flavour.ARDUPILOT else ("fs", "microsd", "log")
    for step in steps:
        assert f"D{step}" in client.names(path or b"/")
        path += b"/" + step.encode()
    (entry,) = client.names(path)
    if entry.startswith("D"):
        path += b"/" + entry[1:].encode()
        (entry,) = client.names(path)
    assert entry.startswith("F")
    return path + b"/" + entry[1:].split("\t")[0].encode()


def test_a_log_is_found_listed_and_read(client: FileClient) -> None:
    data = fly_by_the_ground(client)
    path = log_path(client)
    assert path.endswith(b".tlog")
    session, size = client.opened(path)
    assert size == len(data)
    assert client.content(session) == data
    assert client.content(session, 100) == data
    assert entries_of(data)
    assert client.ask(ftp.TERMINATE, session=session).opcode == ftp.ACK


@pytest.mark.parametrize(
    ("flavour", "folder", "same"),
    [
        (Flavour.ARDUPILOT, b"logs", b"/APM/LOGS/"),
        (Flavour.PX4, b"./log", b"/fs/microsd/log"),
        (Flavour.PX4, b"/log/", b"/fs/microsd/log"),
    ],
)
def test_the_simulators_short_paths_lead_to_the_same_folder(flavour: Flavour, folder: bytes, same: bytes) -> None:
    client = client_of(flavour)
    fly_by_the_ground(client)
    assert client.names(folder) == client.names(same) != []


def test_a_long_folder_comes_in_parts(ardupilot: FileClient) -> None:
    for _ in range(15):
        fly_by_the_ground(ardupilot, 0.1)
    first = ardupilot.ask(ftp.LIST, b"/APM/LOGS").data
    assert 200 < len(first) <= 239
    names = [entry.split("\t")[0] for entry in ardupilot.names(b"/APM/LOGS")]
    assert names == [f"F{number:08d}.tlog" for number in range(1, 16)]
    assert len(first.split(b"\0")) - 1 < 15
    assert ardupilot.ask(ftp.LIST, b"/APM/LOGS", offset=15).error == ftp.EOF


def test_ardupilots_virtual_folders(ardupilot: FileClient) -> None:
    assert ardupilot.names(b"/") == ["D@PARAM", "D@SYS", "DAPM"]
    (entry,) = ardupilot.names(b"@PARAM")
    assert entry.startswith("Fparam.pck\t")
    assert ardupilot.names(b"@SYS/") == []
    assert ardupilot.names(b"/APM/LOGS") == []


def test_what_is_not_there(client: FileClient) -> None:
    is_ardupilot = client.station.endpoint.table.flavour is Flavour.ARDUPILOT
    fly_by_the_ground(client)
    inside = log_path(client)
    for path in (
        b"/etc/passwd",
        b"../../etc/passwd",
        inside + b"/../../../etc/passwd",
        inside + b"/..",
        inside + b"?",
        inside + b"x",
        inside.rsplit(b"/", 1)[0],  # a folder
        b"@SYS/threads.txt",
        b"@ROMFS/x",
        b"\xff\xfe/\x01",
        b"C:\\",
        b"x" * 239,
    ):
        assert client.ask(ftp.OPEN, path).error == ftp.NOT_FOUND, path
        assert client.ask(ftp.CRC, path).error == ftp.NOT_FOUND
    for path in (b"/nowhere", b"..", b"/APM/..", inside, b"\xff/\x01", b"x" * 239):
        assert client.ask(ftp.LIST, path).error == (ftp.NOT_FOUND if is_ardupilot else ftp.EOF), path


def test_packed_parameters_are_read_as_ground_stations_do(ardupilot: FileClient) -> None:
    store = ardupilot.station.endpoint.vehicle.parameters
    store.set("WPNAV_SPEED", 321.0)
    for block in (80, 110, 239):
        session, told = ardupilot.opened(PACKED + b"?withdefaults=1")
        assert told == 12 * len(store)
        total, parameters = unpacked(ardupilot.content(session, block))[1:]
        assert total == len(store)
        assert {parameter.name: parameter.value for parameter in parameters} == {name: store[name] for name in store}
        (speed,) = (parameter for parameter in parameters if parameter.name == "WPNAV_SPEED")
        assert speed.default == 1000.0
        ardupilot.ask(ftp.TERMINATE, session=session)


def test_packed_parameters_are_read_in_blocks_of_one_size_and_do_not_change_meanwhile(ardupilot: FileClient) -> None:
    store = ardupilot.station.endpoint.vehicle.parameters
    session, _ = ardupilot.opened(PACKED)
    first = ardupilot.content(session, 80)
    store.set("WPNAV_SPEED", 321.0)
    assert ardupilot.content(session, 80) == first
    refused = ardupilot.ask(ftp.READ, session=session, size=81)
    assert tuple(refused.data) == (ftp.ERRNO, 22)


@pytest.mark.parametrize("query", [b"?start=70000", b"?withdefaults=3"])
def test_parameters_that_no_vehicle_has_are_invalid(ardupilot: FileClient, query: bytes) -> None:
    assert tuple(ardupilot.ask(ftp.OPEN, PACKED + query).data) == (ftp.ERRNO, 22)
    session, _ = ardupilot.opened(PACKED + b"?start=60000")
    assert tuple(ardupilot.ask(ftp.READ, session=session, size=80).data) == (ftp.ERRNO, 22)


def test_px4_has_no_packed_parameters(px4: FileClient) -> None:
    assert px4.ask(ftp.OPEN, PACKED).error == ftp.NOT_FOUND


def test_a_burst_is_paced_numbered_and_ends_at_the_end_of_the_file(client: FileClient) -> None:
    data = fly_by_the_ground(client, 8.0)
    session, size = client.opened(log_path(client))
    client.station.forget()
    client.station.send(client.message(ftp.BURST, session=session, size=239))
    assert client.answers == []
    sent = []
    while not client.answers or client.answers[-1].opcode == ftp.ACK:
        before = len(client.answers)
        client.station.run(0.01)
        sent.append(len(client.answers) - before)
        assert len(sent) < 1000
    assert set(sent[:-1]) == {BLOCKS_PER_STEP}
    *blocks, last = client.answers
    assert [block.sequence for block in client.answers] == [client.sequence + n for n in range(len(client.answers))]
    assert [block.offset for block in client.answers] == [*range(0, size, 239), size]
    assert b"".join(block.data for block in blocks) == data
    assert not any(block.ends_burst for block in blocks)
    assert last.ends_burst
    assert last.error == ftp.EOF
    client.station.run(0.1)
    assert len(client.answers) == len(sent[:-1]) * BLOCKS_PER_STEP + sent[-1]


def test_px4_ends_a_burst_now_and_then(px4: FileClient) -> None:
    px4.station.take_off()
    px4.station.run(40.0)
    session, size = px4.opened(log_path(px4))
    assert size > 40_000
    px4.station.forget()
    px4.station.send(px4.message(ftp.BURST, session=session, size=239))
    px4.station.run(3.0)
    last = px4.answers[-1]
    assert (last.opcode, last.ends_burst) == (ftp.ACK, True)
    assert 35_000 < last.offset + len(last.data) < 36_000


def test_a_burst_that_is_asked_for_again_starts_over_and_ends_with_its_session(client: FileClient) -> None:
    fly_by_the_ground(client, 8.0)
    session, _ = client.opened(log_path(client))
    client.station.forget()
    message = client.message(ftp.BURST, session=session, offset=478, size=100)
    for _ in range(2):
        client.station.send(message)
        client.station.run(0.01)
    first, second = client.answers[:BLOCKS_PER_STEP], client.answers[BLOCKS_PER_STEP:]
    assert first == second
    assert first[0].offset == 478
    assert client.ask(ftp.TERMINATE, session=session).opcode == ftp.ACK
    client.station.forget()
    client.station.run(0.1)
    assert client.answers == []


def test_a_request_that_comes_again_is_answered_with_the_same_bytes(client: FileClient) -> None:
    fly_by_the_ground(client)
    path = log_path(client)
    for opcode, data in ((ftp.OPEN, path), (ftp.LIST, b"/"), (ftp.CRC, path), (ftp.RESET, b""), (ftp.MAKE, b"/x")):
        client.station.forget()
        message = client.message(opcode, data)
        client.station.send(message, message, message)
        first, *others = client.payloads()
        assert others == [first, first]
    assert len(client.station.endpoint._files.sessions) == 0  # one was opened, and reset


def test_sessions_of_ardupilot_are_bounded_and_idle_ones_give_way(ardupilot: FileClient) -> None:
    sessions = [ardupilot.ask(ftp.OPEN, PACKED, session=number).session for number in range(MOST_SESSIONS)]
    assert sessions == list(range(MOST_SESSIONS))
    assert ardupilot.ask(ftp.OPEN, PACKED, session=9).error == ftp.NO_SESSION
    ardupilot.station.run(2.0)
    for session in sessions[1:]:
        ardupilot.ask(ftp.READ, session=session, size=80)
    ardupilot.station.run(1.5)
    newest = ardupilot.ask(ftp.OPEN, PACKED, session=9).session
    assert ardupilot.ask(ftp.READ, session=sessions[0], size=80).error == ftp.NOT_FOUND
    assert ardupilot.ask(ftp.READ, session=sessions[1], size=80).opcode == ftp.ACK
    ardupilot.station.run(21.0)
    assert ardupilot.ask(ftp.READ, session=newest, size=80).error == ftp.NOT_FOUND


def test_ardupilot_lets_a_client_choose_a_session_and_refuses_it_while_it_is_in_use(ardupilot: FileClient) -> None:
    assert ardupilot.ask(ftp.OPEN, PACKED, session=9).session == 9
    assert ardupilot.ask(ftp.OPEN, PACKED, session=9).error == ftp.FAIL
    ardupilot.station.run(3.1)
    assert ardupilot.ask(ftp.OPEN, PACKED, session=9).session == 9
    assert ardupilot.ask(ftp.TERMINATE, session=9).opcode == ftp.ACK
    assert ardupilot.ask(ftp.TERMINATE, session=9).opcode == ftp.ACK


def test_clients_of_ardupilot_do_not_touch_each_others_sessions(ardupilot: FileClient) -> None:
    other = FileClient(Station(ardupilot.station.endpoint, "other", system_id=254))
    session, _ = ardupilot.opened(PACKED)
    assert other.ask(ftp.READ, session=session, size=80).error == ftp.NOT_FOUND
    assert other.ask(ftp.RESET).opcode == ftp.ACK
    assert ardupilot.ask(ftp.READ, session=session, size=80).opcode == ftp.ACK
    other.opened(PACKED)
    ardupilot.station.endpoint.remove_link("other")
    assert len(ardupilot.station.endpoint._files.sessions) == 1


def test_px4_has_one_session_on_each_link(px4: FileClient) -> None:
    other = FileClient(Station(px4.station.endpoint, "other", system_id=254))
    fly_by_the_ground(px4)
    path = log_path(px4)
    assert px4.opened(path)[0] == 0
    assert px4.ask(ftp.OPEN, path).error == ftp.NO_SESSION
    assert other.opened(path)[0] == 0
    assert px4.ask(ftp.READ, session=1, size=80).error == ftp.BAD_SESSION
    assert px4.ask(ftp.TERMINATE, session=1).error == ftp.BAD_SESSION
    assert px4.ask(ftp.RESET).opcode == ftp.ACK
    assert px4.ask(ftp.TERMINATE).error == ftp.BAD_SESSION
    assert other.ask(ftp.READ, size=80).opcode == ftp.ACK


def test_without_a_file_there_is_nothing_to_read(client: FileClient) -> None:
    is_ardupilot = client.station.endpoint.table.flavour is Flavour.ARDUPILOT
    for opcode in (ftp.READ, ftp.BURST, ftp.WRITE):
        assert client.ask(opcode, session=3, size=80).error == (ftp.NOT_FOUND if is_ardupilot else ftp.BAD_SESSION)


def test_logs_and_what_the_autopilot_has_are_not_written(client: FileClient) -> None:
    data = fly_by_the_ground(client)
    path = log_path(client)
    is_ardupilot = client.station.endpoint.table.flavour is Flavour.ARDUPILOT
    own = b"@SYS" if is_ardupilot else b"/etc/extras/actuators.json.xz"
    for opcode in (ftp.CREATE, ftp.REMOVE, ftp.MAKE, ftp.UNMAKE, ftp.OPEN_TO_WRITE):
        for name in (path, path.rsplit(b"/", 1)[0], own, b"/", b"/../x"):
            assert client.ask(opcode, name).error == ftp.PROTECTED, name
    assert client.ask(ftp.RENAME, path + b"\0/x").error == ftp.PROTECTED
    truncated = client.ask(ftp.TRUNCATE, path).error
    assert truncated == (ftp.UNKNOWN if is_ardupilot else ftp.PROTECTED)
    session, _ = client.opened(path)
    assert client.ask(ftp.WRITE, b"x", session=session).error == (ftp.FAIL if is_ardupilot else ftp.ERRNO)
    assert client.content(session) == data


@pytest.mark.parametrize("opcode", [16, 17, 100, 127, 130, 255])
def test_an_unknown_command_is_refused(client: FileClient, opcode: int) -> None:
    assert client.ask(opcode, b"/").error == ftp.UNKNOWN


def test_sizes_that_cannot_be_are_refused(client: FileClient) -> None:
    assert client.ask(ftp.LIST, b"/", size=240).error == ftp.BAD_SIZE
    assert client.ask(ftp.OPEN, b"").error == ftp.BAD_SIZE
    assert client.ask(ftp.READ, size=255).error == ftp.BAD_SIZE
    assert client.ask(0).opcode == ftp.ACK


def test_the_checksum_of_a_file(client: FileClient) -> None:
    data = fly_by_the_ground(client)
    answer = client.ask(ftp.CRC, log_path(client))
    assert int.from_bytes(answer.data, "little") == crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


def test_a_log_that_grows_keeps_the_size_that_was_told(px4: FileClient) -> None:
    px4.station.wait_for_position()
    px4.station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    px4.station.run(1.0)
    session, size = px4.opened(log_path(px4))
    px4.station.run(2.0)
    assert len(px4.station.endpoint.recorder.logs[0].data) > size
    assert len(px4.content(session)) == size


REQUESTS = st.lists(
    st.tuples(
        st.sampled_from((*range(17), 128, 129, 255)),
        st.sampled_from((b"/", PACKED, b"@SYS", b"logs", b"/log", b"/APM/LOGS/00000001.tlog", b"\0", b"../x"))
        | st.binary(max_size=239),
        st.integers(0, 9),
        st.sampled_from((0, 1, 80, 239, 1000, 2**32 - 1)) | st.integers(0, 2**32 - 1),
        st.none() | st.integers(0, 255),
        st.integers(0, 1),
    ),
    max_size=30,
)


@tried(60)
@given(st.sampled_from(Flavour), REQUESTS)
def test_whatever_is_asked_for_is_answered_and_nothing_piles_up(
    flavour: Flavour, requests: list[tuple[int, bytes, int, int, int | None, int]]
) -> None:
    endpoint = endpoint_of(flavour)
    clients = [FileClient(Station(endpoint, name, system_id=250 + place)) for place, name in enumerate(("a", "b"))]
    for opcode, data, session, offset, size, place in requests:
        client = clients[place]
        before = len(client.answers)
        client.station.send(client.message(opcode, data, session=session, offset=offset, size=size))
        assert len(client.answers) - before <= 1
        if opcode not in (ftp.BURST, ftp.ACK, ftp.NAK):
            assert len(client.answers) == before + 1
            assert client.answers[-1].sequence == client.sequence
        endpoint.advance()
        for one in clients:
            one.station.collect()
            assert all(answer.opcode in (ftp.ACK, ftp.NAK) for answer in one.answers)
        sessions = endpoint._files.sessions
        assert len(sessions) <= (MOST_SESSIONS if flavour is Flavour.ARDUPILOT else len(clients))
