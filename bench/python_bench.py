"""What calls of the Python package cost, beside others' Python packages: CPU time and wall time.

    PYTHONPATH=build/release/python bench/python_bench.py STRUCTURE.pdb [PROGRAM]

PROGRAM is the vdwmesh of the same build, whose report has the time of the C++ call. Each figure is the
best of several runs. Packages that are not installed are left out.
"""

import json
import resource
import subprocess
import sys
import threading
import time

import numpy as np
import vdwmesh


def cpu_seconds(who=resource.RUSAGE_SELF):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def best(work, runs=5):
    """The least CPU time and the least wall time of several runs, seconds."""
    cpu, wall = [], []
    for _ in range(runs):
        began, used = time.perf_counter(), cpu_seconds()
        work()
        wall.append(time.perf_counter() - began)
        cpu.append(cpu_seconds() - used)
    return min(cpu), min(wall)


def show(name, cpu, wall, note=""):
    print(f"{name:44} {1e3 * cpu:10.1f} {1e3 * wall:10.1f}  {note}")


def bench_import():
    def run(code):
        before = cpu_seconds(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", code], check=True)
        return cpu_seconds(resource.RUSAGE_CHILDREN) - before

    for name in ("pass", "import numpy", "import vdwmesh"):
        seconds = min(run(name) for _ in range(9))
        show(f"python -c '{name}'", seconds, float("nan"))


def bench_exact(molecule, path, program):
    ours = best(lambda: vdwmesh.exact(molecule, threads=1), 20)
    show("exact, one thread", *ours)
    if program:
        command = [program, "exact", path, "--topology", "off", "--threads", "1", "--json", "-"]
        seconds = min(json.loads(subprocess.run(command, capture_output=True).stdout)["timing"]["exact"]
                      for _ in range(20))  # fmt: skip
        show("  the C++ call of the program", float("nan"), seconds, f"ours takes {ours[1] / seconds:.3f} x")


def bench_threads(molecule):
    def work():
        for _ in range(20):
            vdwmesh.exact(molecule, threads=1)

    def in_threads(count):
        threads = [threading.Thread(target=work) for _ in range(count)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    one, two = best(lambda: in_threads(1), 3), best(lambda: in_threads(2), 3)
    show("20 calls in one thread of Python", *one)
    show("20 calls in each of two", *two, f"{2 * one[1] / two[1]:.2f} x the rate by wall time")


def bench_quality():
    x = np.linspace(-1, 1, 500, dtype=np.float32)
    volume = 0.9 - np.sqrt(x[:160, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2)
    mesh = vdwmesh.marching_cubes(volume, 0)
    show(f"quality of {len(mesh.faces)} faces", *best(lambda: vdwmesh.quality(mesh)))


def bench_sasa(molecule):
    ours = best(lambda: vdwmesh.sasa(molecule, threads=1))
    show("sasa, one thread", *ours)
    try:
        import freesasa
    except ImportError:
        return
    freesasa.setVerbosity(freesasa.silent)
    options = freesasa.Parameters({"algorithm": freesasa.ShrakeRupley, "n-points": 100, "n-threads": 1})
    coords, radii = molecule.coords.ravel().tolist(), molecule.radii.tolist()
    theirs = best(lambda: freesasa.calcCoord(coords, radii, options))
    show("  freesasa, S&R of 100 points, one thread", *theirs, f"{theirs[0] / ours[0]:.2f} x ours")


def bench_mdtraj(path):
    try:
        import mdtraj
    except ImportError:
        return
    trajectory = mdtraj.load(path)
    elements = [atom.element.symbol for atom in trajectory.topology.atoms]
    radii = vdwmesh.radii_of(elements, unknown=1.7)
    ours = best(lambda: vdwmesh.sasa(10 * trajectory.xyz[0].astype(float), radii, threads=1))
    theirs = best(lambda: mdtraj.shrake_rupley(trajectory, n_sphere_points=100), 2)
    show("sasa of mdtraj's atoms, one thread", *ours)
    show("  mdtraj, S&R of 100 points", *theirs, f"{theirs[0] / ours[0]:.2f} x ours")


def bench_volumes():
    try:
        from skimage.measure import marching_cubes
    except ImportError:
        return
    x = np.linspace(-2 * np.pi, 2 * np.pi, 256, dtype=np.float32)
    a, b, c = x[:, None, None], x[None, :, None], x[None, None, :]
    gyroid = np.sin(a) * np.cos(b) + np.sin(b) * np.cos(c) + np.sin(c) * np.cos(a)
    ball = (5 - np.sqrt(a * a + b * b + c * c)).astype(np.float32)
    for name, volume in (("gyroid", gyroid), ("ball", ball)):
        theirs = best(lambda: marching_cubes(volume, 0.0), 3)
        for threads in (1, None):
            ours = best(lambda: vdwmesh.marching_cubes(volume, 0.0, threads=threads))
            note = f"scikit-image / ours: CPU {theirs[0] / ours[0]:.1f}, wall {theirs[1] / ours[1]:.1f}"
            show(f"marching_cubes 256³ {name}, {threads or 'all'} threads", *ours, note)
        show("  scikit-image", *theirs)


def main(path, program=None):
    molecule = vdwmesh.read(path)
    print(f"{len(molecule)} atoms of {path}; milliseconds\n{'':44} {'CPU':>10} {'wall':>10}")
    bench_import()
    bench_exact(molecule, path, program)
    bench_threads(molecule)
    bench_quality()
    bench_sasa(molecule)
    bench_mdtraj(path)
    bench_volumes()


if __name__ == "__main__":
    main(*sys.argv[1:])
