"""The sans-I/O MAVLink endpoint: one file per service."""
