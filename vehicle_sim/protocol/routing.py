"""Which messages are for the vehicle, and which it passes on between its links.

https://mavlink.io/en/guide/routing.html: components are known by the link that they were last heard on; what is
addressed to one goes there only, what is addressed to all goes everywhere but where it came from.
"""

from typing import Final, NamedTuple

from vehicle_sim.protocol.dialect import AUTOPILOT_COMPONENT, MAGIC_V2, Message, mavlink
from vehicle_sim.protocol.link import Link

_MOST_ROUTES: Final = 256
_OF_ONE_LINK: Final = frozenset(
    (
        mavlink.MAVLINK_MSG_ID_RADIO,
        mavlink.MAVLINK_MSG_ID_RADIO_STATUS,
        mavlink.MAVLINK_MSG_ID_SETUP_SIGNING,
    )
)
"""What is never passed on: what a radio says of its own link, and keys, which others could read elsewhere."""


class Decision(NamedTuple):
    """What to do with a message: handle it, and pass it on by these links."""

    is_ours: bool
    forward_to: tuple[Link, ...]


class Router:
    """Learns who is where and decides about each message."""

    def __init__(self, system_id: int, component_id: int = AUTOPILOT_COMPONENT) -> None:
        """Route for component `component_id` of `system_id`."""
        self._system_id, self._component_id = system_id, component_id
        self._routes: dict[tuple[int, int], Link] = {}

    def forget(self, link: Link) -> None:
        """Drop all that was heard on a link that is gone."""
        self._routes = {source: known for source, known in self._routes.items() if known is not link}

    def decide(self, message: Message, came_by: Link, links: tuple[Link, ...]) -> Decision:
        """Learn the source of a message and say where it goes.

        A message that claims to be the vehicle's own is an echo and goes nowhere.
        """
        source = (message.get_srcSystem(), message.get_srcComponent())
        if source == (self._system_id, self._component_id):
            return Decision(is_ours=False, forward_to=())
        if source[0] and self._routes.get(source) is not came_by:
            self._learn(source, came_by)
        system = getattr(message, "target_system", 0)
        component = getattr(message, "target_component", 0)
        if message.get_msgId() in _OF_ONE_LINK:
            return Decision(is_ours=system in (0, self._system_id), forward_to=())
        if system == 0:
            return Decision(is_ours=True, forward_to=tuple(link for link in links if link is not came_by))
        to_us = system == self._system_id
        if to_us and component == self._component_id:
            return Decision(is_ours=True, forward_to=())
        known = {
            link: None
            for (known_system, known_component), link in self._routes.items()
            if known_system == system and component in (0, known_component) and link is not came_by
        }
        # A component of ours that nobody ever heard of is the autopilot's business, as ArduPilot has it.
        return Decision(is_ours=to_us and (component == 0 or not known), forward_to=tuple(known))

    def ways_of_unknown(self, frame: bytes, came_by: Link, links: tuple[Link, ...]) -> tuple[Link, ...]:
        """Return where a frame goes whose message is not of the dialect.

        Where it is addressed to cannot be read, and its checksum cannot be checked. It is passed on like a broadcast,
        if valid messages have shown that its source is on the link that it came by; nothing is learned from it.
        """
        start = 5 if frame[0] == MAGIC_V2 else 3
        if self._routes.get((frame[start], frame[start + 1])) is not came_by:
            return ()
        return tuple(link for link in links if link is not came_by)

    def _learn(self, source: tuple[int, int], link: Link) -> None:
        self._routes.pop(source, None)
        while len(self._routes) >= _MOST_ROUTES:
            del self._routes[next(iter(self._routes))]
        self._routes[source] = link
