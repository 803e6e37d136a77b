"""How far an innovation is from what its covariance lets expect."""

from collections.abc import Sequence


def normalised_square(innovation: Sequence[float], covariance: Sequence[Sequence[float]]) -> float:
    """Return y' S^-1 y of an innovation y (n) and its symmetric, positive definite covariance S (n, n).

    Gaussian elimination without pivots, which S does not need, gives it as a sum of one term a row: for the two or
    three rows of a sensor that is many times faster than an inverse.
    """
    rest, rows, total = list(innovation), [list(row) for row in covariance], 0.0
    for i, row in enumerate(rows):
        y, pivot = rest[i], row[i]
        total += y * y / pivot
        for j in range(i + 1, len(rows)):
            share = rows[j][i] / pivot
            rest[j] -= share * y
            for k in range(i + 1, len(rows)):
                rows[j][k] -= share * row[k]
    return total
