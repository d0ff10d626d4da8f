"""Figures of the package for Python on a CUDA device: arrays that stay there, and trajectories.

    PYTHONPATH=BUILD/python:bench python3 bench/cuda_arrays_bench.py 6ZU5.xyzr.gz 4HHB.pdb [CALLS]

Needs a CUDA device and NumPy. Arrays on the device are made by the driver itself
(tests/python/device_memory.py), and by CuPy and PyTorch where they are installed. Times are of whole calls
from Python, which return when the device is done. The mesh is compared with the CPU's, bit by bit, and
memory is watched over CALLS calls (10,000) on a small molecule. Trajectories are DCD files of the
structure's protein (chains of ATOM records), whose atoms move by about 0.3 Å from frame to frame.
"""

import ctypes
import importlib.util
import os
import pathlib
import statistics
import sys
import tempfile
import time

import dcd
import numpy as np
import vdwmesh
from figures import Figures, measured

HERE = pathlib.Path(__file__).resolve().parent
os.environ.setdefault("VDWMESH_PROGRAM", "vdwmesh")
os.environ.setdefault("VDWMESH_SOURCE_DIR", str(HERE.parent))
sys.path[1:1] = [str(HERE.parent / "tests" / "python"), str(HERE.parent / "tests" / "cli")]
import device_memory  # noqa: E402
from device_memory import OnDevice, values_of  # noqa: E402

GRID = {"mesher": "marching-cubes", "spacing": 0.5}
ARRAYS = ("vertices", "faces", "normals", "vertex_atoms")
FRAMES = 1024


def milliseconds(call, count):
    times = []
    for _ in range(count):
        start = time.perf_counter()
        kept = call()
        times.append(1e3 * (time.perf_counter() - start))
        del kept
    return times


def tell(figures, name, times, **wanted):
    figures.add(name, statistics.median(times), "ms", **wanted, note=f"{min(times):.2f} to {max(times):.2f}")


def arrays_by_library(molecule):
    """Coordinates and radii on the device, by what holds them."""
    host = np.array(molecule.coords), np.array(molecule.radii)
    yield "arrays of the driver", *map(OnDevice, host)
    yield "the same, float32", *(OnDevice(a.astype(np.float32)) for a in host)
    yield "the same, radii on the host", OnDevice(host[0]), host[1]
    if importlib.util.find_spec("cupy"):
        import cupy

        yield "CuPy", *map(cupy.asarray, host)
    if importlib.util.find_spec("torch"):
        import torch

        yield "PyTorch", *(torch.tensor(a, device="cuda") for a in host)


def time_calls(figures, molecule):
    coords, radii = OnDevice(molecule.coords), OnDevice(molecule.radii)
    tell(figures, "mesh, first call", milliseconds(lambda: vdwmesh.mesh(coords, radii, **GRID), 1))
    for name, places, sizes in arrays_by_library(molecule):
        times = milliseconds(lambda: vdwmesh.mesh(places, sizes, **GRID), 100)  # noqa: B023
        tell(figures, f"mesh, {name}", times, at_most=4)
    tell(figures, "mesh, Blinn", milliseconds(lambda: vdwmesh.mesh(coords, radii, field="blinn", **GRID), 100))
    tell(figures, "mesh, host to host", milliseconds(lambda: vdwmesh.mesh(molecule, device="cuda", **GRID), 5))
    for probe in (0, 1.4):
        there = milliseconds(lambda: vdwmesh.exact(coords, radii, probe=probe), 100)  # noqa: B023
        tell(figures, f"exact, probe {probe} Å", there)
        host = milliseconds(lambda: vdwmesh.exact(molecule, probe=probe, device="cuda"), 10)  # noqa: B023
        tell(figures, f"exact, probe {probe} Å, host to host", host)


def compare_with_cpu(figures, molecule):
    mesh = vdwmesh.mesh(OnDevice(molecule.coords), OnDevice(molecule.radii), **GRID)
    expected = vdwmesh.mesh(molecule, device="cpu", **GRID)
    different = 0
    for name in ARRAYS:
        found, wanted = values_of(getattr(mesh.cuda, name)), getattr(expected, name)
        same = (found.dtype, found.shape) == (wanted.dtype, wanted.shape)
        different += not (same and found.tobytes() == wanted.tobytes())
    figures.add("arrays of the mesh that are not the CPU's, bit by bit", different, "arrays", at_most=0)


def megabytes():
    """Used by this process on the host, and in all on the device."""
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    free, total = ctypes.c_size_t(), ctypes.c_size_t()
    assert device_memory._driver().cuMemGetInfo_v2(ctypes.byref(free), ctypes.byref(total)) == 0
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6, (total.value - free.value) / 1e6


def watch_memory(figures, calls):
    molecule = vdwmesh.sample("bpti")
    coords, radii = OnDevice(molecule.coords), OnDevice(molecule.radii)

    def run(count):
        for _ in range(count):
            mesh = vdwmesh.mesh(coords, radii, mesher="marching-cubes", spacing=1.0)
            kept = [mesh.cuda.vertices, mesh.cuda.faces.__dlpack__()]
            kept.append(vdwmesh.exact(coords, radii).cuda.atom_area)
        del mesh, kept

    run(max(1, calls // 20))
    before = megabytes()
    run(calls)
    for name, now, then in zip(("host", "device"), megabytes(), before):
        figures.add(f"growth of the memory of the {name} over {calls} calls", now - then, "MB", at_most=4)


def time_frames(figures, molecule):
    """Frames of a real file, of an iterable, and of an array on the device."""
    start = np.array(molecule.coords, np.float32)
    radii, random = np.array(molecule.radii), np.random.default_rng(1)
    frames = [start + random.normal(0, 0.3, start.shape).astype(np.float32) for _ in range(64)]
    there = OnDevice(np.array(frames))

    def rate(name, traj, count, **options):
        def run():
            for _ in vdwmesh.frames(traj(), radii=radii, device="cuda", **options):
                pass

        run()  # the device and its memory are there then
        wall, cpu = min(measured(run) for _ in range(3))
        wanted = 4500 if "DCD" in name and options["probe"] == 1.4 else None
        figures.add(name, count / wall, "frames/s", wanted, note=f"{1e3 * cpu / count:.3f} CPU ms a frame")

    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/frames.dcd"
        dcd.write(path, (frames[i % len(frames)] for i in range(FRAMES)))
        figures.add("DCD read alone", FRAMES / measured(lambda: sum(1 for _ in dcd.read(path)))[0], "frames/s")
        for probe in (0, 1.4):
            for chunk in (64, 128):
                rate(f"DCD of {FRAMES} frames, probe {probe} Å, chunk {chunk}", lambda: dcd.read(path), FRAMES,
                     probe=probe, chunk=chunk)  # fmt: skip
    for probe in (0, 1.4):
        many = np.array(frames * (FRAMES // len(frames)))
        rate(f"array on the host, probe {probe} Å", lambda: many, FRAMES, probe=probe)
        rate(f"64 frames on the device, probe {probe} Å", lambda: there, 64, probe=probe)
    one = vdwmesh.exact(frames[5], radii, probe=1.4, device="cpu")
    found = next(f for f in vdwmesh.frames(frames[:6], radii=radii, probe=1.4, device="cuda") if f.frame == 5)
    figures.add("area of a frame beside the CPU's", abs(found.area / one.area - 1), "relative", at_most=1e-12)


def main(ribosome, protein, calls=10_000):
    figures = Figures("on the CUDA device")
    given = vdwmesh.read(ribosome)
    time_calls(figures, given)
    compare_with_cpu(figures, given)
    time_frames(figures, vdwmesh.read(protein, hetatm=False))
    watch_memory(figures, int(calls))
    figures.summary()


if __name__ == "__main__":
    main(*sys.argv[1:])
