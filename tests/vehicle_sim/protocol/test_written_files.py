"""What clients write by MAVLink FTP: into the memory of the vehicle, where its autopilot would write on a card."""

from errno import EINVAL, ENOSPC, ENOTEMPTY
from struct import pack

import pytest

from tests.support import file_client as ftp
from tests.support.file_client import FileClient
from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.written_files import MOST_BYTES, MOST_ENTRIES


@pytest.fixture(params=Flavour)
def client(request: pytest.FixtureRequest) -> FileClient:
    return FileClient(Station(endpoint_of(request.param)))


def card(client: FileClient) -> bytes:
    """Return the folder in which clients write."""
    return b"/APM" if client.station.endpoint.table.flavour is Flavour.ARDUPILOT else b"/fs/microsd"


def written(client: FileClient, path: bytes, *parts: bytes, opcode: int = ftp.CREATE) -> None:
    opened = client.ask(opcode, path)
    assert opened.error is None
    offset = 0
    for part in parts:
        answer = client.ask(ftp.WRITE, part, session=opened.session, offset=offset)
        assert (answer.error, answer.offset) == (None, offset)
        offset += len(part)
    assert client.ask(ftp.TERMINATE, session=opened.session).opcode == ftp.ACK


def read_back(client: FileClient, path: bytes) -> bytes:
    session, size = client.opened(path)
    data = client.content(session)
    client.ask(ftp.TERMINATE, session=session)
    assert len(data) == size
    return data


def test_a_file_is_written_and_read_back(client: FileClient) -> None:
    path = card(client) + b"/notes.txt"
    written(client, path, b"a" * 239, b"b" * 10)
    assert read_back(client, path) == b"a" * 239 + b"b" * 10
    assert "Fnotes.txt\t249" in client.names(card(client))
    written(client, path, b"cc", opcode=ftp.OPEN_TO_WRITE)  # what is longer stays
    assert read_back(client, path)[:4] == b"ccaa"
    written(client, path, b"new")
    assert read_back(client, path) == b"new"


def test_folders_and_names_change(client: FileClient) -> None:
    folder = card(client) + b"/scripts"
    assert client.ask(ftp.MAKE, folder).error is None
    assert client.ask(ftp.MAKE, folder).error == ftp.EXISTS
    assert client.ask(ftp.CREATE, card(client) + b"/none/x").error == ftp.NOT_FOUND
    written(client, folder + b"/one.lua", b"1")
    assert client.ask(ftp.RENAME, folder + b"/one.lua\0" + folder + b"/two.lua").error is None
    assert client.names(folder) == ["Ftwo.lua\t1"]
    assert client.ask(ftp.RENAME, folder + b"/one.lua\0" + folder + b"/x").error == ftp.NOT_FOUND
    assert client.ask(ftp.RENAME, folder + b"/two.lua").error == ftp.BAD_SIZE
    refused = client.ask(ftp.UNMAKE, folder)
    assert (refused.error, refused.data[1]) == (ftp.ERRNO, ENOTEMPTY)
    assert client.ask(ftp.REMOVE, folder + b"/two.lua").error is None
    assert client.ask(ftp.REMOVE, folder + b"/two.lua").error == ftp.NOT_FOUND
    assert client.ask(ftp.UNMAKE, folder).error is None
    assert "Dscripts" not in client.names(card(client))


def test_px4_cuts_and_lengthens_files() -> None:
    px4 = FileClient(Station(endpoint_of(Flavour.PX4)))
    path = card(px4) + b"/x"
    written(px4, path, b"12345")
    for size, data in ((3, b"123"), (6, b"123\0\0\0")):
        assert px4.ask(ftp.TRUNCATE, path, offset=size).error is None
        assert read_back(px4, path) == data
    assert px4.ask(ftp.CREATE, b"/x").error == ftp.PROTECTED  # only the card is


def test_there_is_no_room_without_end(client: FileClient) -> None:
    session = client.ask(ftp.CREATE, card(client) + b"/large").session
    refused = client.ask(ftp.WRITE, b"x", session=session, offset=MOST_BYTES)
    assert (refused.error, refused.data[1]) == (ftp.ERRNO, ENOSPC)
    assert client.ask(ftp.READ, session=session, size=80).error == ftp.ERRNO
    client.ask(ftp.TERMINATE, session=session)
    for number in range(MOST_ENTRIES - 1):
        assert client.ask(ftp.MAKE, card(client) + b"/%d" % number).error is None
    refused = client.ask(ftp.MAKE, card(client) + b"/more")
    assert (refused.error, refused.data[1]) == (ftp.ERRNO, ENOSPC)


def upload(client: FileClient, entries: bytes, count: int) -> ftp.Answer:
    """Write packed parameters; return the answer to the end of it."""
    data = pack("<HHH", 0x671B, count, 6 + len(entries)) + entries
    session = client.ask(ftp.CREATE, b"@PARAM/param.pck").session
    for at in range(0, len(data), 20):
        assert client.ask(ftp.WRITE, data[at : at + 20], session=session, offset=at).error is None
    return client.ask(ftp.TERMINATE, session=session)


def test_ardupilot_sets_the_parameters_of_a_file_that_is_closed() -> None:
    client = FileClient(Station(endpoint_of(Flavour.ARDUPILOT)))
    store = client.station.endpoint.vehicle.parameters
    speed = b"\x04\xa0WPNAV_SPEED" + pack("<f", 712.0)
    radius = b"\x02\x56RADIUS" + pack("<h", 345)  # as an integer, with the first six bytes of the name before
    cells = b"\x01\x60NOT_ONE" + pack("<b", 3)
    assert upload(client, speed + radius + cells, 3).opcode == ftp.ACK
    assert (store["WPNAV_SPEED"], store["WPNAV_RADIUS"]) == (712.0, 345.0)
    assert "Fparam.pck\t" + str(12 * len(store)) in client.names(b"@PARAM")


@pytest.mark.parametrize("entry", [b"\x04", b"\x09\x00A\0", b"\x14\x00A\0\0\0\0", b"\x01\x0fA\0", b"\x04\x00A\0"])
def test_what_is_no_file_of_parameters_is_refused_where_it_ends(entry: bytes) -> None:
    client = FileClient(Station(endpoint_of(Flavour.ARDUPILOT)))
    store = client.station.endpoint.vehicle.parameters
    answer = upload(client, b"\x04\xa0WPNAV_SPEED" + pack("<f", 800.0) + entry, 2)
    assert (answer.error, answer.data[1]) == (ftp.ERRNO, EINVAL)
    assert store["WPNAV_SPEED"] == 800.0  # what came before is set
