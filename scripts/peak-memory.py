#!/usr/bin/env python3
"""Runs vdwmesh and prints the largest resident memory, in all and of each stage that its progress
bar names (sampled a hundred times a second), beside what it estimated before it began.

    scripts/peak-memory.py build/release/apps/vdwmesh report --sample ubiquitin --subdivide 1
"""

import json
import os
import re
import subprocess
import sys
import threading
import time


def resident(pid):
    """Bytes, 0 once the process is gone."""
    try:
        with open(f"/proc/{pid}/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError):
        return 0


def watch_stage(stream, current):
    text = ""
    while block := os.read(stream.fileno(), 4096):
        text = (text + block.decode(errors="replace"))[-400:]
        names = re.findall(r"\x1b\[K([a-z][a-z -]*[a-z]) +\[", text)
        if names:
            current[0] = names[-1]


def main():
    process = subprocess.Popen([*sys.argv[1:], "--progress", "--json", "-"], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    stage, peaks = ["read"], {}
    watcher = threading.Thread(target=watch_stage, args=(process.stderr, stage))
    watcher.start()
    output = []
    reader = threading.Thread(target=lambda: output.append(process.stdout.read()))
    reader.start()
    while process.returncode is None:
        peaks[stage[0]] = max(peaks.get(stage[0], 0), resident(process.pid))
        time.sleep(0.01)
        done, status, usage = os.wait4(process.pid, os.WNOHANG)
        if done:
            process.returncode = os.waitstatus_to_exitcode(status)
    watcher.join()
    reader.join()
    report = json.loads(output[0]) if output[0] else {}
    mesh, parameters = report.get("mesh") or {}, report.get("parameters") or {}
    print(f"exit {process.returncode}; {mesh.get('triangles')} triangles; "
          f"CPU {usage.ru_utime + usage.ru_stime:.1f} s; peak {usage.ru_maxrss / 1024:.1f} MiB; "
          f"estimated {(parameters.get('memory_estimate') or 0) / 2**20:.1f} MiB")
    for name, peak in peaks.items():
        print(f"  {name:12} {peak / 2**20:10.1f} MiB")


main()
