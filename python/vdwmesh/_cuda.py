"""Arrays in the memory of a CUDA device: those of callers, and those of results.

Callers' arrays are known by their ``__cuda_array_interface__``, as CuPy, PyTorch, Numba and JAX have
it. They are read where they lie, so everything that a kernel would stumble over is refused here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Iterator, Protocol

import numpy as np

from vdwmesh._arrays import view
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh import _core
    from vdwmesh._types import NDArray


class HasCudaArray(Protocol):
    """Any array in the memory of a CUDA device."""

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]: ...


@dataclass(frozen=True, eq=False)
class CudaArray:
    """An array of a result in the memory of a CUDA device.

    ``cupy.asarray(array)``, ``torch.as_tensor(array, device="cuda")``, ``torch.from_dlpack(array)``
    and ``jax.dlpack.from_dlpack(array)`` are views of it, without a copy, that keep it alive. Its
    values are there when the call that made it returns, so no stream has to be waited for. The memory
    is reused in the order of the device's default stream: who reads it on a non-blocking stream of
    their own keeps the array until that work has ended.

    Attributes
    ----------
    shape : tuple of int
    dtype : numpy.dtype
    device : int
        CUDA's number of the device.
    """

    _owner: _core.CudaArray

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        return self._owner.__cuda_array_interface__

    def __dlpack__(
        self,
        *,
        stream: Any = None,
        max_version: tuple[int, int] | None = None,
        dl_device: tuple[int, int] | None = None,
        copy: bool | None = None,
    ) -> Any:
        return self._owner.__dlpack__(
            stream=stream, max_version=max_version, dl_device=dl_device, copy=copy
        )

    def __dlpack_device__(self) -> tuple[int, int]:
        return self._owner.__dlpack_device__()

    @property
    def shape(self) -> tuple[int, ...]:
        return self._owner.shape

    @property
    def dtype(self) -> np.dtype[Any]:
        kind: np.dtype[Any] = np.dtype(self.__cuda_array_interface__["typestr"])
        return kind

    @property
    def device(self) -> int:
        return self.__dlpack_device__()[1]

    def __len__(self) -> int:
        return self.shape[0]

    def __repr__(self) -> str:
        return f"<vdwmesh.CudaArray of {self.dtype} in shape {self.shape} on device {self.device}>"

    def to_numpy(self) -> NDArray[Any]:
        """A read-only copy in the memory of the host."""
        return view(self._owner.download())


@dataclass(frozen=True, eq=False)
class CudaMesh:
    """The arrays of a mesh in the memory of a CUDA device.

    Attributes
    ----------
    vertices : CudaArray of float64, shape (V, 3)
        Å.
    faces : CudaArray of uint32, shape (F, 3)
    normals : CudaArray of float32, shape (V, 3), or None
    vertex_atoms : CudaArray of uint32, shape (V,)
    face_atoms : CudaArray of uint32, shape (F,), or None
        Of the exact mesher.
    """

    vertices: CudaArray
    faces: CudaArray
    normals: CudaArray | None
    vertex_atoms: CudaArray
    face_atoms: CudaArray | None

    @staticmethod
    def _of(handle: _core.CudaMeshHandle) -> CudaMesh:
        def array(made: _core.CudaArray | None) -> CudaArray | None:
            return None if made is None else CudaArray(made)

        return CudaMesh(
            CudaArray(handle.vertices()),
            CudaArray(handle.faces()),
            array(handle.normals()),
            CudaArray(handle.vertex_atoms()),
            array(handle.face_atoms()),
        )


@dataclass(frozen=True, eq=False)
class CudaGradient:
    """Derivatives in the memory of a CUDA device, as of `UnionGradient`. Rows are 64 bytes apart.

    Attributes
    ----------
    area_coords, volume_coords : CudaArray of float64, shape (N, 3)
    area_radii, volume_radii : CudaArray of float64, shape (N,)
    kink_atoms : int
    """

    area_coords: CudaArray
    area_radii: CudaArray
    volume_coords: CudaArray
    volume_radii: CudaArray
    kink_atoms: int


@dataclass(frozen=True, eq=False)
class CudaAtoms:
    """Measures of atoms in the memory of a CUDA device; NaN for atoms that were not to be measured.

    Attributes
    ----------
    atom_area, atom_volume : CudaArray of float64, shape (N,)
        Å², Å³. Their elements are 16 bytes apart.
    gradient : CudaGradient or None
        None where it was not asked for.
    """

    atom_area: CudaArray
    atom_volume: CudaArray
    gradient: CudaGradient | None = None


@dataclass(frozen=True, eq=False)
class CudaInput:
    """A caller's array in the memory of a CUDA device, checked."""

    owner: Any  # keeps the memory
    address: int
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    strides: tuple[int, ...]  # bytes
    stream: int | None  # on which the values are still being made

    @property
    def packed(self) -> tuple[int, bool, tuple[int, ...], tuple[int, ...], int | None]:
        """What the C++ side reads."""
        return self.address, self.dtype == np.float32, self.shape, self.strides, self.stream

    @property
    def ndim(self) -> int:
        return len(self.shape)

    def __len__(self) -> int:
        return self.shape[0]

    def as_frames(self) -> CudaInput:
        """Coordinates (N, 3) as one frame (1, N, 3)."""
        return replace(self, shape=(1, *self.shape), strides=(0, *self.strides))

    def cut(self, part: slice) -> CudaInput:
        """A slice along the first axis."""
        numbers = range(*part.indices(len(self)))
        address = self.address + (numbers.start * self.strides[0] if len(numbers) else 0)
        step = numbers.step * self.strides[0]
        return replace(
            self,
            address=address,
            shape=(len(numbers), *self.shape[1:]),
            strides=(step, *self.strides[1:]),
        )

    def __iter__(self) -> Iterator[CudaInput]:
        for k in range(len(self)):
            yield replace(
                self,
                address=self.address + k * self.strides[0],
                shape=self.shape[1:],
                strides=self.strides[1:],
            )


def is_on_device(value: Any) -> bool:
    """Whether the value is an array in the memory of a CUDA device."""
    return isinstance(value, CudaInput) or hasattr(value, "__cuda_array_interface__")


_LEGACY_STREAM = 1  # CUDA's number of the default stream


def on_device(name: str, value: Any, *shapes: str) -> CudaInput:
    """The argument, checked. It has as many dimensions as one of `shapes`, as "(N, 3)"."""
    if isinstance(value, CudaInput):
        return value
    try:
        found = _described(name, value, value.__cuda_array_interface__)
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        if isinstance(error, InvalidInput):
            raise
        raise InvalidInput(f"{name}: its __cuda_array_interface__ is broken: {error!r}") from None
    _require_shape(name, found.shape, shapes)
    if found.address == 0:
        raise InvalidInput(f"{name}: its address on the device is 0")
    size = found.dtype.itemsize
    if any(number % size for number in (found.address, *found.strides)):
        raise InvalidInput(f"{name}: is not aligned to its elements of {size} bytes")
    return found


def _described(name: str, value: Any, given: dict[str, Any]) -> CudaInput:
    """What the interface says; exceptions of Python where it breaks its own rules."""
    shape = tuple(int(n) for n in given["shape"])
    dtype = np.dtype(given["typestr"])
    if dtype not in (np.dtype("<f8"), np.dtype("<f4")):
        raise InvalidInput(f"{name}: has elements of type {dtype}; on a device float32 or float64 is needed")
    if given.get("mask") is not None:
        raise InvalidInput(f"{name}: is masked; masks are not read")
    strides = given.get("strides")
    if strides is None:
        strides = [dtype.itemsize * int(np.prod(shape[k + 1 :], dtype=object)) for k in range(len(shape))]
    if len(strides) != len(shape) or min(shape, default=0) < 0:
        raise InvalidInput(f"{name}: has shape {shape}, but strides {tuple(strides)}")
    return CudaInput(
        value,
        int(given["data"][0]),
        dtype,
        shape,
        tuple(int(step) for step in strides),
        _stream_of(name, given),
    )


def _stream_of(name: str, given: dict[str, Any]) -> int | None:
    """The stream to wait for.

    Since version 3 the interface says it; None: the values are there. PyTorch, which has version 2,
    says nothing, and works on the legacy default stream unless told otherwise.
    """
    if int(given["version"]) < 3:
        return _LEGACY_STREAM
    stream = given.get("stream")
    if stream is None:
        return None
    if int(stream) <= 0:
        raise InvalidInput(f"{name}: its stream is {stream}, which the interface does not allow")
    return int(stream)


def _require_shape(name: str, shape: tuple[int, ...], shapes: tuple[str, ...]) -> None:
    """Dimensions as many as one of `shapes` has, three coordinates, and no empty array."""
    for wanted in shapes:
        if len(shape) != len(wanted.strip("(,)").split(",")):
            continue
        if wanted.endswith("3)") and shape[-1] != 3:
            break
        if 0 in shape:
            raise InvalidInput(f"{name}: is empty, of shape {shape}")
        return
    raise InvalidInput(f"{name}: has shape {shape}; {' or '.join(shapes)} is needed")


def require_cuda(device: str, name: str) -> None:
    """The argument `device` may not ask for the CPU."""
    if device == "cpu":
        raise InvalidInput(f'device: is "cpu", but {name} is on a CUDA device; copy it to the host')


def packed(array: NDArray[Any] | CudaInput) -> Any:
    """The array as the C++ side reads it, wherever it is."""
    return array.packed if isinstance(array, CudaInput) else array
