"""Who is answered on a port that anyone may call; times are of the clock here.

A vehicle that is heard must go on being answered, whoever else calls: a flight ends where its setpoints stay away. So
a stranger is let in where there is room, and takes the place of nobody who was heard of late.
"""

from collections.abc import Callable
from typing import Final

from mission.link.framing import split
from mission.link.messages import AUTOPILOT_COMPONENT

MOST_PEERS: Final = 16
SILENT_S: Final = 10.0

Peer = tuple[object, ...]


class Peers:
    """The vehicles on one port, and what forwards them."""

    def __init__(self, is_genuine: Callable[[bytes], bool] | None = None) -> None:
        """Begin with nobody; ``is_genuine`` judges a frame of whoever is not known yet, None lets all pass."""
        self._is_genuine = is_genuine
        self._heard_s: dict[Peer, float] = {}

    def take(self, peer: Peer, data: bytes, now_s: float) -> bool:
        """Take note of a datagram; False where its sender is nobody that is to be heard."""
        if peer not in self._heard_s and not (self._has_room(now_s) and self._is_vehicle(data)):
            return False
        self._heard_s[peer] = now_s
        return True

    def present(self, now_s: float) -> tuple[Peer, ...]:
        """Who is to be answered: those who were heard of late."""
        self._forget_silent(now_s)
        return tuple(self._heard_s)

    def _has_room(self, now_s: float) -> bool:
        self._forget_silent(now_s)
        return len(self._heard_s) < MOST_PEERS

    def _forget_silent(self, now_s: float) -> None:
        self._heard_s = {peer: heard_s for peer, heard_s in self._heard_s.items() if now_s - heard_s <= SILENT_S}

    def _is_vehicle(self, data: bytes) -> bool:
        return any(
            frame.component_id == AUTOPILOT_COMPONENT and (self._is_genuine is None or self._is_genuine(frame.data))
            for frame in split(data)[0]
        )
