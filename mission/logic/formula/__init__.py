"""Formulas of linear temporal logic: their syntax, their meaning on lasso words, and rewriting."""
