"""Exact measures of many structures: of files, and of sets of balls in arrays."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import Brief, number, thread_count, view
from vdwmesh._cuda import CudaAtoms, CudaInput, is_on_device, packed
from vdwmesh._exact import UnionGradient, refuse_weights, union_gradient, weight_pair, weights_there
from vdwmesh._measure import Options, atoms_there, gradient_there, topology_name
from vdwmesh._molecule import read_options
from vdwmesh._sources import arrays_anywhere, joined
from vdwmesh.errors import InvalidInput, in_terms_of_python

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, NDArray


@dataclass(frozen=True)
class BatchRow:
    """What is known of one structure of a batch; None where it was not computed.

    Attributes
    ----------
    name : str
        Path of the file, or name of the member in its archive.
    atoms : int
    left_out : dict of str to int
        How many atoms of the file are not measured, by reason.
    assumed_radii, guessed_elements : int
        Atoms whose element the radius set lacks, and whose element had to be guessed.
    method : str
        "cgal", "arcs" or "both".
    area, volume : float
        Å², Å³.
    components, tunnels, voids, euler_characteristic : int
    fallback_atoms : int
        Atoms that the arcs doubted, of which the triangulation gave the measures.
    doubtful_atoms : int
        Atoms for which the arcs leave the topology open, so that there are no counts.
    warnings : tuple of str
    error : str
        Why there are no measures.
    """

    name: str
    atoms: int | None
    left_out: dict[str, int] | None
    assumed_radii: int | None
    guessed_elements: int | None
    method: str | None
    area: float | None
    volume: float | None
    components: int | None
    tunnels: int | None
    voids: int | None
    euler_characteristic: int | None
    fallback_atoms: int | None
    doubtful_atoms: int | None
    warnings: tuple[str, ...]
    error: str | None


def batch(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    *,
    shard: tuple[int, int] = (0, 1),
    probe: float = 0.0,
    topology: bool | str = False,
    method: str = "auto",
    threads: int | None = None,
    format: str | None = None,
    model: str | int = "first",
    assembly: str | int | None = None,
    radii: str | os.PathLike[str] | None = None,
    select: str | None = None,
    altloc: str = "highest",
    waters: bool = False,
    hydrogens: bool = True,
    hetatm: bool = True,
    units: str | None = None,
) -> Iterator[BatchRow]:
    """Exact measures of many structures, one row for each, in the order of the inputs.

    Structures are measured side by side, each on one thread, and a few for each thread are in
    memory. The numbers are those of `exact` for each file alone. A structure that cannot be
    measured is a row with its `error`, and the others go on.

    Parameters
    ----------
    paths : path, or sequence of paths
        Folders, tar archives (also packed), structure files, and lists: files of other extensions
        with the path of a structure on each line.
    shard : (int, int)
        (i, n): part i of n parts that follow each other. i is from 0 to n - 1, as indices of Python
        are, while the program's ``--shard i/n`` counts from 1.
    probe, topology, method, threads
        As of `exact`.
    format, model, assembly, radii, select, altloc, waters, hydrogens, hetatm, units
        As of `read`.

    Yields
    ------
    BatchRow

    Raises
    ------
    FileFormatError
        A folder, list or archive cannot be read on.
    InvalidInput
        An argument is no such value, or an input is not there.

    Examples
    --------
    >>> import vdwmesh
    >>> for row in vdwmesh.batch("structures", probe=1.4):  # doctest: +SKIP
    ...     print(row.name, row.area, row.error)
    """
    part, parts = _shard(shard)
    inputs = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    workers, grown = thread_count(threads), number("probe", probe)
    if not math.isfinite(grown):
        raise InvalidInput(f"probe: {grown} is not finite")
    run = _core.BatchRun(
        [os.fspath(path) for path in inputs], part, parts, threads=workers,
        probe=grown, topology=topology_name(topology), method=method,
        **read_options(
            format, model, assembly, radii, select, altloc, units,
            waters=waters, hydrogens=hydrogens, hetatm=hetatm,
        ),
    )  # fmt: skip
    return _rows(run, 16 * (workers or os.cpu_count() or 1))


def _rows(run: _core.BatchRun, chunk: int) -> Iterator[BatchRow]:
    while rows := run.next(chunk):
        for row in rows:
            row["warnings"] = tuple(map(in_terms_of_python, row["warnings"]))
            yield BatchRow(**row)


def _shard(shard: Any) -> tuple[int, int]:
    try:
        part, parts = (int(number) for number in shard)
    except (TypeError, ValueError):
        raise InvalidInput(f"shard: {shard!r} is no pair (i, n)") from None
    if not 0 <= part < parts:
        raise InvalidInput(f"shard: {shard!r}; part i is from 0 to n - 1 (the program's --shard counts from 1)")
    return part, parts


@dataclass(frozen=True, eq=False, repr=False)
class ExactSets(Brief):
    """Exact measures of many sets of balls, which do not see each other. B sets have N atoms in all.

    Attributes
    ----------
    area, volume : ndarray of float64, shape (B,)
        Of each set, Å², Å³.
    atom_area, atom_volume : ndarray of float64, shape (N,)
        As of `ExactUnion`, set after set.
    offsets : ndarray of int64, shape (B + 1,)
        Set b has the atoms ``offsets[b]`` to ``offsets[b + 1] - 1``.
    fallback_atoms : int
        As of `ExactUnion`, of all sets.
    cuda : CudaAtoms or None
        Measures of the atoms, and their gradient, in the memory of the device, if the coordinates were
        there.
    gradient : UnionGradient or None
        Of the sums over each set. None where it was not asked for, and where coordinates are on a device.
    """

    area: Floats
    volume: Floats
    atom_area: Floats
    atom_volume: Floats
    offsets: NDArray[np.int64]
    fallback_atoms: int
    cuda: CudaAtoms | None = None
    gradient: UnionGradient | None = None


def exact_many(
    coords: Any,
    radii: Any = None,
    offsets: ArrayLike | None = None,
    *,
    surface: str = "vdw",
    probe: float | None = None,
    threads: int | None = None,
    device: str = "auto",
    gradient: bool = False,
    weights: ArrayLike | tuple[ArrayLike | None, ArrayLike | None] | None = None,
) -> ExactSets:
    """Exact areas and volumes of many sets of balls, and their derivatives, in one call.

    The digits are those of `exact` for each set alone. On a CUDA device small sets are measured many
    times faster than one after another.

    Parameters
    ----------
    coords : array_like, shape (N, 3), or iterable
        Centres of all sets, one set after another, Å; on the host or in the memory of a CUDA device.
        Without `offsets`: an iterable of what `exact` takes, on the host.
    radii : array_like, shape (N,), or iterable, optional
        Å. Without `offsets` the name of a set of radii for all, or the radii of each; molecules bring
        their own.
    offsets : array_like of int, shape (B + 1,), optional
        Set b has the atoms ``offsets[b]`` to ``offsets[b + 1] - 1``: from 0, rising, to N. On the host.
    surface : {"vdw", "sas"}
        As for `exact`.
    probe, threads, device, gradient, weights
        As for `exact`; weights are one for each atom of all sets.

    Returns
    -------
    ExactSets

    Raises
    ------
    InvalidInput
        An argument is no such array, has numbers that are not finite, or a set has no atom.
    BackendUnavailable
        As of `exact`.

    Examples
    --------
    >>> import numpy, vdwmesh
    >>> found = vdwmesh.exact_many([[0, 0, 0], [5, 0, 0], [6, 0, 0]], [1, 1, 1], [0, 1, 3])
    >>> numpy.round(found.area / numpy.pi, 9)  # 4 pi r^2, and 2 pi (2 + d)
    array([4., 6.])
    """
    refuse_weights(weights, gradient, surface)
    if _core.is_excluded(surface):
        raise InvalidInput(f'surface: "{surface}" is not measured in batches; exact() and frames() do')
    grown = Options.of(probe, False, threads, device, surface=surface).probe
    if offsets is None:
        if is_on_device(coords):
            raise InvalidInput("offsets: are needed where coords are on a CUDA device")
        coords, radii, offsets = joined("coords", list(coords), radii)
    centers, sizes, _ = arrays_anywhere(coords, radii, device)
    count = len(centers)
    if len(sizes) != count:
        raise InvalidInput(f"radii: has {len(sizes)} numbers for {count} atoms of coords")
    starts = _checked(offsets, count)
    if isinstance(centers, CudaInput):
        there = [None if w is None else w.packed for w in weights_there(weights)]
        return _sets(
            starts,
            **_core.measure_many_on_device(
                centers.as_frames().packed, packed(sizes), starts.tolist(), *there, gradient, grown, thread_count(threads)
            ),
        )
    pair = weight_pair(weights, count)
    return _sets(
        starts,
        **_core.measure_many(centers, sizes, starts.tolist(), *pair, gradient, grown, thread_count(threads), device),
    )


def _sets(
    offsets: NDArray[np.int64], *, gradient: Any, atoms_there: Any = None, slopes_there: Any = None, **found: Any
) -> ExactSets:
    cuda = None if atoms_there is None else _there(atoms_there, slopes_there)
    own = None if gradient is None else union_gradient(gradient[0], sum(gradient[1]))
    fallback = found.pop("fallback_atoms")
    columns = {name: view(column) for name, column in found.items()}
    return ExactSets(offsets=offsets, fallback_atoms=fallback, cuda=cuda, gradient=own, **columns)


def _there(columns: Any, slopes: Any) -> CudaAtoms:
    areas, volumes = columns
    if slopes is None:
        return atoms_there(areas, volumes)
    *own, kinks = slopes
    return atoms_there(areas, volumes, gradient_there(own, sum(kinks)))


def pulled_back(
    coords: Any, radii: Any, offsets: Any, weights: tuple[Any, Any], **options: Any
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Derivatives of the weighted areas plus the weighted volumes by coordinates and by radii, on the host."""
    gradient = exact_many(coords, radii, offsets, gradient=True, weights=weights, **options).gradient
    assert gradient is not None
    return gradient.area_coords + gradient.volume_coords, gradient.area_radii + gradient.volume_radii


def set_offsets(
    shape: tuple[int, ...], radii: tuple[int, ...], offsets: ArrayLike | None
) -> tuple[int, ...]:
    """Where sets begin in coordinates of that shape, and the end: (N, 3) with `offsets` or of one set, or
    frames (T, N, 3) with radii (N,)."""
    framed = len(shape) == 3
    if len(shape) not in (2, 3) or shape[-1] != 3 or radii != (shape[-2],):
        raise InvalidInput(f"coords, radii: have shapes {shape} and {radii}; (N, 3) or (T, N, 3), and (N,) are needed")
    if offsets is None:
        return tuple(range(0, (shape[0] if framed else 1) * shape[-2] + 1, max(shape[-2], 1)))
    if framed:
        raise InvalidInput("offsets: do not go with coords of shape (T, N, 3); leave one of them out")
    return tuple(_checked(offsets, shape[0]).tolist())


def _checked(offsets: Any, count: int) -> NDArray[np.int64]:
    """The argument `offsets`: where sets begin, and the end."""
    if is_on_device(offsets):
        raise InvalidInput("offsets: are on a CUDA device; they are needed on the host")
    starts: NDArray[Any] = np.asarray(offsets)
    if starts.ndim != 1 or starts.dtype.kind not in "iu" or len(starts) < 2:
        raise InvalidInput(f"offsets: has shape {starts.shape} and type {starts.dtype}; integers (B + 1,) are needed")
    starts = starts.astype(np.int64)
    if starts[0] != 0 or starts[-1] != count:
        raise InvalidInput(f"offsets: go from {starts[0]} to {starts[-1]}; from 0 to {count}, the number of atoms, is needed")
    empty = np.flatnonzero(np.diff(starts) <= 0)
    if len(empty):
        raise InvalidInput(f"offsets: set {empty[0]} has no atom")
    return starts
