"""What a page shows of a flight and lets people move through: the map, the histories, and what links the two."""
