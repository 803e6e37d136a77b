"""Automata on infinite words: translation of formulas, reduction, and complements."""
