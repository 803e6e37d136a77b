"""What a log says of a flight, and what it leaves open."""
