"""What PX4 tells of itself in files: COMPONENT_METADATA names the first, and that the others.

https://mavlink.io/en/services/component_information.html. Ground stations fetch them by MAVLink FTP, and keep them
under their checksums. What parameters mean is not among them: the ground stations' own lists say more of them than
this vehicle knows.
"""

from functools import cache
from json import dumps
from lzma import compress
from typing import Final

from vehicle_sim.protocol.checksum import plain_crc32
from vehicle_sim.protocol.data_files import source
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.late_messages import ComponentMetadata

FOLDER: Final = ("etc", "extras")
GENERAL: Final = "component_general.json.xz"
_TYPES: Final = {"all_events": 4, "actuators": 5}
"""COMP_METADATA_TYPE of each file."""


@cache
def metadata_files() -> dict[str, bytes]:
    """Return the files of the folder, packed, by their names."""
    packed = {f"{name}.json.xz": compress(source(name)) for name in _TYPES}
    types = [
        {"type": kind, "uri": _uri(name), "fileCrc": plain_crc32(packed[name])}
        for name, kind in zip(packed, _TYPES.values(), strict=True)
    ]
    return packed | {GENERAL: compress(dumps({"version": 1, "metadataTypes": types}).encode())}


def component_metadata(host: Host) -> Message:
    """COMPONENT_METADATA: where the first of the files is."""
    checksum = plain_crc32(metadata_files()[GENERAL])
    return ComponentMetadata(host.now_us // 1000, checksum, _uri(GENERAL))


def _uri(name: str) -> str:
    return "/".join(("mftp:/", *FOLDER, name))
