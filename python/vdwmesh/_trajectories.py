"""Frames of whatever users have, in chunks.

Arrays in memory are cut into views. Everything else is read by a thread, which fills one chunk while
the other one is worked on; a third is never there, so memory does not depend on the number of frames.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from itertools import chain, islice
from queue import Queue
from threading import Thread
from typing import TYPE_CHECKING, Any, Callable, Iterable, Iterator, NamedTuple, Sequence

import numpy as np

from vdwmesh._arrays import chosen, floats
from vdwmesh._cuda import CudaInput, is_on_device, on_device
from vdwmesh._sources import Atoms, atoms_of, comes_from, one_location
from vdwmesh.errors import FileFormatError, InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import Ids, NDArray


class Frame(NamedTuple):
    """The coordinates of one frame, its number in the trajectory, and its time, if it has one."""

    coords: Any
    number: int
    time: float | None


@dataclass(frozen=True)
class Chunk:
    """Frames that follow one another; coordinates are of shape (k, N, 3)."""

    coords: NDArray[Any] | CudaInput
    numbers: Sequence[int]
    times: Sequence[float | None]
    error: BaseException | None = None  # why there are no further frames
    is_last: bool = False


@dataclass(frozen=True)
class Trajectory:
    """The frames that were asked for, of the atoms that were selected."""

    atoms: Atoms  # of each frame; those of an array have nothing but coordinates
    count: int  # of atoms
    total: int  # number of atoms before the selection
    selected: Ids | None
    length: int | None  # in frames, where that is known before they are read
    chunks: Callable[[int], Iterator[Chunk]]  # of so many frames, but for the last


class Window(NamedTuple):
    """Which frames are wanted, as in a slice."""

    start: int | None
    stop: int | None
    step: int | None

    @staticmethod
    def of(start: Any, stop: Any, step: Any) -> Window:
        """The arguments, checked."""
        for name, value in (("start", start), ("stop", stop), ("step", step)):
            if value is not None and (isinstance(value, bool) or not isinstance(value, (int, np.integer))):
                raise InvalidInput(f"{name}: {value!r} is no whole number")
        if step == 0:
            raise InvalidInput("step: is 0")
        return Window(start, stop, step)

    def of_length(self, length: int) -> range:
        """The numbers of the wanted ones of so many frames."""
        return range(length)[slice(*self)]

    def of_stream(self, frames: Iterator[Frame]) -> Iterator[Frame]:
        """The wanted ones of frames that come one after another."""
        for name, value in zip(self._fields, self):
            if value is not None and value < 0:
                raise InvalidInput(f"{name}: is {value}, but the number of frames is not known")
        return islice(frames, *self)


def trajectory_of(traj: Any, select: Any, window: Window) -> Trajectory:
    """The frames of the argument `traj`, whatever it is."""
    if isinstance(traj, Trajectory):
        return traj
    if isinstance(traj, (str, os.PathLike)):
        raise InvalidInput(
            f"traj: {os.fspath(traj)!r} is a path; give what a reader makes of it, such as "
            "MDAnalysis.Universe(topology, path) or mdtraj.load(path, top=topology)"
        )
    if comes_from("MDAnalysis", traj):
        return _of_mdanalysis(traj, select, window)
    if comes_from("mdtraj", traj):
        atoms, times = atoms_of(traj), traj.time
        return _of_array(atoms, traj.xyz, _selected_of_mdtraj(traj, select), window, times)
    if is_on_device(traj):
        return _of_device(on_device("traj", traj, "(T, N, 3)"), select, window)
    if hasattr(traj, "__array_interface__"):
        return _of_array(Atoms(traj), floats("traj", traj, "(T, N, 3)"), select, window)
    if not hasattr(traj, "__iter__") or comes_from("vdwmesh", traj) or comes_from("biotite", traj):
        atoms = atoms_of(traj)
        coords = np.asarray(atoms.coords)
        return _of_array(atoms, coords if coords.ndim == 3 else coords[np.newaxis], select, window)
    return _of_stream(traj, select, window)


def _of_array(
    atoms: Atoms, coords: NDArray[Any], select: Any, window: Window, times: Any = None
) -> Trajectory:
    coords = floats("traj", coords, "(T, N, 3)")
    if coords.shape[2] != 3 or coords.shape[1] == 0:
        raise InvalidInput(f"traj: has shape {coords.shape}; (T, N, 3) is needed, N above 0")
    selected = _selected(select, coords.shape[1])
    numbers = window.of_length(len(coords))
    wanted = coords[slice(*window)]
    known: Any = [None] * len(numbers) if times is None else np.asarray(times)[slice(*window)].tolist()

    def chunks(size: int) -> Iterator[Chunk]:
        for first in range(0, len(wanted), size):
            part = slice(first, first + size)
            cut = wanted[part] if selected is None else wanted[part][:, selected]
            yield Chunk(cut, numbers[part], known[part])

    count = coords.shape[1] if selected is None else len(selected)
    return Trajectory(
        some_atoms(atoms, selected), count, coords.shape[1], selected, _not_empty(len(numbers)), chunks
    )


def _of_device(coords: CudaInput, select: Any, window: Window) -> Trajectory:
    """Frames in the memory of a device, which stay there."""
    if select is not None:
        raise InvalidInput("select: traj is on a CUDA device; choose the atoms of its array instead")
    numbers = window.of_length(len(coords))
    wanted = coords.cut(slice(*window))

    def chunks(size: int) -> Iterator[Chunk]:
        for first in range(0, len(wanted), size):
            part = slice(first, first + size)
            times = [None] * len(numbers[part])
            yield Chunk(wanted.cut(part), numbers[part], times)

    atoms = coords.shape[1]
    return Trajectory(Atoms(coords), atoms, atoms, None, _not_empty(len(numbers)), chunks)


def _of_mdanalysis(traj: Any, select: Any, window: Window) -> Trajectory:
    """The atoms are chosen once. The universe stays at its frame: its reader is copied."""
    group = getattr(traj, "atoms", traj)
    total = len(group)
    if isinstance(select, str):
        group = group.select_atoms(select)
    elif select is not None:
        group = group[chosen("select", select, total)]
    if len(group) == 0:
        raise InvalidInput(f"select: {select!r} chooses no atom")
    group = one_location(group)
    reader, ids = group.universe.trajectory, group.ix
    atoms = atoms_of(group)
    if hasattr(reader, "coordinate_array"):  # in memory
        order = [reader.stored_order.index(axis) for axis in "fac"]
        times = reader.ts.data.get("time_offset", 0) + reader.ts.dt * np.arange(len(reader))
        whole = _of_array(atoms, reader.coordinate_array.transpose(order), ids, window, times)
        return replace(whole, atoms=atoms, total=total, selected=None)

    def frames() -> Iterator[Frame]:
        try:
            own = reader.copy()
        except Exception:  # readers of streams cannot be copied
            own = reader
        read = 0
        try:
            for ts in own[slice(*window)]:
                yield Frame(ts.positions[ids], ts.frame, float(ts.time))
                read += 1
        finally:
            if own is not reader:
                own.close()
        if read < length:  # MDAnalysis takes an error for the end
            raise FileFormatError(f"traj: frame {wanted[read]} cannot be read; the file may be cut off")

    wanted = window.of_length(len(reader))
    length = _not_empty(len(wanted))
    chunks = _read_ahead(frames, None, len(group))
    return Trajectory(atoms, len(group), total, None, length, chunks)


def _of_stream(traj: Iterable[Any], select: Any, window: Window) -> Trajectory:
    """Arrays (N, 3) one by one, or trajectories of mdtraj, as of its iterload."""
    items = iter(traj)
    item = next(items, None)
    if item is None:
        raise InvalidInput(_EMPTY)
    stream: Iterator[Frame]
    if isinstance(traj, (list, tuple)) and not comes_from("mdtraj", item):
        wanted = window.of_length(len(traj))
        stream = (Frame(_rows_of(traj[number])[0][0], number, None) for number in wanted)
    else:
        stream = window.of_stream(_frames_of(chain([item], items)))
    try:
        first = next(stream)
    except StopIteration:
        raise InvalidInput(_EMPTY) from None
    shape = np.shape(first.coords)
    if len(shape) != 2 or shape[1] != 3 or shape[0] == 0:
        raise InvalidInput(f"traj: frame {first.number} has shape {shape}; (N, 3) is needed, N above 0")
    if comes_from("mdtraj", item):
        select = _selected_of_mdtraj(item, select)
    selected = _selected(select, shape[0])
    count = shape[0] if selected is None else len(selected)
    chunks = _read_ahead(lambda: chain((first,), stream), selected, count, shape)
    return Trajectory(some_atoms(atoms_of(item), selected), count, shape[0], selected, None, chunks)


def _frames_of(items: Iterable[Any]) -> Iterator[Frame]:
    """The frames of trajectories and arrays that come one after another, numbered."""
    number = 0
    for item in items:
        for coords, time in zip(*_rows_of(item)):
            yield Frame(coords, number, time)
            number += 1


def _rows_of(item: Any) -> tuple[Any, Sequence[float | None]]:
    """The frames of one item of a stream, and their times."""
    if comes_from("mdtraj", item):
        return item.xyz, item.time.tolist()
    return (item if isinstance(item, np.ndarray) else atoms_of(item).coords,), (None,)


def _selected(select: Any, count: int) -> Ids | None:
    if isinstance(select, str):
        raise InvalidInput(f"select: {select!r} needs names of atoms; give a mask or indices")
    return chosen("select", select, count)


def _selected_of_mdtraj(traj: Any, select: Any) -> Any:
    return traj.topology.select(select) if isinstance(select, str) else select


def some_atoms(atoms: Atoms, selected: Ids | None) -> Atoms:
    """The selected ones, where the atoms have properties."""
    if selected is None:
        return replace(atoms, coords=None)
    columns: dict[str, Any] = {}
    for name in ("radii", "elements", "resnames", "names", "residues", "chains", "resids", "icodes"):
        column = getattr(atoms, name)
        columns[name] = None if column is None else [column[i] for i in selected]
    return replace(atoms, coords=None, **columns)


_EMPTY = "traj: has no frames, or start, stop and step leave none"


def _not_empty(length: int) -> int:
    if length == 0:
        raise InvalidInput(_EMPTY)
    return length


def _read_ahead(
    frames: Callable[[], Iterator[Frame]],
    selected: Ids | None,
    count: int,
    shape: tuple[int, ...] | None = None,
) -> Callable[[int], Iterator[Chunk]]:
    """Chunks that a thread reads. `shape` is what frames have before the selection."""

    def chunks(size: int) -> Iterator[Chunk]:
        return iter(_Reader(frames(), selected, (count, 3) if shape is None else shape, count, size))

    return chunks


class _Reader:
    """Two chunks that go round: the thread fills the one that comes back."""

    def __init__(
        self,
        frames: Iterator[Frame],
        selected: Ids | None,
        shape: tuple[int, ...],
        count: int,
        size: int,
    ) -> None:
        self._frames, self._selected, self._shape = frames, selected, shape
        self._is_stopped = False
        self._empty: Queue[NDArray[Any]] = Queue()
        self._full: Queue[tuple[Chunk, NDArray[Any]]] = Queue()
        for _ in range(2):
            self._empty.put(np.empty((size, count, 3), np.float32))

    def __iter__(self) -> Iterator[Chunk]:
        thread = Thread(target=self._fill_all, name="vdwmesh reads frames", daemon=True)
        thread.start()
        try:
            while True:
                chunk, buffer = self._full.get()
                if chunk.numbers:
                    yield chunk
                if chunk.error is not None:
                    raise chunk.error
                if chunk.is_last:
                    return
                self._empty.put(buffer)
        finally:
            self._is_stopped = True
            self._empty.put(np.empty(0))
            thread.join(1)  # s; a source that does not answer ends with the process

    def _fill_all(self) -> None:
        while not self._is_stopped:
            chunk, buffer = self._fill(self._empty.get())
            self._full.put((chunk, buffer))
            if chunk.is_last:
                return

    def _fill(self, buffer: NDArray[Any]) -> tuple[Chunk, NDArray[Any]]:
        """The next frames, in the buffer, or in a wider one where that is needed for their digits."""
        numbers: list[int] = []
        times: list[float | None] = []
        error: BaseException | None = None
        is_last = False
        try:
            while len(numbers) < len(buffer) and not self._is_stopped:
                frame = next(self._frames, None)
                if frame is None:
                    is_last = True
                    break
                coords = self._checked(frame)
                if coords.dtype == np.float64 and buffer.dtype != np.float64:
                    wider = np.empty(buffer.shape)
                    wider[: len(numbers)] = buffer[: len(numbers)]
                    buffer = wider
                buffer[len(numbers)] = coords
                numbers.append(frame.number)
                times.append(frame.time)
        except BaseException as caught:
            error, is_last = caught, True
        return Chunk(buffer[: len(numbers)], numbers, times, error, is_last), buffer

    def _checked(self, frame: Frame) -> NDArray[Any]:
        coords = floats(f"traj: frame {frame.number}", frame.coords, "(N, 3)")
        if coords.shape != self._shape:
            raise InvalidInput(
                f"traj: frame {frame.number} has shape {coords.shape}; those before have {self._shape}"
            )
        return coords if self._selected is None else coords[self._selected]
