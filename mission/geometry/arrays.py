"""The array types of the package, and how to freeze them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def frozen_floats(values: Any) -> FloatArray:  # noqa: ANN401 - whatever numpy can read
    """Copy ``values`` into a read-only float array."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def frozen_ints(values: Any) -> IntArray:  # noqa: ANN401 - whatever numpy can read
    """Copy ``values`` into a read-only integer array."""
    array = np.array(values, dtype=np.int64)
    array.setflags(write=False)
    return array
