"""Arrays on a GPU from Python: atoms in device memory to meshes and measures that stay there.

    PYTHONPATH=BUILD/python python3 bench/cuda_arrays_bench.py 6ZU5.xyzr [CALLS]

Needs a CUDA device and CuPy; PyTorch's tensors are timed as well where it is there. Times are of
whole calls from Python, which return when the device is done. Then the mesh is compared with the
CPU's, bit by bit, and memory is watched over CALLS calls (10,000) on a small molecule.
"""

import importlib.util
import os
import statistics
import sys
import time

import cupy
import numpy as np
import vdwmesh

GRID = {"mesher": "marching-cubes", "spacing": 0.5}
ARRAYS = ("vertices", "faces", "normals", "vertex_atoms")


def milliseconds(call, count):
    times = []
    for _ in range(count):
        start = time.perf_counter()
        kept = call()
        times.append(1e3 * (time.perf_counter() - start))
        del kept
    return times


def tell(name, times):
    print(f"{name:40} median {statistics.median(times):8.3f} ms, {min(times):.3f} to {max(times):.3f}", flush=True)


def atoms_by_library(molecule):
    """Coordinates and radii, by what holds them."""
    coords, radii = cupy.asarray(molecule.coords), cupy.asarray(molecule.radii)
    yield "CuPy", coords, radii
    yield "CuPy, float32", coords.astype(cupy.float32), radii.astype(cupy.float32)
    yield "CuPy, radii on the host", coords, molecule.radii
    if importlib.util.find_spec("torch"):
        import torch

        yield "PyTorch", *(torch.tensor(np.array(a), device="cuda") for a in (molecule.coords, molecule.radii))


def time_calls(molecule):
    coords, radii = cupy.asarray(molecule.coords), cupy.asarray(molecule.radii)
    tell("mesh, first call", milliseconds(lambda: vdwmesh.mesh(coords, radii, **GRID), 1))
    for name, places, sizes in atoms_by_library(molecule):
        tell(f"mesh, {name}", milliseconds(lambda: vdwmesh.mesh(places, sizes, **GRID), 100))
    tell("mesh, Blinn", milliseconds(lambda: vdwmesh.mesh(coords, radii, field="blinn", **GRID), 100))
    tell("mesh, host to host", milliseconds(lambda: vdwmesh.mesh(molecule, device="cuda", **GRID), 5))
    for probe in (0, 1.4):
        there = milliseconds(lambda: vdwmesh.exact(coords, radii, probe=probe), 100)
        tell(f"exact, probe {probe} Å", there)
        host = milliseconds(lambda: vdwmesh.exact(molecule, probe=probe, device="cuda"), 10)
        tell(f"exact, probe {probe} Å, host to host", host)


def compare_with_cpu(molecule):
    mesh = vdwmesh.mesh(cupy.asarray(molecule.coords), cupy.asarray(molecule.radii), **GRID)
    expected = vdwmesh.mesh(molecule, device="cpu", **GRID)
    for name in ARRAYS:
        found, wanted = cupy.asnumpy(cupy.asarray(getattr(mesh.cuda, name))), getattr(expected, name)
        same = (found.dtype, found.shape) == (wanted.dtype, wanted.shape) and found.tobytes() == wanted.tobytes()
        print(f"{name} {wanted.shape}: {'equal bit by bit' if same else 'DIFFERENT'}", flush=True)
        if not same:
            sys.exit(1)


def megabytes():
    """Used by this process on the host, and in all on the device."""
    pages = int(open("/proc/self/statm").read().split()[1])
    free, total = cupy.cuda.runtime.memGetInfo()
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6, (total - free) / 1e6


def watch_memory(calls):
    molecule = vdwmesh.sample("bpti")
    coords, radii = cupy.asarray(molecule.coords), cupy.asarray(molecule.radii)
    for call in range(calls + 1):
        mesh = vdwmesh.mesh(coords, radii, mesher="marching-cubes", spacing=1.0)
        kept = [cupy.asarray(mesh.cuda.vertices), mesh.cuda.faces.__dlpack__()]
        kept.append(vdwmesh.exact(coords, radii).cuda.atom_area)
        if call == calls // 100 or (call > 0 and call % (calls // 4) == 0):
            print("{} calls: host {:.1f} MB, device {:.1f} MB".format(call, *megabytes()), flush=True)


if __name__ == "__main__":
    given = vdwmesh.read(sys.argv[1])
    time_calls(given)
    compare_with_cpu(given)
    watch_memory(int(sys.argv[2]) if len(sys.argv) > 2 else 10_000)
