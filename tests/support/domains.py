"""Domains that several tests share."""

import numpy as np

PAPER_NODES = np.array(
    [
        (0.0, 0.0),
        (0.0, 10.0),
        (15.0, 10.0),
        (15.0, 0.0),
        (6.0, 10.0),
        (9.0, 10.0),
        (11.0, 0.0),
        (2.0, 8.0),
        (8.0, 7.0),
        (11.0, 2.0),
        (5.0, 5.0),
    ]
)
"""The nodes of the paper's survey domain (Fig. 1)."""

PAPER_TRIANGLES = [
    [5, 8, 2],
    [7, 1, 0],
    [5, 4, 8],
    [7, 4, 1],
    [6, 10, 0],
    [10, 7, 0],
    [4, 10, 8],
    [10, 4, 7],
    [8, 9, 2],
    [9, 3, 2],
    [9, 6, 3],
    [10, 9, 8],
    [9, 10, 6],
]
"""The triangles of Fig. 2 by their vertices, T0 to T12."""


def random_nodes(seed: int, count: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Random nodes in the rectangle of 150 m x 100 m, reproducible from the seed."""
    return np.random.default_rng(seed).uniform((0.0, 0.0), (150.0, 100.0), (count, 2))
