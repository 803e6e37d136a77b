"""Formulas of linear temporal logic, as immutable values."""
