"""Judges what others have made: written plans, and flights of which there is a log."""
