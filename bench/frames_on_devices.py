"""Exact areas of a long trajectory on the devices of one host, a process for each device.

    PYTHONPATH=BUILD/python:bench python3 bench/frames_on_devices.py 4HHB.pdb [--frames 10000] [--processes 1,2,4]
                                                                     [--probe 1.4] [--chunk 64] [--folder /dev/shm]

The trajectory is one DCD file of the structure's protein (chains of ATOM records), whose atoms move by about
0.3 Å from frame to frame. Process i of P measures frames i F/P up to (i+1) F/P of it, on device i modulo their
number and on the i-th of P shares of the processors. Times are by the clock, from all processes ready, with
their device started and three chunks measured, to all frames measured; the fastest of three rounds. The sum of
all areas is rounded once, so it must be the same for any number of processes.
"""

import argparse
import math
import multiprocessing
import os
import pathlib
import tempfile
import time

import dcd
import numpy as np

ROUNDS = 3


def work(number, count, options, path, radii, barrier, results):
    os.environ["CUDA_VISIBLE_DEVICES"] = str(number % options.devices)
    processors = sorted(os.sched_getaffinity(0))
    share = len(processors) * number // count, max(1, len(processors) * (number + 1) // count)
    os.sched_setaffinity(0, processors[slice(*share)] or processors)
    import vdwmesh

    first, end = options.frames * number // count, options.frames * (number + 1) // count
    measure = {"radii": radii, "probe": options.probe, "chunk": options.chunk, "device": "cuda"}
    for _ in vdwmesh.frames(dcd.read(path, first, min(end, first + 3 * options.chunk)), **measure):
        pass
    for _ in range(ROUNDS):
        barrier.wait()
        areas = [frame.area for frame in vdwmesh.frames(dcd.read(path, first, end), **measure)]
        barrier.wait()
    results.put((number, areas))


def time_processes(count, options, path, radii):
    """The least seconds of the rounds, and the areas of all frames in their order."""
    context = multiprocessing.get_context("spawn")
    barrier, results = context.Barrier(count + 1), context.Queue()
    arguments = (count, options, path, radii, barrier, results)
    processes = [context.Process(target=work, args=(number, *arguments)) for number in range(count)]
    for process in processes:
        process.start()
    times = []
    for _ in range(ROUNDS):
        barrier.wait(120)
        begin = time.perf_counter()
        barrier.wait(600)
        times.append(time.perf_counter() - begin)
    areas = dict(results.get() for _ in processes)
    for process in processes:
        process.join()
    return min(times), [area for number in range(count) for area in areas[number]]


def moved(start, count):
    """64 frames, over and over."""
    random = np.random.default_rng(1)
    frames = [start + random.normal(0, 0.3, start.shape).astype(np.float32) for _ in range(64)]
    return (frames[i % len(frames)] for i in range(count))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("structure")
    parser.add_argument("--frames", type=int, default=10000)
    parser.add_argument("--processes", default="1,2,4")
    parser.add_argument("--devices", type=int, default=len(list(pathlib.Path("/dev").glob("nvidia[0-9]*"))) or 1)
    parser.add_argument("--probe", type=float, default=1.4)
    parser.add_argument("--chunk", type=int, default=64)
    parser.add_argument("--folder", default="/dev/shm")
    options = parser.parse_args()
    import vdwmesh

    molecule = vdwmesh.read(options.structure, hetatm=False)
    start, radii = np.array(molecule.coords, np.float32), np.array(molecule.radii)
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        path = f"{folder}/frames.dcd"
        dcd.write(path, moved(start, options.frames))
        print(f"{options.frames} frames of {len(start)} atoms, probe {options.probe} Å")
        one = None
        for count in map(int, options.processes.split(",")):
            seconds, areas = time_processes(count, options, path, radii)
            one = one or seconds * count
            print(
                f"{count:3} processes: {options.frames / seconds:8.0f} frames/s, efficiency {one / (count * seconds):.2f}, "
                f"sum of areas {math.fsum(areas)!r} Å²",
                flush=True,
            )


if __name__ == "__main__":
    main()
