"""Which messages are for the vehicle, and which it passes on between its links.

https://mavlink.io/en/guide/routing.html: components are known by the link that they were last heard on; what is
addressed to one goes there only, what is addressed to all goes everywhere but where it came from.
"""

from typing import Final, NamedTuple

from vehicle_sim.protocol.dialect import AUTOPILOT_COMPONENT, Message
from vehicle_sim.protocol.link import Link

_MOST_ROUTES: Final = 256


class Decision(NamedTuple):
    """What to do with a message: handle it, and pass it on by these links."""

    is_ours: bool
    forward_to: tuple[Link, ...]


class Router:
    """Learns who is where and decides about each message."""

    def __init__(self, system_id: int) -> None:
        """Route for the autopilot component of `system_id`."""
        self._system_id = system_id
        self._routes: dict[tuple[int, int], Link] = {}

    def forget(self, link: Link) -> None:
        """Drop all that was heard on a link that is gone."""
        self._routes = {source: known for source, known in self._routes.items() if known is not link}

    def decide(self, message: Message, came_by: Link, links: tuple[Link, ...]) -> Decision:
        """Learn the source of a message and say where it goes.

        A message that claims to be the vehicle's own is an echo and goes nowhere.
        """
        source = (message.get_srcSystem(), message.get_srcComponent())
        if source == (self._system_id, AUTOPILOT_COMPONENT):
            return Decision(is_ours=False, forward_to=())
        if self._routes.get(source) is not came_by:
            self._learn(source, came_by)
        system = getattr(message, "target_system", 0)
        component = getattr(message, "target_component", 0)
        if system == 0:
            return Decision(is_ours=True, forward_to=tuple(link for link in links if link is not came_by))
        to_us = system == self._system_id
        if to_us and component == AUTOPILOT_COMPONENT:
            return Decision(is_ours=True, forward_to=())
        known = {
            link: None
            for (known_system, known_component), link in self._routes.items()
            if known_system == system and component in (0, known_component) and link is not came_by
        }
        # A component of ours that nobody ever heard of is the autopilot's business, as ArduPilot has it.
        return Decision(is_ours=to_us and (component == 0 or not known), forward_to=tuple(known))

    def _learn(self, source: tuple[int, int], link: Link) -> None:
        self._routes.pop(source, None)
        while len(self._routes) >= _MOST_ROUTES:
            del self._routes[next(iter(self._routes))]
        self._routes[source] = link
