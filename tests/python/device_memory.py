"""Arrays in the memory of a CUDA device, by the driver alone: needs neither CuPy nor PyTorch."""

import ctypes
import functools

import numpy as np
import vdwmesh
from program import missing


@functools.cache
def _driver():
    """The driver's library with the first device's primary context; None where there is none."""
    try:
        cuda = ctypes.CDLL("libcuda.so.1")
    except OSError:
        return None
    if cuda.cuInit(0) != 0:
        return None
    device, context = ctypes.c_int(), ctypes.c_void_p()
    if cuda.cuDeviceGet(ctypes.byref(device), 0) != 0:
        return None
    assert cuda.cuDevicePrimaryCtxRetain(ctypes.byref(context), device) == 0
    assert cuda.cuCtxSetCurrent(context) == 0
    return cuda


def need_device():
    """Skips where no device can be used; VDWMESH_REQUIRE_CUDA=1 makes that a failure."""
    try:
        vdwmesh.exact([[0, 0, 0]], [1], device="cuda")
    except vdwmesh.BackendUnavailable as error:
        missing("VDWMESH_REQUIRE_CUDA", str(error))
    assert _driver() is not None


class OnDevice:
    """A copy of a NumPy array on the device, or a view of such a copy with other strides."""

    def __init__(self, array, stream=None):
        array = np.ascontiguousarray(array)
        self.shape, self.strides, self.dtype, self.stream = array.shape, array.strides, array.dtype, stream
        self.address = _allocate(array.nbytes)
        self.offset = 0
        assert _driver().cuMemcpyHtoD_v2(self.address, array.ctypes.data_as(ctypes.c_void_p),
                                         ctypes.c_size_t(array.nbytes)) == 0  # fmt: skip

    @property
    def __cuda_array_interface__(self):
        return {"shape": self.shape, "typestr": self.dtype.str, "version": 3, "stream": self.stream,
                "strides": self.strides, "data": (self.address.value + self.offset, True)}  # fmt: skip

    def __del__(self):
        _driver().cuMemFree_v2(self.address)


def _allocate(size):
    address = ctypes.c_uint64()
    assert _driver().cuMemAlloc_v2(ctypes.byref(address), ctypes.c_size_t(max(size, 1))) == 0
    return address


def values_of(array):
    """The values of an array of a result, read by the driver as any other library would."""
    given = array.__cuda_array_interface__
    dtype, shape = np.dtype(given["typestr"]), given["shape"]
    strides = given["strides"] or np.empty(shape, dtype).strides
    last = sum((n - 1) * step for n, step in zip(shape, strides))
    room = np.empty(last + dtype.itemsize, np.uint8)
    assert _driver().cuMemcpyDtoH_v2(room.ctypes.data_as(ctypes.c_void_p),
                                     ctypes.c_uint64(given["data"][0]), ctypes.c_size_t(room.nbytes)) == 0  # fmt: skip
    return np.ndarray(shape, dtype, room, strides=strides).copy()
