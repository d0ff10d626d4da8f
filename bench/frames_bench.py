"""What exact measures of trajectories cost, beside others': rates, CPU time, and peak memory.

    PYTHONPATH=build/release/python python3 bench/frames_bench.py STRUCTURE.pdb [FRAMES...] [--device cuda]

The atoms of the protein move by about 0.3 Å from frame to frame (seeded). FRAMES are numbers of
frames; of the first all figures are taken, of the others the time and the peak memory at probe 0, from
files. Needs MDAnalysis; freesasa and mdtraj are compared with where they are installed.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
import warnings

import numpy as np
import vdwmesh

warnings.simplefilter("ignore")
OPTIONS = {
    "probe 0": {},
    "probe 1.4": {"probe": 1.4},
    "topology counts": {"topology": "counts"},
    "full topology": {"topology": True},
}
PEERS_FRAMES = 20


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def measured(work):
    """Wall time and CPU time, seconds."""
    began, used = time.perf_counter(), cpu_seconds()
    work()
    return time.perf_counter() - began, cpu_seconds() - used


def show(name, frames, wall, cpu, note=""):
    print(f"{name:44} {frames / wall:10.1f} {frames / cpu:10.1f}  {note}", flush=True)


def exhaust(traj, **options):
    for _ in vdwmesh.frames(traj, **options):
        pass


def jittered(group, frames):
    start = group.positions.copy()
    random = np.random.default_rng(1)
    for _ in range(frames):
        yield start + random.normal(0, 0.3, start.shape).astype(np.float32)


def bench_memory_array(places, radii, device):
    """The rates from an array that is in memory, by which those of the peers are divided."""
    rates = {}
    for name, options in OPTIONS.items():
        if device == "cuda" and "topology" in options:
            continue
        wall, cpu = measured(lambda: exhaust(places, radii=radii, device=device, **options))
        show(f"array, {name}", len(places), wall, cpu)
        rates[name] = len(places) / cpu
    return rates


def bench_freesasa(places, radii, ours):
    try:
        import freesasa
    except ImportError:
        return
    freesasa.setVerbosity(freesasa.silent)
    for name, probe in (("probe 0", 1e-6), ("probe 1.4", 1.4)):
        parameters = freesasa.Parameters({"algorithm": freesasa.ShrakeRupley, "n-points": 100,
                                          "n-threads": 1, "probe-radius": probe})  # fmt: skip
        coords = [place.astype(float).ravel().tolist() for place in places]
        sizes = radii.tolist()
        wall, cpu = measured(lambda: [freesasa.calcCoord(c, sizes, parameters) for c in coords])
        show(f"freesasa, S&R of 100 points, {name}", len(places), wall, cpu,
             f"ours per core {ours[name] * cpu / len(places):.1f} x")  # fmt: skip


def bench_mdtraj(places, top, ours):
    try:
        import mdtraj
    except ImportError:
        return
    trajectory = mdtraj.Trajectory(places / 10, mdtraj.load(top).topology)
    wall, cpu = measured(lambda: mdtraj.shrake_rupley(trajectory, n_sphere_points=100))
    show("mdtraj, S&R of 100 points, probe 1.4", len(places), wall, cpu,
         f"ours per core {ours['probe 1.4'] * cpu / len(places):.1f} x")  # fmt: skip


def bench_file(top, path, options):
    """Runs in a process of its own, whose peak memory is told."""
    import MDAnalysis

    universe = MDAnalysis.Universe(top, path)
    frames = len(universe.trajectory)
    wall, cpu = measured(lambda: exhaust(universe, **options))
    print(json.dumps([frames, wall, cpu, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024]))


def bench_files(top, paths, device, names):
    for path in paths:
        for name in names:
            options = json.dumps({**OPTIONS[name], "device": device})
            command = [sys.executable, __file__, "--file", top, path, options]
            found = subprocess.run(command, capture_output=True, text=True, check=True).stdout
            frames, wall, cpu, peak = json.loads(found.splitlines()[-1])
            show(f"{path[-3:].upper()}, {frames} frames, {name}", frames, wall, cpu, f"peak {peak:.0f} MiB")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("structure")
    parser.add_argument("frames", nargs="*", type=int, default=[300])
    parser.add_argument("--device", default="auto")
    given = parser.parse_args()
    import MDAnalysis

    whole = MDAnalysis.Universe(given.structure)
    with tempfile.TemporaryDirectory() as folder:
        top = f"{folder}/top.pdb"
        whole.select_atoms("protein").write(top)
        group = MDAnalysis.Universe(top).atoms
        print(f"{len(group)} atoms of {given.structure}\n{'frames per second of':44} {'wall':>10} {'CPU':>10}")
        radii = vdwmesh.radii_of(group.types)
        places = np.array(list(jittered(group, given.frames[0])), np.float32)
        ours = bench_memory_array(places, radii, given.device)
        bench_freesasa(places[:PEERS_FRAMES], radii, ours)
        bench_mdtraj(places[:PEERS_FRAMES], top, ours)
        for frames in given.frames:
            paths = [f"{folder}/{frames}.{extension}" for extension in ("dcd", "xtc")]
            writers = [MDAnalysis.Writer(path, len(group)) for path in paths]
            for place in jittered(MDAnalysis.Universe(top).atoms, frames):
                group.positions = place
                for writer in writers:
                    writer.write(group)
            for writer in writers:
                writer.close()
            names = ("probe 0", "probe 1.4") if frames == given.frames[0] else ("probe 0",)
            bench_files(top, paths, given.device, names)


if __name__ == "__main__":
    if sys.argv[1] == "--file":
        bench_file(sys.argv[2], sys.argv[3], json.loads(sys.argv[4]))
    else:
        main()
