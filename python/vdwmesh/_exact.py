"""Exact area, volume and topology of unions of balls."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, cast, overload

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import Brief, chosen, floats, refuse_masked, view
from vdwmesh._cuda import CudaArray, CudaAtoms, CudaInput, HasCudaArray, is_on_device, on_device
from vdwmesh._excluded import ExcludedMeasures, measure_excluded
from vdwmesh._measure import Counts, InvalidFrame, Options, Topology, as_arrays, measure, measure_gradient_there
from vdwmesh._sources import Atoms, arrays_anywhere, arrays_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, Ids, NDArray


_FRAMES_AT_ONCE = 64  # of which the areas of all atoms are kept at a time


@dataclass(frozen=True, eq=False, repr=False)
class UnionGradient(Brief):
    """Exact derivatives of the weighted sums of the atoms' areas and volumes.

    Attributes
    ----------
    area_coords : ndarray of float64, shape (N, 3)
        Of the sum of areas by each centre, Å.
    area_radii : ndarray of float64, shape (N,)
        By each radius, Å.
    volume_coords, volume_radii : ndarray of float64, shapes (N, 3) and (N,)
        Of the sum of volumes, Å².
    kink_atoms : int
        Atoms that touch another one, or equal it: they may have no derivative. They get that of the
        atoms without contact; of equal atoms the first gets it, and the others 0.
    """

    area_coords: Floats
    area_radii: Floats
    volume_coords: Floats
    volume_radii: Floats
    kink_atoms: int


@dataclass(frozen=True, eq=False, repr=False)
class ExactUnion(Brief):
    """Area and volume of a union of balls, from its geometry, without a mesh.

    Attributes
    ----------
    area, volume : float
        Å², Å³; of the atoms that were measured.
    atom_area, atom_volume : ndarray of float64, shape (N,)
        The exposed part of each sphere, Å², and the part of each ball that is nearer to it than to
        all others (by power), Å³. NaN for atoms that were not to be measured.
    counts : Counts or None
    topology : Topology or None
        None where they were not asked for.
    method : {"cgal", "arcs", "both"}
        What computed them.
    check_area, check_volume : float or None
        By arcs, with ``method="both"``.
    fallback_atoms : int
        Atoms of which the arcs failed a check, so that a triangulation measured them.
    cuda : CudaAtoms or None
        Measures of the atoms in the memory of the device, if the coordinates were there.
    gradient : UnionGradient or None
        None where it was not asked for, and where coordinates are on a device: `cuda` has it there.
    """

    area: float
    volume: float
    atom_area: Floats
    atom_volume: Floats
    counts: Counts | None
    topology: Topology | None
    method: str
    check_area: float | None
    check_volume: float | None
    fallback_atoms: int
    cuda: CudaAtoms | None = None
    gradient: UnionGradient | None = None


@overload
def exact(
    coords: Any,
    radii: ArrayLike | HasCudaArray | str | None = None,
    *,
    surface: Literal["vdw", "sas"] = "vdw",
    probe: float | None = None,
    atoms: ArrayLike | None = None,
    topology: bool | str = False,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
    gradient: bool = False,
    weights: ArrayLike | tuple[ArrayLike | None, ArrayLike | None] | None = None,
) -> ExactUnion: ...
@overload
def exact(
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    surface: Literal["ses", "excluded"],
    probe: float | None = None,
    atoms: None = None,
    topology: bool = False,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
    gradient: bool = False,
) -> ExcludedMeasures: ...
def exact(
    coords: Any,
    radii: Any = None,
    *,
    surface: str = "vdw",
    probe: float | None = None,
    atoms: ArrayLike | None = None,
    topology: bool | str = False,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
    gradient: bool = False,
    weights: ArrayLike | tuple[ArrayLike | None, ArrayLike | None] | None = None,
) -> ExactUnion | ExcludedMeasures:
    """Exact area and volume of the union of the atoms' balls, and its topology.

    Parameters
    ----------
    coords : array_like, shape (N, 3), or a molecule
        Centres, Å; or a `Molecule`. An array with ``__cuda_array_interface__`` is measured on the
        device where it lies.
    radii : array_like, shape (N,), or the name of a set (as of `read`) or a path, optional
        Radii, Å. A molecule brings its own. Beside coordinates on a device they may be there too.
    surface : {"vdw", "sas", "ses"}
        "sas" is the solvent-accessible surface: the same with a probe of 1.4 unless `probe` is given.
        "ses" measures the solvent-excluded surface of the atoms instead (also "excluded"); `atoms`
        and `method` are not of it.
    probe : float, optional
        Added to every radius, Å; 0 by default, and not 1.4 as of `sasa`. With 1.4 the area is the
        solvent-accessible one. Of
        the excluded surface the radius of the probe, 1.4 by default.
    atoms : array_like, mask (N,) or indices, optional
        Only these are measured, while all others still bury them.
    topology : bool, or {"full", "counts", "off"}
        Whether components, tunnels and voids are computed too (True is "full"), which takes longer.
        "counts" are components and Euler characteristic alone, which cost next to nothing.
    method : {"auto", "cgal", "arcs", "both"}
        "cgal": regular triangulation and dual complex (Edelsbrunner 1995). "arcs": each sphere by
        the arcs on it, area and volume only. "both": the one checks the other. "auto": "cgal" for
        the topology, else "arcs".
    threads : int, optional
        At most so many; all cores by default.
    device : {"auto", "cpu", "cuda"}
        A CUDA device measures areas and volumes by "arcs"; "auto" uses it from 500,000 atoms on. Of
        the excluded surface "auto" is the CPU, and "cuda" leaves topology and exterior out.
    gradient : bool
        Whether the derivatives of area and volume are computed in the same pass, on the CPU, or on the
        device where the coordinates are. It is of all atoms; that of a union by "arcs".
    weights : array_like, shape (N,), or a tuple of two, optional
        The gradient is that of the sum of weight times area of each atom, and of the same with
        volumes; a tuple has the weights of areas and of volumes. None stands for weights of 1. Beside
        coordinates on a device they are there too, as float64.

    Returns
    -------
    ExactUnion, or ExcludedMeasures of the excluded surface

    Raises
    ------
    InvalidInput
        An argument is no such array, or has numbers that are not finite; the message names it.
    BackendUnavailable
        `device` is "cuda" or the coordinates are on a device, and there is none that can be used, or
        it is asked for topology or another method.

    Examples
    --------
    Two unit balls whose centres are 1 Å apart:

    >>> import vdwmesh
    >>> union = vdwmesh.exact([[0, 0, 0], [1, 0, 0]], [1, 1])
    >>> round(union.area, 6), round(union.volume, 6)  # 6 pi, 9/4 pi
    (18.849556, 7.068583)
    """
    refuse_weights(weights, gradient, surface)
    if _core.is_excluded(surface):
        if atoms is not None:
            raise InvalidInput(f'atoms: does not go with surface="{surface}"; leave one of them out')
        return measure_excluded(*arrays_of(coords, radii)[:2], probe, topology, threads, device, gradient, method=method)
    if gradient:
        options = Options.of(probe, topology, threads, device, surface=surface, method=method)
        arrays: tuple[Any, Any] = arrays_anywhere(coords, radii, device)[:2]
        count = len(arrays[0])
        if isinstance(arrays[0], CudaInput):
            return _with_gradient_there(*arrays, replace(options, device="auto"), atoms, weights)
        refuse_beside_gradient(options, atoms)
        if len(arrays[1]) != count:
            raise InvalidInput(f"radii: has {len(arrays[1])} numbers for {count} atoms of coords")
        return with_gradient(*arrays, options, weight_pair(weights, count))
    centers, sizes, _ = arrays_anywhere(coords, radii, device)
    options = Options.of(
        probe,
        topology,
        threads,
        device,
        surface=surface,
        atoms=chosen("atoms", atoms, len(centers)),
        method=method,
        per_atom=True,
        balls=len(centers),
    )
    found = measure(_as_frames(centers), sizes, options)
    if found.invalid is not None:
        place = "coords" if found.invalid.atom is None else f"coords[{found.invalid.atom}]"
        raise InvalidInput(f"{place}: {found.invalid.reason}")
    return ExactUnion(**found.frames[0])


def refuse_weights(weights: Any, gradient: bool, surface: str) -> None:
    """Raises for weights where there is nothing that they weigh."""
    if weights is None:
        return
    if not gradient:
        raise InvalidInput("weights: are those of a gradient; say gradient=True")
    if _core.is_excluded(surface):
        raise InvalidInput(f'weights: do not go with surface="{surface}"; leave one of them out')


def refuse_beside_gradient(options: Options, atoms: Any) -> None:
    """Raises for what the gradient of a union does not go with."""
    for name, other in (
        ("atoms", atoms is not None),
        ("topology", options.topology != "off"),
        ("method", options.method not in ("auto", "arcs")),
        ("device", options.device == "cuda"),
    ):
        if other:
            raise InvalidInput(
                f"gradient: is of areas and volumes of all atoms, on the CPU or where coordinates are; leave out {name}"
            )


def _two(weights: Any) -> tuple[Any, ...]:
    """The argument `weights` as those of areas and of volumes; None are weights of 1."""
    return weights if isinstance(weights, tuple) and len(weights) == 2 else (weights, weights)


def weight_pair(weights: Any, count: int) -> list[NDArray[Any] | None]:
    """Both weights, checked."""
    given = [None if w is None else floats("weights", w, "(N,)") for w in _two(weights)]
    for w in given:
        if w is not None and len(w) != count:
            raise InvalidInput(f"weights: has {len(w)} numbers for {count} atoms of coords")
    return given


def with_gradient(
    centers: Any, sizes: Any, options: Options, weights: list[NDArray[Any] | None]
) -> ExactUnion:
    """One set with its gradient, of all atoms."""
    found = _core.measure_gradient(centers, sizes, *weights, **vars(options))
    gradient = union_gradient(*found.pop("gradient"))
    return ExactUnion(**as_arrays(found), gradient=gradient)


def union_gradient(rows: Any, kinks: int) -> UnionGradient:
    """Rows of eight derivatives that the C++ side has."""
    table = view(rows)
    return UnionGradient(table[:, :3], table[:, 3], table[:, 4:7], table[:, 7], kinks)


def weights_there(weights: Any) -> list[CudaInput | None]:
    """Both weights beside coordinates on a device."""
    pair = _two(weights)
    if any(w is not None and not is_on_device(w) for w in pair):
        raise InvalidInput("weights: are on the host, but coords on a CUDA device; copy them there")
    return [None if w is None else on_device("weights", w, "(N,)") for w in pair]


def _with_gradient_there(coords: CudaInput, radii: Any, options: Options, atoms: Any, weights: Any) -> ExactUnion:
    """The same of a set on a device, where the gradient and its weights are too."""
    refuse_beside_gradient(options, atoms)
    found = measure_gradient_there(
        coords.as_frames(), radii, weights_there(weights), replace(options, per_atom=True)
    )
    _refuse(found.invalid, 0, False)
    return ExactUnion(**found.frames[0])


def _as_frames(centers: NDArray[Any] | CudaInput) -> NDArray[Any] | CudaInput:
    return centers.as_frames() if isinstance(centers, CudaInput) else centers[np.newaxis]


@overload
def sasa(  # type: ignore
    coords: HasCudaArray,
    radii: ArrayLike | HasCudaArray | str | None = None,
    *,
    probe: float = 1.4,
    mode: str = "total",
    groups: ArrayLike | None = None,
    atoms: ArrayLike | None = None,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
) -> Floats | CudaArray: ...
@overload
def sasa(
    coords: Any,
    radii: ArrayLike | HasCudaArray | str | None = None,
    *,
    probe: float = 1.4,
    mode: str = "total",
    groups: ArrayLike | None = None,
    atoms: ArrayLike | None = None,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
) -> Floats: ...
def sasa(
    coords: Any,
    radii: ArrayLike | HasCudaArray | str | None = None,
    *,
    probe: float = 1.4,
    mode: str = "total",
    groups: ArrayLike | None = None,
    atoms: ArrayLike | None = None,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
) -> Floats | CudaArray:
    """Exact solvent-accessible surface area, Å², of one structure or of frames.

    Parameters
    ----------
    coords : array_like, shape (N, 3) or (T, N, 3), or a molecule
        Centres, Å.
    radii, atoms, method, threads, device
        As for `exact`.
    probe : float
        Radius of the solvent, Å: 1.4 by default, while `exact`, `frames` and `trajectory` measure the
        balls themselves, with a probe of 0.
    mode : {"total", "atom", "residue"}
        One area for all atoms, for each atom, or for each residue.
    groups : array_like, shape (N,), optional
        Labels of the atoms: atoms of one label are a residue. A molecule brings its own. Areas are
        in the order in which the labels first appear.

    Returns
    -------
    ndarray of float64, or CudaArray
        Of shape () for "total", (N,) for "atom", (G,) for "residue"; with T in front for frames.
        NaN for what was not measured. From coordinates on a device the areas of atoms stay there, and
        all frames are measured at once; sums are on the host.

    Examples
    --------
    >>> import numpy, vdwmesh
    >>> area = vdwmesh.sasa([[0, 0, 0]], [1.6], probe=1.4)
    >>> round(float(area) / numpy.pi, 9)  # 4 pi 3²
    36.0
    """
    centers, sizes, source = arrays_anywhere(coords, radii, device, frames=True)
    has_frames = centers.ndim == 3
    frames: NDArray[Any] | CudaInput = centers if has_frames else _as_frames(centers)
    labels, count = _groups(mode, groups, source, frames.shape[1])
    options = Options.of(
        probe,
        False,
        threads,
        device,
        atoms=chosen("atoms", atoms, frames.shape[1]),
        method=method,
        per_atom=mode == "atom",
        groups=labels,
        group_count=count,
        balls=frames.shape[0] * frames.shape[1],
    )
    if mode == "atom" and isinstance(frames, CudaInput):
        return _atom_areas_there(frames, sizes, options, has_frames)
    width = {"total": (), "atom": (frames.shape[1],), "residue": (count,)}[mode]
    areas = np.empty((len(frames), *width))
    for first in range(0, len(frames), _FRAMES_AT_ONCE):
        part = slice(first, first + _FRAMES_AT_ONCE)
        found = measure(_cut(frames, part), sizes, options)
        _refuse(found.invalid, first, has_frames)
        name = "atom_area" if mode == "atom" else "area"
        areas[first : first + len(found.frames)] = found.groups or [one[name] for one in found.frames]
    areas.flags.writeable = False
    return areas if has_frames else areas[0, ...]


def _cut(frames: NDArray[Any] | CudaInput, part: slice) -> NDArray[Any] | CudaInput:
    return frames.cut(part) if isinstance(frames, CudaInput) else frames[part]


def _atom_areas_there(
    frames: CudaInput, radii: NDArray[Any] | CudaInput, options: Options, has_frames: bool
) -> CudaArray:
    """The areas of the atoms of all frames at once, left on the device."""
    found = measure(frames, radii, options)
    _refuse(found.invalid, 0, has_frames)
    there = cast(CudaAtoms, found.cuda if has_frames else found.frames[0]["cuda"])
    return there.atom_area


def _refuse(invalid: InvalidFrame | None, first: int, has_frames: bool) -> None:
    """Raises for a frame that could not be measured, of those from `first` on."""
    if invalid is None:
        return
    place = f"[{first + invalid.frame}, " if has_frames else "["
    atom = "..." if invalid.atom is None else invalid.atom
    raise InvalidInput(f"coords{place}{atom}]: {invalid.reason}")


def _groups(mode: str, groups: Any, source: Atoms, count: int) -> tuple[Ids | None, int]:
    """The number of the group of each atom, and how many there are; no groups are 0."""
    if mode != "residue" and groups is not None:
        raise InvalidInput('groups: are of mode="residue"')
    if mode in ("total", "atom"):
        return None, 0
    if mode != "residue":
        raise InvalidInput(f"mode: {mode!r}; there are total, atom and residue")
    labels = source.residues if groups is None else _label_list(groups)
    if labels is None:
        raise InvalidInput("groups: are needed, a label for each atom; coordinates alone have none")
    return numbered(labels, count)


def _label_list(groups: Any) -> list[Any]:
    """Labels of any kind that can be compared: numbers, strings, tuples; rows become tuples."""
    refuse_masked("groups", groups)
    array = groups if isinstance(groups, (list, tuple)) else np.asarray(groups).tolist()
    if not isinstance(array, (list, tuple)):
        raise InvalidInput("groups: a label for each atom is needed")
    return [tuple(label) if isinstance(label, list) else label for label in array]


def numbered(labels: Any, count: int) -> tuple[Ids, int]:
    """The number of each atom's label, in the order in which labels first appear, and how many."""
    if len(labels) != count:
        raise InvalidInput(f"groups: has {len(labels)} labels for {count} atoms")
    numbers: dict[Any, int] = {}
    try:
        found = [numbers.setdefault(label, len(numbers)) for label in labels]
    except TypeError:
        raise InvalidInput("groups: labels must be numbers, strings or tuples of these") from None
    return np.array(found, dtype=np.uint32), len(numbers)
