"""Exact measures of the frames of trajectories, in constant memory."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Callable, Iterator

import numpy as np

from vdwmesh import _core, _sinks
from vdwmesh._arrays import Brief, chosen, thread_count
from vdwmesh._cuda import CudaAtoms, CudaInput, is_on_device
from vdwmesh._exact import (
    ExactUnion,
    UnionGradient,
    refuse_beside_gradient,
    refuse_weights,
    weight_pair,
    weights_there,
    with_gradient,
)
from vdwmesh._excluded import ExcludedGradient, ExcludedMeasures, measure_excluded
from vdwmesh._measure import Counts, InvalidFrame, Options, Topology, measure, measure_gradient_there
from vdwmesh._mesh import Mesh, mesh
from vdwmesh._sources import Atoms, radii_anywhere, radii_for
from vdwmesh._trajectories import Chunk, Trajectory, Window, trajectory_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, NDArray


@dataclass(frozen=True, eq=False, repr=False)
class FrameResult(Brief):
    """Exact measures of one frame.

    Attributes
    ----------
    frame : int
        Its number in the trajectory, from 0.
    time : float or None
        As the reader of the trajectory says, ps with MDAnalysis and mdtraj.
    area, volume : float
        Å², Å³; of the atoms that were measured.
    atom_area, atom_volume : ndarray of float64, shape (N,), or None
        As of `ExactUnion`; None unless asked for.
    counts : Counts or None
    topology : Topology or None
        None unless asked for.
    cuda : CudaAtoms or None
        Measures of the atoms in the memory of the device, if the frames were there; None unless asked
        for.
    gradient : UnionGradient, or ExcludedGradient of the excluded surface, or None
        None unless asked for. Of frames on a device `cuda` has it there.
    """

    frame: int
    time: float | None
    area: float
    volume: float
    atom_area: Floats | None
    atom_volume: Floats | None
    counts: Counts | None
    topology: Topology | None
    cuda: CudaAtoms | None = None
    gradient: UnionGradient | ExcludedGradient | None = None


def frames(
    traj: Any,
    *,
    radii: ArrayLike | str = "bondi",
    select: Any = None,
    surface: str = "vdw",
    probe: float | None = None,
    atoms: ArrayLike | None = None,
    topology: bool | str = False,
    per_atom: bool = False,
    start: int | None = None,
    stop: int | None = None,
    step: int | None = None,
    chunk: int = 64,
    threads: int | None = None,
    device: str = "auto",
    gradient: bool = False,
    weights: ArrayLike | tuple[ArrayLike | None, ArrayLike | None] | None = None,
) -> Iterator[FrameResult]:
    """Exact area, volume and topology of each frame of a trajectory.

    Frames are measured side by side, a chunk at a time, while a thread reads the next chunk. There
    are two chunks in memory, however long the trajectory is.

    Parameters
    ----------
    traj : AtomGroup or Universe, mdtraj.Trajectory, array (T, N, 3), or iterable
        An array may lie in the memory of a CUDA device, where it is then measured. An iterable yields arrays of shape (N, 3), or trajectories of mdtraj, as ``iterload`` does,
        and is read in another thread. Lengths are in Å, those of mdtraj in nm. A universe stays at
        its frame.
    radii : array_like, shape (N,), or the name of a set (as of `read`) or a path
        Å; of all atoms of `traj` or of the selected ones. Arrays bring no elements, so they need
        numbers.
    select : str, mask (N,) or indices, optional
        Only these atoms are there. A string is in the language of MDAnalysis or mdtraj.
    surface : {"vdw", "sas", "ses"}
        As for `exact`; "ses" measures the solvent-excluded surface of each frame, one after another, without
        `atoms` and `topology`.
    probe : float, optional
        Å; as for `exact` 0 by default, and 1.4 of the surfaces "sas" and "ses".
    threads
        As for `exact`.
    atoms : array_like, mask (N,) or indices, optional
        Of the selected atoms only these are measured, while all others still bury them.
    topology : bool, or {"full", "counts", "off"}
        As for `exact`.
    per_atom : bool
        Whether areas and volumes of the atoms are kept.
    start, stop, step : int, optional
        As in a slice.
    chunk : int
        Number of frames that are measured at once.
    device : {"auto", "cpu", "cuda"}
        As for `exact`; "auto" counts the atoms of all frames.
    gradient, weights
        As for `exact`: the weights are those of all frames. Frames on a device are differentiated
        there, a chunk at once, those on the host one after another.

    Yields
    ------
    FrameResult
        With the digits that `exact` gives for the frame alone.

    Raises
    ------
    InvalidInput
        An argument is wrong, or a frame has other atoms than the first or numbers that are not
        finite. It names the frame; the frames before it were yielded.

    Examples
    --------
    Two unit balls that part:

    >>> import numpy, vdwmesh
    >>> places = numpy.zeros((3, 2, 3))
    >>> places[:, 1, 0] = 0.5, 1, 3
    >>> for frame in vdwmesh.frames(places, radii=[1, 1], topology="counts"):
    ...     print(frame.frame, round(frame.area / numpy.pi, 9), frame.counts.components)
    0 5.0 1
    1 6.0 1
    2 8.0 2
    """
    size = chunk_size(chunk)
    window = Window.of(start, stop, step)
    refuse_weights(weights, gradient, surface)
    if _core.is_excluded(surface):
        if atoms is not None or topology not in (False, "off"):
            raise InvalidInput("surface: atoms and topology of frames are not of the excluded surface")
        given = trajectory_of(traj, select, window)
        if is_on_device(given.atoms.coords):
            raise InvalidInput("surface: the excluded surface of frames is measured on the host; copy them there")
        sizes = radii_of_frames(radii, given)
        return _one_by_one(
            given,
            lambda centers: measure_excluded(centers, sizes, probe, False, threads, device, bool(gradient)),
            bool(per_atom),
        )
    options = Options.of(probe, topology, threads, device, surface=surface, per_atom=bool(per_atom))
    given = trajectory_of(traj, select, window)
    sizes = radii_of_frames(radii, given)
    if gradient:
        there = is_on_device(given.atoms.coords)
        refuse_beside_gradient(replace(options, device="auto") if there else options, atoms)
        if there:
            return _measured(given, sizes, replace(options, unit=given.atoms.unit), size, weights_there(weights))
        pair = weight_pair(weights, given.count)
        return _one_by_one(given, lambda centers: with_gradient(centers, sizes, options, pair), bool(per_atom))
    options = replace(
        options,
        atoms=chosen("atoms", atoms, given.count),
        unit=given.atoms.unit,
        balls=given.count * (_MANY_FRAMES if given.length is None else given.length),
    )
    return _measured(given, sizes, options, size)


def chunk_size(chunk: Any) -> int:
    """The argument `chunk`, checked."""
    if isinstance(chunk, bool) or not isinstance(chunk, (int, np.integer)) or chunk < 1:
        raise InvalidInput(f"chunk: {chunk!r} is no number of frames")
    return int(chunk)


_MANY_FRAMES = 1 << 20  # stands for a number that is not known


def radii_of_frames(radii: Any, given: Trajectory) -> NDArray[Any] | CudaInput:
    """The argument `radii` as one number for each atom that is there."""
    if is_on_device(given.atoms.coords):
        return radii_anywhere(radii, given.atoms)
    found = radii_for(radii, given.atoms)
    if given.selected is not None and len(found) == given.total and not isinstance(radii, (str, os.PathLike)):
        found = found[given.selected]
    if len(found) != given.count:
        raise InvalidInput(f"radii: has {len(found)} radii for {given.count} atoms; each atom needs one")
    return found


def _measured(
    given: Trajectory,
    radii: NDArray[Any] | CudaInput,
    options: Options,
    chunk: int,
    weights: list[CudaInput | None] | None = None,
) -> Iterator[FrameResult]:
    """With weights, of frames on a device, their gradients too."""
    for part in given.chunks(chunk):
        if weights is None:
            found = measure(part.coords, radii, options)
        else:
            assert isinstance(part.coords, CudaInput)
            found = measure_gradient_there(part.coords, radii, weights, options)
        for number, time, one in zip(part.numbers, part.times, found.frames):
            yield FrameResult(
                number,
                time,
                one["area"],
                one["volume"],
                one["atom_area"],
                one["atom_volume"],
                one["counts"],
                one["topology"],
                one["cuda"],
            )
        refuse(found.invalid, part)


def _one_by_one(
    given: Trajectory, measured: Callable[[Any], ExactUnion | ExcludedMeasures], per_atom: bool
) -> Iterator[FrameResult]:
    """Each frame on all cores."""
    for part in given.chunks(_FRAMES_OF_MESHES):
        for number, time, coords in zip(part.numbers, part.times, part.coords):
            centers = coords if given.atoms.unit == 1 else given.atoms.unit * coords.astype(np.float64)
            try:
                one = measured(centers)
            except InvalidInput as error:
                raise InvalidInput(f"traj: frame {number}: {error}") from None
            area, volume = (one.atom_area, one.atom_volume) if per_atom else (None, None)
            yield FrameResult(number, time, one.area, one.volume, area, volume, None, None, gradient=one.gradient)


def refuse(invalid: InvalidFrame | None, part: Chunk) -> None:
    """Raises for the frame of the chunk that could not be measured, if there is one."""
    if invalid is None:
        return
    atom = "" if invalid.atom is None else f", atom {invalid.atom}"
    raise InvalidInput(f"traj: frame {part.numbers[invalid.frame]}{atom}: {invalid.reason}")


@dataclass(frozen=True, eq=False, repr=False)
class TrajectoryResult(Brief):
    """Exact measures of all frames of a trajectory. What was not asked for is None.

    Attributes
    ----------
    frames : ndarray of int64, shape (T,)
        Numbers in the trajectory.
    times : ndarray of float64, shape (T,), or None
        As of `FrameResult`.
    area, volume : ndarray of float64, shape (T,)
        Å², Å³.
    components, tunnels, voids, euler_characteristic, hidden_atoms : ndarray of int64, (T,), or None
        As of `Topology`; tunnels and voids belong to the whole topology alone.
    atom_area, atom_volume : ndarray of float64, shape (T, N), or None
        Å², Å³; NaN for atoms that were not to be measured.
    """

    frames: NDArray[np.int64]
    times: Floats | None
    area: Floats
    volume: Floats
    components: NDArray[np.int64] | None
    tunnels: NDArray[np.int64] | None
    voids: NDArray[np.int64] | None
    euler_characteristic: NDArray[np.int64] | None
    hidden_atoms: NDArray[np.int64] | None
    atom_area: Floats | None
    atom_volume: Floats | None

    def __len__(self) -> int:
        return len(self.frames)

    def to_pandas(self) -> Any:
        """The result as a ``pandas.DataFrame``, a row for each frame."""
        return _sinks.to_pandas(self)

    def to_xarray(self) -> Any:
        """The result as an ``xarray.Dataset`` with the dimensions "frame" and "atom"."""
        return _sinks.to_xarray(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a file: .csv; .h5 (h5py or PyTables is needed) or .nc (SciPy), by the extension."""
        _sinks.save(self, path)


def trajectory(traj: Any, **options: Any) -> TrajectoryResult:
    """Exact area, volume and topology of all frames of a trajectory, as arrays.

    Parameters
    ----------
    traj, **options
        As for `frames`, but gradients. With ``per_atom=True`` the result has 16 bytes for each atom and frame.

    Returns
    -------
    TrajectoryResult

    Examples
    --------
    >>> import numpy, vdwmesh
    >>> places = numpy.zeros((3, 2, 3))
    >>> places[:, 1, 0] = 0.5, 1, 3
    >>> found = vdwmesh.trajectory(places, radii=[1, 1], topology="counts")
    >>> found.components
    array([1, 1, 2])
    """
    if options.get("gradient"):
        raise InvalidInput("gradient: trajectory() keeps none; frames() yields it frame by frame")
    columns: dict[str, list[Any]] = {}
    for one in frames(traj, **options):
        for name, value in _row(one).items():
            columns.setdefault(name, []).append(value)
    found: dict[str, Any] = {name: _column(values) for name, values in columns.items()}
    return TrajectoryResult(**found)


def _row(one: FrameResult) -> dict[str, Any]:
    """What a frame gives to each array."""
    row: dict[str, Any] = {"frames": one.frame, "times": one.time, "area": one.area, "volume": one.volume}
    for name in ("components", "euler_characteristic", "hidden_atoms"):
        row[name] = None if one.counts is None else getattr(one.counts, name)
    for name in ("tunnels", "voids"):
        row[name] = None if one.topology is None else getattr(one.topology, name)
    # A copy of the areas lets go of the volumes that stand between them.
    row["atom_area"] = None if one.atom_area is None else one.atom_area.copy()
    row["atom_volume"] = None if one.atom_volume is None else one.atom_volume.copy()
    return row


def _column(values: list[Any]) -> NDArray[Any] | None:
    if values[0] is None:
        return None
    return np.array(values)


@dataclass(frozen=True, eq=False)
class FrameMesh:
    """The mesh of one frame. `frame` and `time` are as of `FrameResult`."""

    frame: int
    time: float | None
    mesh: Mesh


def meshes(
    traj: Any,
    *,
    radii: ArrayLike | str = "bondi",
    select: Any = None,
    start: int | None = None,
    stop: int | None = None,
    step: int | None = None,
    **options: Any,
) -> Iterator[FrameMesh]:
    """Meshes of the frames of a trajectory: by marching cubes, on a grid that stays put, or exact ones.

    Frames are meshed one after another on all cores, and excluded surfaces one on each core, while a thread
    reads the next ones.

    Parameters
    ----------
    traj, radii, select, start, stop, step
        As for `frames`.
    **options
        As for `mesh`, but `mesher` is "marching-cubes" for surfaces of balls unless it, a density, an edge
        length or a distance is given, and its `fixed_grid` is True unless said otherwise.

    Yields
    ------
    FrameMesh

    Examples
    --------
    >>> import numpy, vdwmesh
    >>> places = numpy.zeros((2, 1, 3))
    >>> places[1] = 0.1
    >>> [len(one.mesh.vertices) > 0 for one in vdwmesh.meshes(places, radii=[1.7])]
    [True, True]
    """
    excluded = _core.is_excluded(options.get("surface", "vdw"))
    if options.get("mesher") is None:
        triangles_asked = any(options.get(name) is not None for name in ("density", "edge_length", "max_distance"))
        options["mesher"] = "exact" if excluded or triangles_asked else "marching-cubes"
    options.setdefault("fixed_grid", options["mesher"] == "marching-cubes")
    given = trajectory_of(traj, select, Window.of(start, stop, step))
    cores = 1
    if excluded:  # their mesher works on one core in the main
        cores = thread_count(options.get("threads")) or os.cpu_count() or 1
        options["threads"] = 1
    return _meshed(given, radii_of_frames(radii, given), cores, options)


def _meshed(given: Trajectory, radii: Any, cores: int, options: dict[str, Any]) -> Iterator[FrameMesh]:
    def meshed(number: int, time: float | None, coords: Any) -> FrameMesh:
        atoms = Atoms(coords=coords, unit=given.atoms.unit)
        try:
            return FrameMesh(number, time, mesh(atoms, radii, **options))
        except InvalidInput as error:
            raise InvalidInput(f"traj: frame {number}: {error}") from None

    for part in given.chunks(max(_FRAMES_OF_MESHES, cores)):
        if cores == 1:
            yield from map(meshed, part.numbers, part.times, part.coords)
        else:
            with ThreadPoolExecutor(cores) as pool:
                yield from pool.map(meshed, part.numbers, part.times, part.coords)


_FRAMES_OF_MESHES = 4  # that are read at once: a mesh takes far longer than reading its frame
