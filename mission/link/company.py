"""Who else is heard on a link: vehicles of other system ids, and one more of the id of the vehicle that is flown.

Commands and setpoints carry a system id and no more, so of two vehicles with one id both obey; and what is told of
the one would be taken for the other's. That is known by autopilots of two kinds, by boards with two numbers, or by two
clocks (``Arrival.doubled``).
"""

from mission.link.values import Body, Heartbeat, Version


class Company:
    """What has been heard of other vehicles.

    Attributes:
        systems: The system ids of all vehicles that were heard.
    """

    def __init__(self) -> None:
        """Nobody was heard."""
        self.systems: set[int] = set()
        self._kinds: set[int] = set()
        self._boards: set[str] = set()

    def take(self, body: Body) -> None:
        """Take what was said under the id of the vehicle that is flown, by its autopilot's component."""
        if isinstance(body, Heartbeat):
            self._kinds.add(body.autopilot)
        elif isinstance(body, Version) and body.board:
            self._boards.add(body.board)

    @property
    def doubled(self) -> bool:
        """Whether two vehicles have said so, whatever their clocks."""
        return len(self._kinds) > 1 or len(self._boards) > 1
