"""Exact areas, volumes and topology of molecules, and meshes of their surfaces.

Lengths are in Å, areas in Å², volumes in Å³. Arrays that come out are read-only views of memory of
the C++ library, without a copy; ``numpy.array(a)`` makes a copy to write to.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vdwmesh._batch import BatchRow, ExactSets, batch, exact_many
    from vdwmesh._checks import (
        Comparison,
        DistanceStatistics,
        Distribution,
        Quality,
        compare,
        quality,
        signed_distance,
    )
    from vdwmesh._core import version as __version__
    from vdwmesh._cuda import CudaArray, CudaAtoms, CudaGradient, CudaMesh
    from vdwmesh._derivatives import Jacobian, Rates, jacobian, rates
    from vdwmesh._exact import ExactUnion, UnionGradient, exact, sasa
    from vdwmesh._excluded import (
        AccessibleComponent,
        ExcludedGradient,
        ExcludedMeasures,
        ExcludedShell,
        ExcludedSurface,
        ExcludedTopology,
    )
    from vdwmesh._frames import (
        FrameMesh,
        FrameResult,
        TrajectoryResult,
        frames,
        meshes,
        trajectory,
    )
    from vdwmesh._interface import Complementarity, Interface, Interfaces, interface
    from vdwmesh._measure import Counts, Topology, Void
    from vdwmesh._mesh import PATCH_KINDS, Mesh, marching_cubes, mesh, mesh_many
    from vdwmesh._molecule import Molecule, radii_of, read, sample
    from vdwmesh._pocket_frames import PocketFrame, pocket_frames, pocket_table
    from vdwmesh._pockets import Mouth, Pocket, pockets
    from vdwmesh._residues import ResidueAreas, residue_areas, residue_table
    from vdwmesh.errors import (
        BackendUnavailable,
        CudaError,
        Error,
        FileFormatError,
        FileMissing,
        InternalError,
        InvalidInput,
        LimitExceeded,
    )

__all__ = [
    "AccessibleComponent",
    "BackendUnavailable",
    "BatchRow",
    "Comparison",
    "Complementarity",
    "Counts",
    "CudaArray",
    "CudaAtoms",
    "CudaError",
    "CudaGradient",
    "CudaMesh",
    "DistanceStatistics",
    "Distribution",
    "Error",
    "ExactSets",
    "ExactUnion",
    "ExcludedGradient",
    "ExcludedMeasures",
    "ExcludedShell",
    "ExcludedSurface",
    "ExcludedTopology",
    "FileFormatError",
    "FileMissing",
    "FrameMesh",
    "FrameResult",
    "Interface",
    "Interfaces",
    "InternalError",
    "InvalidInput",
    "Jacobian",
    "LimitExceeded",
    "Mesh",
    "Molecule",
    "Mouth",
    "PATCH_KINDS",
    "Pocket",
    "PocketFrame",
    "Quality",
    "Rates",
    "ResidueAreas",
    "Topology",
    "TrajectoryResult",
    "UnionGradient",
    "Void",
    "__version__",
    "batch",
    "compare",
    "exact",
    "exact_many",
    "frames",
    "interface",
    "jacobian",
    "marching_cubes",
    "mesh",
    "mesh_many",
    "meshes",
    "pocket_frames",
    "pocket_table",
    "pockets",
    "quality",
    "radii_of",
    "rates",
    "read",
    "residue_areas",
    "residue_table",
    "sample",
    "sasa",
    "signed_distance",
    "trajectory",
]

# Where each name is. A module is imported when one of its names is first used (PEP 562), because
# NumPy takes longer to import than all of this package.
_HOMES = {
    "_batch": "BatchRow ExactSets batch exact_many",
    "_checks": "Comparison DistanceStatistics Distribution Quality "
    "compare quality signed_distance",
    "_cuda": "CudaArray CudaAtoms CudaGradient CudaMesh",
    "_derivatives": "Jacobian Rates jacobian rates",
    "_exact": "ExactUnion UnionGradient exact sasa",
    "_excluded": "AccessibleComponent ExcludedGradient ExcludedMeasures ExcludedShell ExcludedSurface ExcludedTopology",
    "_frames": "FrameMesh FrameResult TrajectoryResult frames meshes trajectory",
    "_interface": "Complementarity Interface Interfaces interface",
    "_measure": "Counts Topology Void",
    "_mesh": "Mesh PATCH_KINDS marching_cubes mesh mesh_many",
    "_molecule": "Molecule radii_of read sample",
    "_pocket_frames": "PocketFrame pocket_frames pocket_table",
    "_pockets": "Mouth Pocket pockets",
    "_residues": "ResidueAreas residue_areas residue_table",
    "errors": "BackendUnavailable CudaError Error FileFormatError FileMissing "
    "InternalError InvalidInput LimitExceeded",
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names.split()}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("vdwmesh._core").version
    if name not in _HOME_OF:
        raise AttributeError(f"module 'vdwmesh' has no attribute {name!r}")
    value = getattr(import_module(f"vdwmesh.{_HOME_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
