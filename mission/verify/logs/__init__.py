"""Logs of flights, of this program and of others, as one kind of values."""
