"""SETUP_SIGNING: a ground station gives the vehicle its key.

https://mavlink.io/en/messages/common.html#SETUP_SIGNING: the key travels readable, so it is taken only over a line that
nobody else can read, or signed with the key that it replaces; to one vehicle, not to all; on the ground. It is never
passed on. A key of zeros with timestamp zero ends signing.
"""

from typing import TYPE_CHECKING

from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.signing import SIGNED_FLAG, Signer

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.host import Host, Sender


class KeySetupService:
    """Takes another key for the vehicle.

    Attributes:
        on_key: Called with the new key, None where signing ends, for whoever keeps it.
    """

    def __init__(self, host: "Host", signer: Signer) -> None:
        self._host, self._signer = host, signer
        self.on_key: Callable[[bytes | None], None] | None = None
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_SETUP_SIGNING: self.on_setup_signing,
        }

    def on_setup_signing(self, sender: "Sender", message: Message) -> None:
        """Take the key if it came as it must; there is no answer to this message."""
        is_signed = self._signer.key is not None and bool(message.get_header().incompat_flags & SIGNED_FLAG)
        if (
            message.target_system != self._host.system_id
            or message.target_component not in (0, self._host.component_id)
            or self._host.vehicle.autopilot.armed
            or not (sender.link.is_secure or (is_signed and sender.link.checks_signatures))
        ):
            return
        key = bytes(message.secret_key)
        if not any(key):
            if message.initial_timestamp:
                return
            self._signer.install(None)
        else:
            self._signer.install(key, message.initial_timestamp)
        if self.on_key is not None:
            self.on_key(self._signer.key)
