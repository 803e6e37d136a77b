"""The page: a flight while it is flown, or again afterwards, on this computer alone; nothing is commanded unasked."""
