"""Areas as other programs draw them: GeoJSON, KML and KMZ, QGroundControl's plans, waypoints and fences."""
