"""Covering regions: lanes, the ways between them, their order, and what of a region was covered. Pure geometry.

``cover`` (``mission.coverage.covering``) takes shapely shapes and gives a frozen ``Coverage``::

    coverage = cover(
        region,              # Polygon | MultiPolygon: to be covered
        ground,              # Polygon | MultiPolygon: where lanes may lie, the region less clearance and tube
        free,                # Polygon | MultiPolygon: where ways may lie, less the tube; contains the ground
        spacing_m=8.0,
        entry_m=(x, y),      # in free space
        exit_m=None,         # or (x, y)
        heading_deg=None,    # clockwise from north; None is for the program to choose
        pace=Pace(speed_m_s=5.0, acceleration_m_s2=2.5, jerk_m_s3=4.0, reach_m=4.0),
        share=0.98,          # of the region; 1 for all that can be reached
    )
    coverage.lanes_m         # (n, 2, 2) in the order flown: lane, begin and end, xy
    coverage.cell_of         # (n,), -1 for a lane of its own along a rim
    coverage.ways_m          # n - 1 arrays (k, 2), from the end of a lane to the begin of the next
    coverage.approach_m      # (k, 2), from the entry to the first lane
    coverage.leaving_m       # (k, 2), from the last lane to the exit; (0, 2) without one
    coverage.line_m          # (p, 2), from the first lane's begin to the last lane's end
    coverage.on_lane         # (p - 1,), of each of its pieces whether it is a lane
    coverage.lanes_length_m, coverage.ways_length_m, coverage.duration_s, coverage.heading_deg
    coverage.exact, coverage.complete

All failures are ``GeometryError``. Spacing and trigger distance of a camera are in ``mission.spec.camera``, what a
flight has covered in ``mission.coverage.flown``.
"""
