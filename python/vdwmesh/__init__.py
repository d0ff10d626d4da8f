"""Exact areas, volumes and topology of molecules, and meshes of their surfaces.

Lengths are in Å, areas in Å², volumes in Å³. Arrays that come out are read-only views of memory of
the C++ library, without a copy; ``numpy.array(a)`` makes a copy to write to.
"""

from vdwmesh._core import version as __version__
from vdwmesh._checks import (
    Comparison,
    DistanceStatistics,
    Distribution,
    Quality,
    compare,
    quality,
    signed_distance,
)
from vdwmesh._exact import ExactUnion, Topology, exact, sasa
from vdwmesh._mesh import Mesh, marching_cubes, mesh
from vdwmesh._molecule import Molecule, radii_of, read, sample
from vdwmesh.errors import (
    BackendUnavailable,
    CudaError,
    Error,
    FileFormatError,
    InternalError,
    InvalidInput,
    LimitExceeded,
)

__all__ = [
    "BackendUnavailable",
    "Comparison",
    "CudaError",
    "DistanceStatistics",
    "Distribution",
    "Error",
    "ExactUnion",
    "FileFormatError",
    "InternalError",
    "InvalidInput",
    "LimitExceeded",
    "Mesh",
    "Molecule",
    "Quality",
    "Topology",
    "__version__",
    "compare",
    "exact",
    "marching_cubes",
    "mesh",
    "quality",
    "radii_of",
    "read",
    "sample",
    "sasa",
    "signed_distance",
]
