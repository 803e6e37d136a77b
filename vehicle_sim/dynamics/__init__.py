"""Equations of motion, discretised exactly at a fixed step."""
