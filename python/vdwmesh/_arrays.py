"""Brings arguments into the forms that the C++ side takes, and says which argument is wrong."""

from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from vdwmesh.errors import BackendUnavailable, FileMissing, InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import Floats, Ids, NDArray


class Brief:
    """Results whose text has their numbers, and of arrays and tuples the size alone."""

    def __repr__(self) -> str:
        members = vars(self).items()
        parts = [f"{name}={_brief(value)}" for name, value in members if value is not None]
        return f"<vdwmesh.{type(self).__name__} {', '.join(parts)}>"


def _brief(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.7g}"
    if isinstance(value, np.ndarray):
        return f"array{value.shape}"
    if isinstance(value, tuple) and len(value) > 3:
        return f"({len(value)} values)"
    return repr(value)


_MOST_THREADS = 4096  # as on the command line
_FLOAT_TYPES = (np.dtype(np.float64), np.dtype(np.float32))


def floats(name: str, value: Any, shape: str) -> NDArray[Any]:
    """The argument as an array of float64 or float32, by reference where it is one.

    `shape` is what the number of dimensions is taken from, as "(N, 3)".
    """
    if hasattr(value, "__cuda_array_interface__"):  # CuPy's have __array__ too, which refuses
        raise BackendUnavailable(
            f"{name}: is on a CUDA device, from where it is not read; copy it to the host"
        )
    if isinstance(value, (str, os.PathLike)):
        raise InvalidInput(
            f"{name}: {os.fspath(value)!r} is no array of shape {shape}; vdwmesh.read(path) reads a structure file"
        )
    refuse_masked(name, value)
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"{name}: is no array of shape {shape}: {error}") from None
    if array.dtype == object and array.ndim == 0:
        kind = type(value)
        raise InvalidInput(
            f"{name}: objects of {kind.__module__}.{kind.__qualname__} are not read; "
            f"give an array of shape {shape}"
        )
    if array.dtype not in _FLOAT_TYPES:
        if array.size > 0 and array.dtype.kind not in "iuf":
            raise InvalidInput(f"{name}: has elements of type {array.dtype}; numbers are needed")
        array = array.astype(np.float64)
    if array.ndim != shape.count(",") + (not shape.endswith(",)")):
        raise InvalidInput(f"{name}: has shape {array.shape}; {shape} is needed")
    return array


def refuse_masked(name: str, value: Any) -> None:
    """Raises for an array of numpy.ma with masked elements, whose values would be used."""
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise InvalidInput(f"{name}: has masked elements; leave them out, or fill them: .filled(...)")


def file_name(path: str | bytes | os.PathLike[Any]) -> bytes:
    """The name of a file that is there, as the C++ side takes it."""
    name = os.fsencode(path)
    if name != b"-" and not os.path.exists(name):
        shown = name.decode("utf-8", "backslashreplace")
        missing = FileMissing(f"{shown}: cannot be opened: {os.strerror(errno.ENOENT)}")
        missing.errno = errno.ENOENT
        raise missing
    return name


def given_number(name: str, value: Any) -> float | None:
    """A number that may be left out."""
    return None if value is None else number(name, value)


def radius_set(name: str, value: Any) -> bytes:
    """The name of a radius set, or of a file of radii that is there."""
    if isinstance(value, os.PathLike):
        return file_name(value)
    if not isinstance(value, str):
        raise InvalidInput(f"{name}: {value!r} is neither the name of a radius set nor a path")
    return value.encode("utf-8", "surrogateescape")


def view(owner: Any) -> NDArray[Any]:
    """A read-only array that is a view of an array of the C++ side."""
    return np.asarray(owner)


def chosen(name: str, value: Any, count: int) -> Ids | None:
    """A mask or indices of `count` atoms as ids; None if the argument is None."""
    if value is None:
        return None
    refuse_masked(name, value)
    array = np.asarray(value)
    if array.ndim != 1:
        raise InvalidInput(f"{name}: has shape {array.shape}; a mask or indices are needed")
    if array.dtype == np.bool_:
        if len(array) != count:
            raise InvalidInput(f"{name}: is a mask of {len(array)} atoms, but there are {count}")
        array = np.flatnonzero(array)
    if array.size == 0:
        raise InvalidInput(f"{name}: chooses no atom; a sum over none would be an area of 0")
    if array.dtype.kind not in "iu":
        raise InvalidInput(f"{name}: has elements of type {array.dtype}; a mask or indices are needed")
    outside = (array < -count) | (array >= count)
    if outside.any():
        first = int(np.flatnonzero(outside)[0])
        raise InvalidInput(f"{name}[{first}]: {array[first]} is no index of {count} atoms")
    indices = array.astype(np.int64)
    return np.where(indices < 0, indices + count, indices).astype(np.uint32)


def thread_count(threads: int | None) -> int | None:
    """The argument `threads`, checked."""
    if threads is None:
        return None
    whole = isinstance(threads, (int, np.integer)) and not isinstance(threads, bool)
    if not whole or not 1 <= threads <= _MOST_THREADS:
        raise InvalidInput(
            f"threads: {threads!r} is no number of threads from 1 to {_MOST_THREADS}; "
            "None means all cores"
        )
    return int(threads)


def number(name: str, value: Any) -> float:
    """The argument as a float."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name}: {value!r} is no number") from None
