"""Formulas with bounds in seconds: metric temporal logic over dense time."""
