#!/usr/bin/env python3
"""How long vdwmesh takes to end after SIGTERM, in every stage, and what it leaves behind.

    scripts/signal-times.py build/release/apps/vdwmesh 6ZU5.cif.gz [SPACING]
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time


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
    process.send_signal(signal.SIGTERM)
    threading.Thread(target=process.stderr.read, daemon=True).start()
    code = process.wait()
    seconds = time.monotonic() - start
    left = sorted(p.name for p in folder.rglob("*") if p.is_file())
    print(f"{stage or 'read'} + {delay} s: {seconds:.2f} s, exit {code}, left {left}"
          f"{'' if there else ' (ended before that stage)'}", flush=True)


def main():
    program, molecule = sys.argv[1], sys.argv[2]
    spacing = sys.argv[3] if len(sys.argv) > 3 else "0.5"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mesh = ("mesh", molecule, "-o", folder / "a.ply", "--spacing", spacing)
        report = ("report", molecule, "--spacing", "1", "--subdivide", "0", "--json", folder / "a.json")
        for stage, delay, arguments in (
            (None, 0.1, mesh), (None, 0.4, mesh), ("search", 0, mesh), ("field", 0, mesh),
            ("extract", 0, mesh), ("extract", 1, mesh), ("measure", 0, mesh), ("measure", 3, mesh),
            ("measure", 6, mesh), ("write", 0, mesh), ("write", 0.3, mesh),
            ("write", 0, ("mesh", molecule, "-o", folder / "a.obj", "--spacing", spacing)),
            ("write", 2, ("mesh", molecule, "-o", folder / "a.glb", "--spacing", spacing)),
            ("refine", 1, (*mesh, "--subdivide", "1")),
            ("sample arcs", 0, ("mesh", molecule, "-o", folder / "a.ply", "--mesher", "exact")),
            ("mesh patches", 2, ("mesh", molecule, "-o", folder / "a.ply", "--mesher", "exact")),
            ("exact union", 0, report), ("exact union", 1.5, report),
            ("exposed surface", 0.3, report), ("distances of the mesh", 1, report),
            ("distances of the surface", 0.5, report),
            ("field", 1, ("study", molecule, "-o", folder / "study", "--spacing", "1")),
        ):
            end(program, arguments, folder, stage, delay)


main()
