"""What trajectories, libraries of structures and their files cost, beside others', and what is wanted.

    PYTHONPATH=build/release/python:bench /usr/bin/python3 bench/frames_bench.py \\
        [frames] [batch] [reading] --program build/release/apps/vdwmesh --shared ../shared [--short]

With no part named, all of them: less than five minutes on two quiet cores. --short takes a tenth of the
long trajectories and of the structures. Rates are by the clock, ratios to others by CPU time where they
say so. Needs MDAnalysis and the programs of the build; others are left out where they are not installed.

The atoms of 4HHB's protein move by about 0.3 Å from frame to frame (seeded). The structures are those of
`make_structures.py`, the large set those of `make_ribosomes.py`.
"""

import argparse
import gzip
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import warnings

import numpy as np
import vdwmesh
from figures import Figures, measured

warnings.simplefilter("ignore")
HERE = pathlib.Path(__file__).resolve().parent
OPTIONS = {
    "probe 0": {},
    "probe 1.4": {"probe": 1.4},
    "topology counts": {"topology": "counts"},
    "full topology": {"topology": True},
}
WANTED_RATES = {"probe 0": 200, "probe 1.4": 80, "topology counts": 150, "full topology": 60}
WANTED_RATIOS = {"probe 0": 4, "probe 1.4": 2}
PEERS_FRAMES = 20
LIBRARY = ("thesis/4HHB", "special/19HC", "special/1F2N", "thesis/4INS", "thesis/1IZH", "thesis/1ORC",
           "thesis/1GZI", "special/1UBQ")  # fmt: skip


def exhaust(traj, **options):
    for _ in vdwmesh.frames(traj, **options):
        pass


def jittered(group, frames):
    start = group.positions.copy()
    random = np.random.default_rng(1)
    for _ in range(frames):
        yield start + random.normal(0, 0.3, start.shape).astype(np.float32)


def bench_array(figures, places, radii):
    """CPU seconds of a frame, from an array that is in memory."""
    costs = {}
    for name, options in OPTIONS.items():
        wall, cpu = measured(lambda: exhaust(places, radii=radii, **options))
        figures.add(f"array of {len(places)} frames, {name}", len(places) / wall, "frames/s", WANTED_RATES[name],
                    note=f"{1e3 * cpu / len(places):.2f} CPU ms a frame")  # fmt: skip
        costs[name] = cpu / len(places)
    return costs


def bench_frame_peers(figures, places, radii, top, ours):
    try:
        import freesasa

        freesasa.setVerbosity(freesasa.silent)
        coords = [place.astype(float).ravel().tolist() for place in places]
        for name, probe in (("probe 0", 1e-6), ("probe 1.4", 1.4)):
            parameters = freesasa.Parameters({"algorithm": freesasa.ShrakeRupley, "n-points": 100,
                                              "n-threads": 1, "probe-radius": probe})  # fmt: skip
            sizes = radii.tolist()
            _, cpu = measured(lambda: [freesasa.calcCoord(c, sizes, parameters) for c in coords])
            figures.add(f"rate per core beside freesasa S&R 100, {name}", cpu / len(places) / ours[name], "x CPU",
                        WANTED_RATIOS[name], note=f"{1e3 * cpu / len(places):.1f} CPU ms a frame")  # fmt: skip
    except ImportError:
        figures.left_out("freesasa", "not installed")
    try:
        import mdtraj

        trajectory = mdtraj.Trajectory(places / 10, mdtraj.load(top).topology)
        _, cpu = measured(lambda: mdtraj.shrake_rupley(trajectory, n_sphere_points=100))
        figures.add("rate per core beside mdtraj S&R 100, probe 1.4", cpu / len(places) / ours["probe 1.4"], "x CPU")
    except ImportError:
        figures.left_out("mdtraj", "not installed")


def peak_of_this_process():
    """In MiB. Unlike the figure of getrusage() it does not begin with what the parent held at the fork."""
    lines = pathlib.Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:")) / 1024


def measure_file(top, path, options):
    """Runs in a process of its own, whose peak memory is told."""
    import MDAnalysis

    universe = MDAnalysis.Universe(top, path)
    wall, _ = measured(lambda: exhaust(universe, **options))
    print(json.dumps([len(universe.trajectory), wall, peak_of_this_process()]))


def bench_files(figures, top, folder, few, many):
    import MDAnalysis

    peaks = {}
    for frames in (few, many):
        paths = [f"{folder}/{frames}.{extension}" for extension in ("dcd", "xtc")]
        group = MDAnalysis.Universe(top).atoms
        writers = [MDAnalysis.Writer(path, len(group)) for path in paths]
        for place in jittered(MDAnalysis.Universe(top).atoms, frames):
            group.positions = place
            for writer in writers:
                writer.write(group)
        for writer in writers:
            writer.close()
        for path in paths:
            for name in ("probe 0", "probe 1.4") if frames == few else ("probe 0",):
                command = [sys.executable, __file__, "--file", top, path, json.dumps(OPTIONS[name])]
                found = subprocess.run(command, capture_output=True, text=True, check=True).stdout
                count, wall, peak = json.loads(found.splitlines()[-1])
                figures.add(f"{path[-3:].upper()} of {count} frames, {name}", count / wall, "frames/s",
                            WANTED_RATES[name], note=f"peak {peak:.0f} MiB")  # fmt: skip
                if name == "probe 0":
                    peaks[frames, path[-3:]] = peak
    figures.add("peak memory of a trajectory", max(peaks.values()), "MiB", at_most=250)
    growth = max(peaks[many, kind] / peaks[few, kind] for kind in ("dcd", "xtc"))
    figures.add(f"peak memory of {many} frames beside {few}", growth, "x", at_most=1.05)


def bench_frames(figures, given, folder):
    import MDAnalysis

    top = f"{folder}/top.pdb"
    MDAnalysis.Universe(f"{given.shared}/molecules/thesis/4HHB.pdb").select_atoms("protein").write(top)
    group = MDAnalysis.Universe(top).atoms
    radii = vdwmesh.radii_of(group.types)
    places = np.array(list(jittered(group, 300)), np.float32)
    ours = bench_array(figures, places, radii)
    bench_frame_peers(figures, places[:PEERS_FRAMES], radii, top, ours)
    bench_files(figures, top, folder, 300, 1000 if given.short else 10_000)


# Starts a program and tells what it took. A process begins with the peak memory of the one that starts it,
# which is large here, so a small one does.
START = """
import json, os, sys, time
began = time.perf_counter()
started = os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ,
                          file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
_, status, used = os.wait4(started, 0)
print(json.dumps([os.waitstatus_to_exitcode(status), time.perf_counter() - began,
                  used.ru_utime + used.ru_stime, used.ru_maxrss / 1024]))
"""


def run_program(*command):
    """Wall time, CPU time in seconds and peak memory in MB of a program."""
    starter = [sys.executable, "-I", "-S", "-c", START, *map(str, command)]
    found = subprocess.run(starter, capture_output=True, text=True, check=True).stdout
    status, wall, cpu, peak = json.loads(found)
    if status != 0:
        sys.exit(f"{command}: ended with status {status}")
    return wall, cpu, peak


def bench_batch(figures, given, folder):
    count = 100 if given.short else 1000
    sources = [f"{given.shared}/molecules/{name}.pdb" for name in LIBRARY]
    subprocess.run([sys.executable, HERE / "make_structures.py", f"{folder}/many", str(count), *sources], check=True)
    rates, costs = {}, {}
    for probe, wanted in ((0, 250), (1.4, 100)):
        wall, cpu, peak = run_program(given.program, "batch", f"{folder}/many", "--probe", probe)
        rates[probe], costs[probe] = count / wall, cpu / count
        figures.add(f"batch of {count} files, probe {probe}", count / wall, "files/s", wanted,
                    note=f"{1e3 * cpu / count:.2f} CPU ms a file")  # fmt: skip
        figures.add("  peak memory", peak, "MB", at_most=150)
    few = 10  # files of which a report is made
    report = ("--verb", "report", "--shard", f"1/{count // few}")
    wall, cpu, _ = run_program(given.program, "batch", f"{folder}/many", *report)
    figures.add("batch --verb report", few / wall, "files/s", note=f"{1e3 * cpu / few:.0f} CPU ms a file")
    if not (shutil.which("parallel") and shutil.which("freesasa")):
        return figures.left_out("parallel freesasa", "parallel or freesasa is not installed")
    part = sorted(pathlib.Path(folder, "many").iterdir())[: count // 4]
    wall, cpu, _ = run_program("parallel", "-j", 2, "freesasa", "{}", ":::", *part)
    for probe in rates:
        figures.add(f"rate beside `parallel freesasa`, probe {probe}", rates[probe] * wall / len(part), "x", 6,
                    note=f"CPU {cpu / len(part) / costs[probe]:.1f} x")  # fmt: skip


def reading_times(given, paths, runs):
    """Atoms, and CPU seconds of the C++ reader for each file, by read_bench of the same build."""
    program = pathlib.Path(given.program).resolve().parent.parent / "bench" / "read_bench"
    found = subprocess.run([program, str(runs), *paths], capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in found.splitlines()[1:]]
    return int(rows[0][1]), *(float(row[2]) for row in rows)


def bench_reading(figures, given, folder):
    sys.path.insert(0, str(HERE.parent / "tests" / "cli"))
    import binary_cif

    entry = pathlib.Path(given.shared, "molecules/large/6ZU5.cif.gz")
    packed = pathlib.Path(folder, "6ZU5.bcif.gz")
    with gzip.open(entry) as file:
        pathlib.Path(folder, "6ZU5.cif").write_bytes(file.read())
    packed.write_bytes(gzip.compress(binary_cif.of_cif(f"{folder}/6ZU5.cif"), 6))
    copies = 3 if given.short else 15
    subprocess.run([sys.executable, HERE / "make_ribosomes.py", folder, entry, str(copies)], check=True)
    for text, binary in ((entry, packed), (f"{folder}/copies.cif.gz", f"{folder}/copies.bcif.gz")):
        atoms, slow, fast = reading_times(given, (text, binary), 9 if text == entry else 3)
        figures.add(f".bcif.gz of {atoms} atoms, rate beside .cif.gz", slow / fast, "x CPU", 4,
                    note=f"{1e3 * slow:.0f} and {1e3 * fast:.0f} CPU ms")  # fmt: skip


def main():
    parts = {"frames": bench_frames, "batch": bench_batch, "reading": bench_reading}
    parser = argparse.ArgumentParser()
    parser.add_argument("parts", nargs="*", choices=[*parts, []])
    parser.add_argument("--program", default="build/release/apps/vdwmesh")
    parser.add_argument("--shared", default="../shared")
    parser.add_argument("--short", action="store_true")
    given = parser.parse_args()
    figures = Figures("on all cores of this machine")
    for name in given.parts or parts:
        with tempfile.TemporaryDirectory() as folder:
            parts[name](figures, given, folder)
    figures.summary()


if __name__ == "__main__":
    if sys.argv[1:2] == ["--file"]:
        measure_file(sys.argv[2], sys.argv[3], json.loads(sys.argv[4]))
    else:
        main()
