"""What calls of the Python package cost, beside others' Python packages, and what is wanted of them.

    PYTHONPATH=build/release/python:bench python3 bench/python_bench.py STRUCTURE.pdb [PROGRAM]

PROGRAM is the vdwmesh of the same build, whose report has the time of the C++ call. Each figure is the
best of several runs; ratios to others are by CPU time where it is said, else by the clock. Packages
that are not installed are left out. Takes about a minute.
"""

import json
import os
import pathlib
import resource
import subprocess
import sys
import threading

import numpy as np
import vdwmesh
from figures import Figures, best, cpu_seconds


def bench_import(figures):
    def run(code):
        before = cpu_seconds(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", code], check=True)
        return cpu_seconds(resource.RUSAGE_CHILDREN) - before

    bare, ours = (min(run(code) for _ in range(9)) for code in ("pass", "import vdwmesh"))
    figures.add("import vdwmesh", ours - bare, "CPU s", at_most=0.15, note=f"Python alone {bare:.3f}")


def bench_exact(figures, molecule, path, program):
    wall, _ = best(lambda: vdwmesh.exact(molecule, threads=1), 20)
    figures.add("exact, one thread", 1e3 * wall, "ms")
    if not program:
        return figures.left_out("  beside the C++ call", "no PROGRAM was named")
    command = [program, "exact", path, "--topology", "off", "--threads", "1", "--json", "-"]
    seconds = min(json.loads(subprocess.run(command, capture_output=True).stdout)["timing"]["exact"]
                  for _ in range(20))  # fmt: skip
    figures.add("  of the time of the C++ call", wall / seconds, "x", at_most=1.05, note=f"{1e3 * seconds:.2f} ms")


def bench_threads(figures, molecule):
    def work():
        for _ in range(20):
            vdwmesh.exact(molecule, threads=1)

    def in_threads(count):
        threads = [threading.Thread(target=work) for _ in range(count)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    one, two = (best(lambda: in_threads(count), 3)[0] for count in (1, 2))
    figures.add("rate of two threads of Python beside one", 2 * one / two, "x", at_least=1.8)


def bench_views(figures, molecule):
    """Whether arrays of a mesh are views: two arrays of one mesh have the same address."""
    mesh = vdwmesh.mesh(molecule, mesher="marching-cubes")
    handles = (mesh._handle.vertices(), mesh._handle.vertices())
    addresses = {np.asarray(handle).__array_interface__["data"][0] for handle in handles}
    figures.add("arrays of a mesh are views (addresses of two)", len(addresses), "address", at_most=1)


def bench_quality(figures):
    x = np.linspace(-1, 1, 545, dtype=np.float32)
    volume = 0.9 - np.sqrt(x[:175, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2)
    mesh = vdwmesh.marching_cubes(volume, 0)
    fresh = lambda: vdwmesh.Mesh._of(mesh._source)  # noqa: E731; keeps no measures of the call before
    wall, _ = best(lambda: (vdwmesh.quality(fresh()), fresh().volume))
    per_million = wall * 1e6 / len(mesh.faces)
    figures.add("quality and volume, a million faces", per_million, "s", at_most=0.3, note=f"{len(mesh.faces)} faces")


def bench_sasa(figures, molecule):
    _, ours = best(lambda: vdwmesh.sasa(molecule, threads=1))
    figures.add("sasa at 1.4 Å, one thread", 1e3 * ours, "CPU ms")
    try:
        import freesasa
    except ImportError:
        return figures.left_out("  freesasa", "not installed")
    freesasa.setVerbosity(freesasa.silent)
    options = freesasa.Parameters({"algorithm": freesasa.ShrakeRupley, "n-points": 100, "n-threads": 1})
    coords, radii = molecule.coords.ravel().tolist(), molecule.radii.tolist()
    _, theirs = best(lambda: freesasa.calcCoord(coords, radii, options))
    figures.add("  rate beside freesasa, S&R of 100 points", theirs / ours, "x CPU", at_least=2,
                note=f"{1e3 * theirs:.1f} ms")  # fmt: skip


def bench_mdtraj(figures, path):
    try:
        import mdtraj
    except ImportError:
        return figures.left_out("sasa beside mdtraj", "not installed")
    trajectory = mdtraj.load(path)
    elements = [atom.element.symbol for atom in trajectory.topology.atoms]
    radii = vdwmesh.radii_of(elements, unknown=1.7)
    _, ours = best(lambda: vdwmesh.sasa(10 * trajectory.xyz[0].astype(float), radii, threads=1))
    _, theirs = best(lambda: mdtraj.shrake_rupley(trajectory, n_sphere_points=100), 2)
    figures.add("  rate beside mdtraj, S&R of 100 points", theirs / ours, "x CPU")


def bench_volumes(figures):
    try:
        from skimage.measure import marching_cubes
    except ImportError:
        return figures.left_out("marching_cubes beside scikit-image", "not installed")
    x = np.linspace(-2 * np.pi, 2 * np.pi, 256, dtype=np.float32)
    a, b, c = x[:, None, None], x[None, :, None], x[None, None, :]
    gyroid = np.sin(a) * np.cos(b) + np.sin(b) * np.cos(c) + np.sin(c) * np.cos(a)
    ball = (5 - np.sqrt(a * a + b * b + c * c)).astype(np.float32)
    for name, volume in (("gyroid", gyroid), ("ball", ball)):
        theirs = best(lambda: marching_cubes(volume, 0.0), 3)
        ours = best(lambda: vdwmesh.marching_cubes(volume, 0.0))
        single = best(lambda: vdwmesh.marching_cubes(volume, 0.0, threads=1))
        figures.add(f"marching_cubes 256³ {name}, rate beside scikit-image", theirs[0] / ours[0], "x",
                    at_least=5, note=f"{1e3 * theirs[0]:.0f} and {1e3 * ours[0]:.0f} ms")  # fmt: skip
        figures.add("  one thread", theirs[1] / single[1], "x CPU", note=f"{1e3 * single[1]:.0f} ms")


def bench_memory(figures):
    """Growth over 10,000 calls of all kinds, after as many as memory takes to settle."""
    coords = np.random.default_rng(1).random((200, 3)) * 12
    radii, volume = np.full(200, 1.6), np.random.default_rng(2).random((16, 16, 16), np.float32)

    def calls(count):
        for _ in range(count // 5):
            vdwmesh.exact(coords, radii, topology="counts")
            vdwmesh.sasa(coords, radii, mode="atom")
            mesh = vdwmesh.mesh(coords, radii, mesher="marching-cubes", spacing=1.0)
            kept = mesh.vertices, vdwmesh.marching_cubes(volume, 0.9).faces
            del mesh, kept
            try:
                vdwmesh.exact(coords, -radii)
            except ValueError:
                pass

    def resident():
        return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6

    calls(2000)
    before = resident()
    calls(10_000)
    figures.add("growth of the memory over 10,000 calls", resident() - before, "MB", at_most=4)


def main(path, program=None):
    molecule = vdwmesh.read(path)
    figures = Figures(f"{len(molecule)} atoms of {path}")
    bench_import(figures)
    bench_exact(figures, molecule, path, program)
    bench_threads(figures, molecule)
    bench_views(figures, molecule)
    bench_quality(figures)
    bench_sasa(figures, molecule)
    bench_mdtraj(figures, path)
    bench_volumes(figures)
    bench_memory(figures)
    figures.summary()


if __name__ == "__main__":
    main(*sys.argv[1:])
