"""Measures and quality of meshes of any origin, and their distance to exact surfaces."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import Brief, file_name, floats, given_number, number, view
from vdwmesh._mesh import Mesh
from vdwmesh._sources import arrays_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats


@dataclass(frozen=True)
class Distribution:
    """Distribution of some values; NaN if there are none."""

    min: float
    p01: float
    median: float
    p99: float
    max: float
    mean: float


@dataclass(frozen=True)
class Quality:
    """Measures, topology and quality of a mesh. What has no value for the mesh is None.

    Attributes
    ----------
    vertices, edges, triangles : int
    area, volume : float
        Å², Å³; the volume of closed, oriented meshes only, as are the areas of shells.
    outer_area, void_area : float
        Å², of shells that face outwards and inwards.
    shells, components, voids, genus : int
        Connected pieces; those of positive and of negative volume; handles.
    euler_characteristic : int
    closed, manifold, oriented : bool
    degenerate_triangles : int
        With a repeated vertex, or of area 0.
    self_intersections : int or None
        Pairs of triangles that cross; None unless asked for.
    min_angle_deg, aspect_ratio, edge_length : Distribution
        Smallest angle of each triangle, degrees; circumradius / (2 inradius); Å.
    """

    vertices: int
    edges: int
    triangles: int
    area: float
    volume: float | None
    outer_area: float | None
    void_area: float | None
    shells: int
    components: int | None
    voids: int | None
    genus: int | None
    euler_characteristic: int
    closed: bool
    manifold: bool
    oriented: bool
    degenerate_triangles: int
    self_intersections: int | None
    min_angle_deg: Distribution
    aspect_ratio: Distribution
    edge_length: Distribution

    def to_dict(self) -> dict[str, Any]:
        """The values under the keys of the block "mesh" of the program's report."""
        return asdict(self)


@dataclass(frozen=True)
class DistanceStatistics:
    """Distances from samples of one surface to the other, weighted by area, Å.

    `mean_error` and `rms_error` are the standard errors; `max` is a lower bound of the maximum.
    """

    mean: float
    rms: float
    max: float
    p50: float
    p95: float
    p99: float
    mean_error: float
    rms_error: float
    samples: int


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Brief):
    """A mesh beside the exact union of balls.

    Attributes
    ----------
    area, volume, exact_area, exact_volume : float
        Å², Å³; of the mesh (None if it has no volume) and of the union.
    area_relative_error, volume_relative_error : float
        (mesh - exact) / exact.
    euler_characteristic_difference : int or None
        Of the mesh, minus that of the boundary of the union.
    mesh_to_surface, surface_to_mesh : DistanceStatistics
    hausdorff_lower_bound : float
        Å, of the samples.
    hausdorff_upper_bound : float or None
        Å, proven: no point of either surface is farther from the other. Of the excluded surface.
    face_distance : ndarray of float64, shape (F,)
        Signed distance of the centre of each face to the exact surface, Å; positive outside.
    notes : tuple of str
        What was done to a mesh file when it was read.
    """

    area: float
    volume: float | None
    exact_area: float
    exact_volume: float
    area_relative_error: float
    volume_relative_error: float | None
    euler_characteristic_difference: int | None
    mesh_to_surface: DistanceStatistics
    surface_to_mesh: DistanceStatistics
    hausdorff_lower_bound: float
    hausdorff_upper_bound: float | None
    face_distance: Floats
    notes: tuple[str, ...]


def quality(mesh: Any, *, self_intersections: bool = False) -> Quality:
    """Measures, topology and quality of a mesh.

    Parameters
    ----------
    mesh : Mesh, (vertices, faces), path, or an object of trimesh, PyVista, meshio or Open3D
    self_intersections : bool
        Whether pairs of triangles that cross are counted, which takes longer.

    Returns
    -------
    Quality

    Raises
    ------
    InvalidInput
        A face names a vertex that is not there, or an argument is no mesh.

    Examples
    --------
    >>> import vdwmesh
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> found = vdwmesh.quality((tetrahedron, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    >>> found.closed, found.euler_characteristic, round(found.volume, 6)  # 1/6
    (True, 2, 0.166667)
    """
    handle, _ = _handle(mesh)
    found = _core.quality(handle, bool(self_intersections))
    for name in ("min_angle_deg", "aspect_ratio", "edge_length"):
        found[name] = Distribution(**found[name])
    return Quality(**{field.name: found[field.name] for field in fields(Quality)})


def compare(
    mesh: Any,
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    probe: float | None = None,
    surface: Literal["vdw", "sas", "ses", "excluded"] = "vdw",
    samples: float | None = None,
    seed: int = 1,
) -> Comparison:
    """How far a mesh is from the exact surface that it approximates.

    Parameters
    ----------
    mesh : as for `quality`
    coords, radii, probe, surface
        As for `exact`: the union of the balls, or the complete solvent-excluded surface.
    samples : float, optional
        Per Å², 10 by default; more where that makes fewer than 10,000 in all.
    seed : int
        Of the random places of the samples.

    Returns
    -------
    Comparison

    Examples
    --------
    >>> import vdwmesh
    >>> ball = vdwmesh.mesh([[0, 0, 0]], [1.0], edge_length=0.1)
    >>> error = vdwmesh.compare(ball, [[0, 0, 0]], [1.0])
    >>> error.euler_characteristic_difference, error.hausdorff_lower_bound < 0.01
    (0, True)
    """
    centers, sizes, _ = arrays_of(coords, radii)
    density = 10.0 if samples is None else number("samples", samples)
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or not 0 <= seed < 2**64:
        raise InvalidInput(f"seed: {seed!r} is no whole number from 0 to 2^64 - 1")
    handle, notes = _handle(mesh)
    radius = given_number("probe", probe)
    found = _core.compare(handle, centers, sizes, surface, radius, density, int(seed))
    found["face_distance"] = view(found["face_distance"])
    for name in ("mesh_to_surface", "surface_to_mesh"):
        found[name] = DistanceStatistics(**found[name])
    return Comparison(notes=tuple(notes), **found)


def signed_distance(
    points: ArrayLike,
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    probe: float | None = None,
    surface: Literal["vdw", "sas", "ses", "excluded"] = "vdw",
) -> Floats:
    """Distance of points to the exact surface, Å: positive outside, negative inside.

    Parameters
    ----------
    points : array_like, shape (P, 3)
        Å.
    coords, radii, probe, surface
        As for `exact`: the union of the balls, or the complete solvent-excluded surface.

    Returns
    -------
    ndarray of float64, shape (P,)

    Examples
    --------
    >>> import vdwmesh
    >>> vdwmesh.signed_distance([[3, 0, 0], [0, 0, 0.5]], [[0, 0, 0]], [1.0])
    array([ 2. , -0.5])

    Between two balls a probe of radius 3 stays away from the middle of their axis.

    >>> vdwmesh.signed_distance([[0, 0, 0]], [[-2, 0, 0], [2, 0, 0]], [2.0, 2.0], probe=3, surface="excluded").round(4)
    array([-1.5826])
    """
    centers, sizes, _ = arrays_of(coords, radii)
    places = floats("points", points, "(P, 3)")
    return view(_core.signed_distance(places, centers, sizes, surface, given_number("probe", probe)))


def _handle(mesh: Any) -> tuple[_core.MeshHandle, list[str]]:
    """The mesh that the argument is, and notes about how its file was read."""
    if isinstance(mesh, Mesh):
        return mesh._handle, []
    if isinstance(mesh, (str, os.PathLike)):
        return _core.read_mesh(file_name(mesh))
    vertices, faces = _arrays(mesh)
    rows = floats("vertices", vertices, "(V, 3)")
    corners = np.asarray(faces)
    if corners.ndim != 2 or corners.shape[1] != 3 or corners.dtype.kind not in "iu":
        raise InvalidInput(
            f"faces: has shape {corners.shape} of {corners.dtype}; whole numbers (F, 3) are needed"
        )
    outside = (corners < 0) | (corners >= len(rows))
    if outside.any():
        first = int(np.flatnonzero(outside.any(axis=1))[0])
        raise InvalidInput(f"faces[{first}]: {corners[first].tolist()} names no vertex of {len(rows)}")
    return _core.mesh_of_arrays(rows, np.ascontiguousarray(corners, np.uint32).ravel()), []


def _arrays(mesh: Any) -> tuple[Any, Any]:
    """Vertices and faces of what other packages call a mesh, by the names of their attributes."""
    package = type(mesh).__module__.partition(".")[0]
    if package == "open3d":
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    if package == "meshio":
        return mesh.points, _triangles_of_meshio(mesh)
    if package == "pyvista":
        faces = np.asarray(mesh.faces)
        if faces.size % 4 != 0 or (faces[::4] != 3).any():
            raise InvalidInput("mesh: has faces that are no triangles; mesh.triangulate() cuts them")
        return mesh.points, faces.reshape(-1, 4)[:, 1:]
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    if isinstance(mesh, (tuple, list)) and len(mesh) >= 2:
        return mesh[0], mesh[1]
    raise InvalidInput(f"mesh: {type(mesh).__name__} is no mesh, path or (vertices, faces)")


def _triangles_of_meshio(mesh: Any) -> Any:
    """The faces; quadrilaterals and polygons are cut into triangles from their first corner on."""
    parts: list[Any] = [np.empty((0, 3), np.int64)]
    for cells in mesh.cells:
        if cells.dim != 2:
            continue  # points, lines and solids have no faces of their own
        if cells.type not in ("triangle", "quad", "polygon"):
            raise InvalidInput(f"mesh: has faces of type {cells.type}, which are not flat triangles")
        corners = np.asarray(cells.data)
        parts.extend(corners[:, [0, k, k + 1]] for k in range(1, corners.shape[1] - 1))
    return np.concatenate(parts)
