"""Points of an even lattice: where a mesh has to be fine away from all outlines, they are its vertices."""

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray


def lattice(domain: shapely.Geometry, spacing_m: float) -> FloatArray:
    """The points of a lattice of equilateral triangles that lie in a domain, row by row, shape (P, 2).

    Rows end where the domain does, so that a long and narrow one costs what its area does.
    """
    left, low, right, high = domain.bounds
    heights = np.arange(low, high, spacing_m * np.sqrt(0.75))
    ends = np.stack(
        (np.broadcast_to([left, right], (len(heights), 2)), np.repeat(heights[:, None], 2, axis=1)), axis=-1
    )
    # All rows at once: each by itself would go over the whole domain.
    parts = shapely.get_parts(shapely.intersection(shapely.multilinestrings(shapely.linestrings(ends)), domain))
    parts = parts[shapely.get_dimensions(parts) == 1]
    row = np.rint((shapely.bounds(parts)[:, 1] - low) / (spacing_m * np.sqrt(0.75))).astype(np.int64)
    order = np.lexsort((shapely.bounds(parts)[:, 0], row))
    parts, row = parts[order], row[order]
    begins, _, finishes, _ = shapely.bounds(parts).T
    shift = left + np.where(row % 2, spacing_m / 2.0, 0.0)
    first = np.ceil((begins - shift) / spacing_m)
    counts = np.maximum(np.floor((finishes - shift) / spacing_m) - first + 1.0, 0.0).astype(np.int64)
    number = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    x = np.repeat(shift + first * spacing_m, counts) + number * spacing_m
    return np.stack((x, np.repeat(heights[row], counts)), axis=1)
