"""The checksum that both autopilots make over parameters and files."""

from zlib import crc32


def plain_crc32(data: bytes | memoryview, start: int = 0) -> int:
    """Go on with a CRC-32 without the customary inversion at both ends, as PX4's `crc32part` and ArduPilot's."""
    return crc32(data, start ^ 0xFFFFFFFF) ^ 0xFFFFFFFF
