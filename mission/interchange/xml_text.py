"""XML as it is written: text with the characters that XML can hold, and whole documents."""

import re
from typing import Final
from xml.etree import ElementTree as ET

_NO_CHARACTERS: Final = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def xml_text(text: str) -> str:
    """The text with a question mark for each character that no XML may hold, escaped or not (XML 1.0, 2.2)."""
    return _NO_CHARACTERS.sub("?", text)


def xml_document(root: ET.Element) -> bytes:
    """The document of an element, indented."""
    ET.indent(root)
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"
