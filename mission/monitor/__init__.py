"""What a flight has shown so far, and what to do about it."""
