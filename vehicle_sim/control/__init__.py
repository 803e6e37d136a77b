"""Tracking laws: what acceleration, attitude and thrust follow from where the vehicle is and should be."""
