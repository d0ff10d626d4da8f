#!/usr/bin/env python3
"""How long vdwmesh takes to end after a signal, in every stage, and what it leaves behind.

    scripts/signal-times.py build/release/apps/vdwmesh 6ZU5.cif.gz [SPACING [VERB...]]

SIGTERM, or SIGINT where the environment has SIGNAL=INT.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

SIGNAL = signal.Signals["SIG" + os.environ.get("SIGNAL", "TERM")]


def wait_for(process, stage):
    seen = b""
    while stage.encode() not in seen:
        block = os.read(process.stderr.fileno(), 4096)
        if not block:
            return False
        seen = seen[-200:] + block
    return True


def end(program, arguments, folder, stage, delay):
    process = subprocess.Popen([program, *map(str, arguments), "--progress"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    there = stage is None or wait_for(process, stage)
    time.sleep(delay)
    start = time.monotonic()
    process.send_signal(SIGNAL)
    threading.Thread(target=process.stderr.read, daemon=True).start()
    code = process.wait()
    seconds = time.monotonic() - start
    left = sorted(p.name for p in folder.rglob("*") if p.is_file())
    print(f"{arguments[0]}, {stage or 'read'} + {delay} s: {seconds:.2f} s, exit {code}, left {left}"
          f"{'' if there else ' (ended before that stage)'}", flush=True)


def main():
    program, molecule = sys.argv[1], sys.argv[2]
    spacing = sys.argv[3] if len(sys.argv) > 3 else "0.5"
    verbs = sys.argv[4:] or ("mesh", "report", "compare", "study")
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as other:
        folder, given = pathlib.Path(name), pathlib.Path(other) / "given.ply"
        if "compare" in verbs:
            subprocess.run([program, "mesh", molecule, "-o", given, "--spacing", spacing, "--quiet"],
                           check=True)
        mesh = ("mesh", molecule, "-o", folder / "a.ply", "--spacing", spacing)
        exact = ("mesh", molecule, "-o", folder / "a.ply", "--mesher", "exact")
        compare = ("compare", given, molecule, "--json", folder / "a.json")
        study = ("study", molecule, "-o", folder / "study", "--spacing", "1", "--subdivide", "1")
        report = ("report", molecule, "--spacing", "1", "--subdivide", "0", "--json", folder / "a.json")
        for stage, delay, arguments in (
            (None, 0.1, mesh), (None, 0.4, mesh), ("search", 0, mesh), ("field", 0, mesh),
            ("extract", 0, mesh), ("extract", 1, mesh), ("measure", 0, mesh), ("measure", 3, mesh),
            ("measure", 6, mesh), ("write", 0, mesh), ("write", 0.3, mesh),
            *(("write", delay, ("mesh", molecule, "-o", folder / f"a.{kind}", "--spacing", spacing))
              for kind in ("obj", "off", "stl", "glb") for delay in (0, 0.4)),
            ("refine", 1, (*mesh, "--subdivide", "1")),
            ("sample arcs", 0, exact), ("sample arcs", 0.5, exact), ("mesh patches", 0, exact),
            ("mesh patches", 2, exact), ("mesh patches", 6, exact),
            ("exact union", 0, report), ("exact union", 1.5, report), ("exact union", 4, report),
            (None, 0.7, compare), ("measure", 0, compare), ("measure", 2, compare),
            ("exact union", 2, compare), ("exposed surface", 0.3, compare),
            ("distances of the mesh", 1, compare), ("distances of the mesh", 10, compare),
            ("distances of the surface", 0.5, compare),
            *((stage, delay, study) for stage, delay in (
                # The exact union comes before the first run, so nothing announces it.
                *((None, late) for late in (0.3, 1.5, 3, 5)),
                ("field", 0.2), ("extract", 0.2), ("refine", 0.5), ("measure", 1),
                *(("distances of the mesh", late) for late in (1, 10, 30)),
                ("distances of the surface", 1))),
        ):
            if arguments[0] in verbs:
                end(program, arguments, folder, stage, delay)


main()
