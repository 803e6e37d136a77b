"""What a link asks of signatures, once the vehicle holds a key."""

from enum import StrEnum


class SigningPolicy(StrEnum):
    """How a link deals with MAVLink 2 signatures.

    Attributes:
        REQUIRED: Only what is rightly signed is heard, and everything said is signed.
        ALLOWED: What is not signed is heard too; what is signed must be rightly so, and what is said in MAVLink 2 is.
        OFF: Signatures are neither looked at nor made.
    """

    REQUIRED = "required"
    ALLOWED = "allowed"
    OFF = "off"
