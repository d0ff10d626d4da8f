"""How much faster more ranks are: wall time and efficiency of vdwmesh-mpi on one host, processor time and memory, as a table.

    ranks_table.py --program vdwmesh-mpi [--plain vdwmesh] [--ranks 1,2,4,8,16] [--repeats 3] [--folder /dev/shm]
                   [--exact FILE]... [--mesh FILE@SPACING]... [--refine FILE@SPACING]... [--crease-exact FILE@EDGE]...

A rank has one thread. The efficiency of P ranks is the time of one rank / (P x their time); of several runs the fastest
counts. Of `mesh` there are three stages: until the mesh is in memory, measuring it, and writing it to --folder. --refine is
`mesh` with one subdivision, --crease-exact `mesh --mesher exact`. --plain adds the plain program with as many threads as
ranks, and the ratio of the two times. Nothing else should run on the host: a rank that waits for a processor makes all
others wait. The last columns are of the run with the least processor time: processor seconds of one process, the first rank
or the plain program, by its report; and memory at its peak (Pss: a process's own and its part of what processes share,
twenty times a second), of the process that takes the most and of the next one.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
STAGES = {"exact": ("exact",), "mesh": ("mesh", "measure", "write", "mesh to file")}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--plain")
    parser.add_argument("--mpirun", default="mpirun")
    parser.add_argument("--ranks", default="1,2,4,8,16")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--folder", default="/dev/shm")
    for name in ("--exact", "--mesh", "--refine", "--crease-exact"):
        parser.add_argument(name, action="append", default=[])
    return parser.parse_args()


def cases(options):
    """The verb, a name and the rest of the command line of each case."""
    yield from (("exact", f"exact {Path(path).name}", [path, "--topology", "counts"]) for path in options.exact)
    for kind, refinement in (("mesh", []), ("refine", ["--subdivide", "1", "--crossings", "allow"])):
        for what in getattr(options, kind):
            path, spacing = what.rsplit("@", 1)
            yield "mesh", f"{kind} {Path(path).name} at {spacing} Å", [path, "--spacing", spacing, *refinement]
    for what in options.crease_exact:
        path, edge = what.rsplit("@", 1)
        yield "mesh", f"crease-exact mesh of {Path(path).name} at {edge} Å", [
            path, "--mesher", "exact", "--edge-length", edge]  # fmt: skip


def stage_times(verb, report):
    """Seconds of wall time by stage, on the first rank; a stage ends when all ranks have ended it."""
    timing = report["timing"]
    if verb == "exact":
        return {"exact": timing["exact"]}
    mesh = sum(timing[part] or 0 for part in ("field", "extract", "refine", "setup"))
    times = {"mesh": mesh, "measure": timing["measure"], "write": timing["write"]}
    return {**times, "mesh to file": sum(times.values()) + (timing.get("build") or 0)}


def proportional_memory(pid):
    """MiB; 0 of a process that has ended."""
    try:
        return int(re.search(r"^Pss: +(\d+) kB", Path(f"/proc/{pid}/smaps_rollup").read_text(), re.M)[1]) / 1024
    except (OSError, TypeError):
        return 0


def with_children(pid):
    yield pid
    for children in Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            for child in children.read_text().split():
                yield from with_children(int(child))
        except OSError:
            continue


def two_of(peaks):
    return "".join(f"{peak:11.0f}" for peak in peaks[:2])


def run_and_watch(command):
    """Peak memory of the processes of a command, MiB, the largest first."""
    peaks = {}
    with subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.DEVNULL) as started:
        while started.poll() is None:
            for pid in with_children(started.pid):
                peaks[pid] = max(peaks.get(pid, 0), proportional_memory(pid))
            time.sleep(0.05)
    if started.returncode != 0:
        sys.exit(f"{' '.join(command)}: ended with status {started.returncode}")
    return sorted(peaks.values(), reverse=True)


class Bench:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder

    def run(self, start, verb, rest):
        report = self.folder / "report.json"
        command = [*start, verb, *rest, "--json", report]
        if verb == "exact" and start == [self.options.plain]:
            command += ["--backend", "cpu"]
        if verb == "mesh":
            command += ["-o", self.folder / "mesh.ply", "--quiet", "--backend", "cpu"]
        peaks = run_and_watch([str(part) for part in command])
        found = json.loads(report.read_text())
        return stage_times(verb, found), (found["timing"]["cpu"]["total"], peaks)

    def best(self, start, verb, rest):
        """Seconds by stage; processor seconds of a process, and MiB of all, the largest first."""
        runs = [self.run(start, verb, rest) for _ in range(self.options.repeats)]
        return {stage: min(times[stage] for times, _ in runs) for stage in runs[0][0]}, min(used for _, used in runs)

    def ranks(self, count):
        return [self.options.mpirun, "-q", "--oversubscribe", "--bind-to", "core", "-n", count, self.options.program]

    def table(self, verb, name, rest):
        counts = [int(count) for count in self.options.ranks.split(",")]
        print(f"\n{name}: s, efficiency", flush=True)
        print("ranks " + "".join(f"{stage:>22}" for stage in STAGES[verb]) + "         CPU s   largest, next: MiB")
        first = None
        for count in counts:
            times, (cpu, peaks) = self.best(self.ranks(count), verb, [*rest, "--threads", "1"])
            first = first or {stage: seconds * count for stage, seconds in times.items()}
            print(f"{count:5} " + "".join(f"{seconds:13.3f} {100 * first[stage] / count / seconds:6.0f} %"
                                          for stage, seconds in times.items())
                  + f"{cpu:14.2f}{two_of(peaks[:count])}", flush=True)  # fmt: skip
            if self.options.plain:
                threads, (cpu, peaks) = self.best([self.options.plain], verb, [*rest, "--threads", count])
                print("plain " + "".join(f"{threads[stage]:13.3f} {times[stage] / threads[stage]:6.2f} x"
                                         for stage in times) + f"{cpu:14.2f}{two_of(peaks[:1])}", flush=True)  # fmt: skip


def main():
    options = arguments()
    print(f"{os.cpu_count()} processors; one thread a rank; fastest of {options.repeats}")
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        bench = Bench(options, Path(folder))
        for case in cases(options):
            bench.table(*case)


if __name__ == "__main__":
    main()
