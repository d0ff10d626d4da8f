"""Meshes of unions of balls, of blended fields and of volumes."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Iterable, Iterator

import numpy as np

from vdwmesh import _core, _sinks
from vdwmesh._arrays import floats, given_number, number, thread_count, view
from vdwmesh._cuda import CudaInput, CudaMesh, HasCudaArray, packed
from vdwmesh._sources import arrays_anywhere, joined
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, Ids, NDArray


PATCH_KINDS = ("contact", "saddle", "concave")


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh. ``vertices, faces, normals = mesh`` takes it apart.

    Attributes
    ----------
    vertices : ndarray of float64, shape (V, 3)
        Å.
    faces : ndarray of uint32, shape (F, 3)
        Vertices of each triangle, counter-clockwise seen from outside.
    normals : ndarray of float32, shape (V, 3), or None
        Unit vectors, outward.
    vertex_atoms, face_atoms : ndarray of uint32, shape (V,) and (F,), or None
        The atom that a vertex lies on, and the one whose patch a triangle is part of.
    face_patches : ndarray of uint32, shape (F,), or None
        Of the solvent-excluded surface: the patch that a triangle is part of, a row of `patch_kinds`
        and `patch_atoms`.
    patch_kinds : ndarray of uint8, shape (P,), or None
        0 contact, 1 saddle, 2 concave: an index into ``vdwmesh.PATCH_KINDS``.
    patch_atoms : ndarray of int32, shape (P, 3), or None
        The one, two, or first three atoms of a patch, ascending; -1 for none.
    mean_curvature, gaussian_curvature : ndarray of float32, shape (V,), or None
        Of the solvent-excluded surface, 1/Å and 1/Å², in closed form, positive where it is convex.
        Between patches the mean of theirs; in a cusp without that of the saddle, which is infinite, and
        NaN where there is no other.
    cuda : CudaMesh or None
        The arrays in the memory of the device that made the mesh, if the coordinates were there. The
        other attributes are then copies on the host, made when the first of them is used.
    """

    _source: _core.MeshHandle | _core.CudaMeshHandle = field(repr=False)

    def __reduce__(self) -> Any:  # for pickle: the arrays on the host
        return Mesh, (self._handle,)

    @classmethod
    def _of(cls, source: _core.MeshHandle | _core.CudaMeshHandle) -> Mesh:
        return cls(source)

    @cached_property
    def _handle(self) -> _core.MeshHandle:
        return self._source.download() if isinstance(self._source, _core.CudaMeshHandle) else self._source

    @cached_property
    def cuda(self) -> CudaMesh | None:
        return CudaMesh._of(self._source) if isinstance(self._source, _core.CudaMeshHandle) else None

    @cached_property
    def vertices(self) -> Floats:
        return view(self._handle.vertices())

    @cached_property
    def faces(self) -> Ids:
        return view(self._handle.faces())

    @cached_property
    def normals(self) -> NDArray[np.float32] | None:
        return _view_or_none(self._handle.normals())

    @cached_property
    def vertex_atoms(self) -> Ids | None:
        return _view_or_none(self._handle.vertex_atoms())

    @cached_property
    def face_atoms(self) -> Ids | None:
        return _view_or_none(self._handle.face_atoms())

    @cached_property
    def face_patches(self) -> Ids | None:
        return _view_or_none(self._handle.face_patches())

    @cached_property
    def patch_kinds(self) -> NDArray[np.uint8] | None:
        return _view_or_none(self._handle.patch_kinds())

    @cached_property
    def patch_atoms(self) -> NDArray[np.int32] | None:
        return _view_or_none(self._handle.patch_atoms())

    @property
    def face_kinds(self) -> NDArray[np.uint8] | None:
        """The kind of patch of each triangle, as `patch_kinds`."""
        if self.patch_kinds is None or self.face_patches is None:
            return None
        return self.patch_kinds[self.face_patches]

    @cached_property
    def _curvatures(self) -> tuple[NDArray[np.float32] | None, NDArray[np.float32] | None]:
        found = self._handle.curvatures()
        return (None, None) if found is None else (view(found[0]), view(found[1]))

    @property
    def mean_curvature(self) -> NDArray[np.float32] | None:
        return self._curvatures[0]

    @property
    def gaussian_curvature(self) -> NDArray[np.float32] | None:
        return self._curvatures[1]

    def __iter__(self) -> Iterator[Any]:
        return iter((self.vertices, self.faces, self.normals))

    def __repr__(self) -> str:
        arrays = self.cuda or self
        return f"<vdwmesh.Mesh of {len(arrays.vertices)} vertices, {len(arrays.faces)} faces>"

    @cached_property
    def _summary(self) -> dict[str, Any]:
        return _core.summary(self._handle)

    @property
    def area(self) -> float:
        """Area, Å²."""
        return float(self._summary["area"])

    @property
    def volume(self) -> float:
        """Volume inside, Å³; NaN if the mesh is not closed and oriented."""
        found = self._summary["volume"]
        return float("nan") if found is None else float(found)

    @property
    def euler_characteristic(self) -> int:
        """Vertices - edges + faces."""
        return int(self._summary["euler_characteristic"])

    @property
    def is_closed(self) -> bool:
        """Whether every edge is on two faces."""
        return bool(self._summary["closed"])

    def save(self, path: str | os.PathLike[str], *, ascii: bool = False, scale: float = 1.0) -> None:
        """Write a mesh file: .ply, .obj, .off, .stl, .glb, .msh, .msh4, .vtp, .vtu or .3mf, by the extension.

        PLY and STL are binary, or text with ``ascii=True``. Coordinates are multiplied by `scale`, so 0.1
        writes nm. Losses of the format, such as float32 coordinates, are warnings.
        """
        for loss in self._handle.save(os.fsencode(path), bool(ascii), float(scale)):
            warnings.warn(loss, stacklevel=2)

    def to_trimesh(self) -> Any:
        """The mesh as a ``trimesh.Trimesh``, whose vertices stay as they are (process=False)."""
        return _sinks.to_trimesh(self)

    def to_pyvista(self) -> Any:
        """The mesh as a ``pyvista.PolyData``."""
        return _sinks.to_pyvista(self)

    def to_meshio(self) -> Any:
        """The mesh as a ``meshio.Mesh``."""
        return _sinks.to_meshio(self)

    def to_open3d(self) -> Any:
        """The mesh as an ``open3d.geometry.TriangleMesh``."""
        return _sinks.to_open3d(self)


def _view_or_none(owner: Any) -> NDArray[Any] | None:
    return None if owner is None else view(owner)


def mesh(
    coords: Any,
    radii: ArrayLike | HasCudaArray | str | None = None,
    *,
    probe: float | None = None,
    surface: str = "vdw",
    mesher: str | None = None,
    field: str = "vdw",
    spacing: float | None = None,
    edge_length: float | ArrayLike | None = None,
    density: float | None = None,
    max_distance: float | None = None,
    min_angle: float | None = None,
    subdivide: int = 0,
    crossings: str | None = None,
    normals: bool = True,
    fixed_grid: bool = False,
    threads: int | None = None,
    device: str = "auto",
) -> Mesh:
    """Mesh of the surface of a molecule: closed, 2-manifold, oriented outwards.

    Parameters
    ----------
    coords, radii, threads
        As for `exact`. From coordinates in the memory of a CUDA device the mesh is made there, and
        stays there as `Mesh.cuda`. The exact mesher copies the atoms to the host, which does its part.
    probe : float, optional
        Radius of a probe, Å. Balls grow by it, by default by nothing, and for "sas" by 1.4; over the
        atoms of the solvent-excluded surface it rolls, with a radius of 1.4 by default.
    surface : {"vdw", "sas", "ses"}
        The boundary of the balls, the accessible surface, or the solvent-excluded surface (also
        "excluded"), whose mesh follows the curves between its patches (`Mesh.face_patches`).
    mesher : {"exact", "marching-cubes"}, optional
        "exact" follows the creases between the spheres and has the topology of the union;
        "marching-cubes" walks a grid. By default "exact", but with spacing, fixed_grid or a blended
        field, which marching cubes alone have.
    field : {"vdw", "blinn", "soft", "inverse-squared"}
        Of marching cubes: the union of the balls, or a blended field.
    spacing : float, optional
        Of the grid of marching cubes, Å; 0.5 by default.
    edge_length : float or array_like, shape (N,), optional
        Of the exact mesher, Å, 0.35 by default, for all atoms or by atom; edges are shorter at narrow features, and where
        atoms meet the shorter length holds. ``0.2 * radii`` gives every atom as many triangles.
    density : float, optional
        Of the "ses" surface, triangles per Å²: any number, in place of an edge length. The mesh then goes across
        the curves between patches, where the surface is smooth, and has fewer and better triangles; so it does
        for an edge length above 0.7. Vertices lie on the exact surface, and the topology is the exact one.
    max_distance : float, optional
        Of the "ses" surface, Å, in place of a density: few triangles, nowhere farther from the surface, nor
        the surface from them; the distance is proven.
    min_angle : float, optional
        Of the exact mesher, degrees, at most 25: triangles with a smaller angle are made better, but near
        corners where two creases of an atom enclose less than 60°. At 20° none is left elsewhere on
        molecules, above that a few. It holds before a subdivision, and the CPU makes such meshes.
    subdivide : int
        Levels of midpoint subdivision, each with projection to the surface.
    crossings : {"undo", "allow"}, optional
        Of marching cubes that are subdivided: whether moves of a projection after which triangles cross are taken back, which costs several
        times the projection, or stay. "undo" by default.
    normals : bool
        Whether the mesh has normals.
    fixed_grid : bool
        Of marching cubes: nodes lie at multiples of the spacing wherever the atoms are, so meshes of
        frames change only where atoms move. By default the grid moves with the molecule.
    device : {"auto", "cpu", "cuda"}
        Where marching cubes, the patches of the exact mesher and subdivision run.

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidInput
        An argument is wrong; the message names it.
    LimitExceeded
        The mesh would not fit the memory of the machine or the device.
    BackendUnavailable
        Coordinates are on a CUDA device that cannot be used.

    Examples
    --------
    >>> import vdwmesh
    >>> ball = vdwmesh.mesh([[0, 0, 0]], [1.7], edge_length=0.1)
    >>> ball.is_closed, ball.euler_characteristic
    (True, 2)
    """
    centers, sizes, _ = arrays_anywhere(coords, radii, device)
    if isinstance(subdivide, bool) or not isinstance(subdivide, (int, np.integer)) or subdivide < 0:
        raise InvalidInput(f"subdivide: {subdivide!r} is no number of levels")
    options: dict[str, Any] = {
        "surface": surface,
        "probe": given_number("probe", probe),
        "mesher": mesher,
        "field": field,
        "spacing": _positive("spacing", spacing),
        **_edge_lengths(edge_length, len(sizes)),
        "density": _positive("density", density),
        "max_distance": _positive("max_distance", max_distance),
        "min_angle": _positive("min_angle", min_angle),
        "subdivide": int(subdivide),
        "crossings": crossings,
        "normals": bool(normals),
        "fixed_grid": bool(fixed_grid),
        "device": device,
    }
    cores = thread_count(threads)
    if isinstance(centers, CudaInput):
        there = centers.as_frames().packed
        return Mesh._of(_core.mesh_on_device(there, packed(sizes), cores, **options))
    return Mesh._of(_core.mesh(centers, sizes, cores, **options))


def mesh_many(
    molecules: Iterable[Any],
    radii: Iterable[ArrayLike] | str | None = None,
    *,
    probe: float = 0.0,
    field: str = "vdw",
    spacing: float = 0.5,
    normals: bool = True,
    fixed_grid: bool = False,
    threads: int | None = None,
    device: str = "auto",
) -> list[Mesh]:
    """Meshes of many molecules by marching cubes, in one call.

    Each mesh is that of ``mesh(..., mesher="marching-cubes")`` for the molecule alone. On a CUDA
    device small molecules are meshed many times faster than one after another.

    Parameters
    ----------
    molecules : iterable
        Of what `mesh` takes as `coords`, on the host.
    radii : str or iterable of array_like, optional
        The name of a set for all molecules, or the radii of each.
    probe, field, spacing, normals, fixed_grid, threads, device
        As for `mesh`.

    Returns
    -------
    list of Mesh
        In the order of the molecules.

    Raises
    ------
    InvalidInput
        An argument is wrong; the message names it.
    LimitExceeded
        The meshes would not fit the memory of the machine.

    Examples
    --------
    >>> import vdwmesh
    >>> balls = vdwmesh.mesh_many([[[0, 0, 0]], [[5, 0, 0], [6, 0, 0]]], [[1.7], [1.7, 1.2]])
    >>> [one.is_closed for one in balls]
    [True, True]
    """
    given = list(molecules)
    options: dict[str, Any] = {
        "surface": "vdw",
        "probe": number("probe", probe),
        "mesher": "marching-cubes",
        "field": field,
        "spacing": _positive("spacing", spacing),
        "normals": bool(normals),
        "fixed_grid": bool(fixed_grid),
        "device": device,
    }
    cores = thread_count(threads)
    if not given:
        return []
    centers, sizes, offsets = joined("molecules", given, radii)
    made = _core.mesh_many(centers, sizes, offsets.tolist(), cores, **options)
    return [Mesh._of(one) for one in made]


def _edge_lengths(value: Any, atoms: int) -> dict[str, Any]:
    if value is None or np.ndim(value) == 0:
        return {"edge_length": _positive("edge_length", value)}
    lengths = floats("edge_length", value, "(N,)").astype(np.float64)
    if len(lengths) != atoms:
        raise InvalidInput(f"edge_length: has {len(lengths)} values for {atoms} atoms")
    if not (np.isfinite(lengths) & (lengths > 0)).all():
        raise InvalidInput("edge_length: has values that are not above 0")
    return {"edge_lengths": lengths}


def _positive(name: str, value: Any) -> float | None:
    found = given_number(name, value)
    if found is not None and not (found > 0 and np.isfinite(found)):
        raise InvalidInput(f"{name}: {found:g} is not above 0")
    return found


def marching_cubes(
    volume: ArrayLike,
    level: float,
    *,
    spacing: ArrayLike = (1, 1, 1),
    origin: ArrayLike = (0, 0, 0),
    threads: int | None = None,
    device: str = "auto",
) -> Mesh:
    """Isosurface of a volume, with the call of ``skimage.measure.marching_cubes``.

    Values at or above the level are inside. Unlike scikit-image's, the mesh is always closed: what
    the border of the volume cuts is closed there.

    Parameters
    ----------
    volume : array_like, shape (X, Y, Z)
        Values at nodes; float32 is meshed as it is, everything else is rounded to it.
    level : float
        Isovalue.
    spacing, origin : array_like, shape (3,)
        Node (i, j, k) lies at origin + spacing * (i, j, k).
    threads : int, optional
        At most so many; all cores by default.
    device : {"auto", "cpu", "cuda"}

    Returns
    -------
    Mesh
        Without atoms. It has no faces if the level is nowhere crossed.

    Examples
    --------
    >>> import numpy, vdwmesh
    >>> x, y, z = numpy.mgrid[-1:1:33j, -1:1:33j, -1:1:33j]
    >>> ball = vdwmesh.marching_cubes(0.5 - numpy.sqrt(x**2 + y**2 + z**2), 0)
    >>> ball.euler_characteristic
    2
    """
    values = floats("volume", volume, "(X, Y, Z)")
    if not np.isfinite(values).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(values))[0])
        raise InvalidInput(f"volume[{place}]: {values[place]} is not finite")
    if min(values.shape) < 2:
        raise InvalidInput(f"volume: has shape {values.shape}; two nodes along each axis are needed")
    isovalue = number("level", level)
    if not np.isfinite(isovalue):
        raise InvalidInput(f"level: {isovalue} is not finite")
    steps = _triple("spacing", spacing)
    if not (steps > 0).all():
        raise InvalidInput(f"spacing: {tuple(steps.tolist())} is not above 0")
    return Mesh._of(
        _core.marching_cubes(
            np.ascontiguousarray(values),
            isovalue,
            steps.tolist(),
            _triple("origin", origin).tolist(),
            thread_count(threads),
            device,
        )
    )


def _triple(name: str, value: ArrayLike) -> NDArray[Any]:
    array = floats(name, value, "(3,)")
    if array.shape != (3,) or not np.isfinite(array).all():
        raise InvalidInput(f"{name}: three finite numbers are needed")
    return array
