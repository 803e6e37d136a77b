"""Drone missions written in linear temporal logic, planned with a proof and flown over MAVLink."""
