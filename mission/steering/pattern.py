"""Sparse matrices whose entries change, and not their places."""

import numpy as np
import scipy.sparse as sp

from mission.geometry.arrays import FloatArray, IntArray


class Pattern:
    """Where a sparse matrix has entries, each once; what they are differs from time to time.

    Args:
        rows: Of the entries, in any order.
        columns: Beside them.
        shape: Of the matrix.
    """

    def __init__(self, rows: IntArray, columns: IntArray, shape: tuple[int, int]) -> None:
        rows, columns = np.ravel(rows), np.ravel(columns)
        self._order = np.lexsort((rows, columns))
        self._rows = rows[self._order].astype(np.int32)
        self._begins = np.searchsorted(columns[self._order], np.arange(shape[1] + 1)).astype(np.int32)
        self._shape = shape

    def filled(self, entries: FloatArray) -> sp.csc_matrix:
        """The matrix with these entries, in the order in which the places were given."""
        return sp.csc_matrix((entries.ravel()[self._order], self._rows, self._begins), shape=self._shape)
