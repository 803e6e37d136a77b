"""Who may speak to the page's server: whoever was told its address, from the page itself, and nobody else.

The server listens on loopback, which every program and every web page that runs on this computer can reach. What keeps
them out: a token that nobody can guess is part of each address; the name under which the server is called must be its
own, so that no name that another site has pointed here (DNS rebinding) reaches it; and what another origin sends is
refused, even with the token.
"""

import hmac
from collections.abc import Mapping
from secrets import token_urlsafe
from typing import Final

TOKEN_HEADER: Final = "X-Mission-Token"  # noqa: S105 - a header's name
_TOKEN_BYTES: Final = 32
_OWN_SITES: Final = ("", "same-origin", "none")


class Guard:
    """Judges requests.

    Attributes:
        token: The secret part of the address.
        host: What requests have to name.
        origin: Where those that command have to come from.
    """

    def __init__(self, port: int) -> None:
        """Make a token for a server at a port of 127.0.0.1."""
        self.token = token_urlsafe(_TOKEN_BYTES)
        self.host = f"127.0.0.1:{port}"
        self.origin = f"http://{self.host}"

    @property
    def address(self) -> str:
        """Of the page."""
        return f"{self.origin}/{self.token}/"

    @property
    def policy(self) -> str:
        """The page's Content-Security-Policy: nothing but what comes from here, in no frame.

        The library for plots writes styles into its elements, and has icons in addresses of their own.
        """
        return (
            "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
            f"connect-src 'self' ws://{self.host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )

    def refusal(self, token: str, headers: Mapping[str, str], *, commands: bool, sends_origin: bool) -> str:
        """Why a request is refused; empty where it is not.

        Args:
            token: As it was in the address.
            headers: Of the request; names in any case.
            commands: Whether it asks for something to be done: then the token must be in a header, too.
            sends_origin: Whether browsers tell the origin of such a request: then it must be there.
        """
        tokens = [token, *([headers.get(TOKEN_HEADER, "")] if commands else [])]
        if not all(hmac.compare_digest(each.encode(), self.token.encode()) for each in tokens):
            return "this address is not known here"
        if headers.get("Host", "") != self.host:
            return "this server has another name"
        origin = headers.get("Origin", "" if sends_origin else self.origin)
        if origin != self.origin or headers.get("Sec-Fetch-Site", "") not in _OWN_SITES:
            return "this comes from another origin"
        return ""
