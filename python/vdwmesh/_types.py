"""Names of array types, for annotations alone: numpy.typing takes longer to import than the package."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ids = NDArray[np.uint32]
Strings = NDArray[np.str_]

__all__ = ["ArrayLike", "Floats", "Ids", "NDArray", "Strings"]
