"""Triangulations, labelled regions and geodesy, on whole arrays."""
