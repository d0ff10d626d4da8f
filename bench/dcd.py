"""Trajectories in CHARMM's format DCD, for benchmarks on hosts without MDAnalysis: frames of float32
coordinates in the byte order of the machine, without cells, fixed atoms or a fourth dimension.

Each record of a DCD file stands between two counts of its bytes. The first has 20 integers, the second a
title, the third the number of atoms; then a frame is three records: all x, all y, all z, in Å.
"""

import struct

import numpy as np


def _record(data):
    count = struct.pack("<i", len(data))
    return count + data + count


def write(path, frames):
    """Writes the arrays of shape (N, 3) that `frames` yields. Returns their number."""
    with open(path, "wb") as file:
        count = 0
        for frame in frames:
            if count == 0:
                control = [0] * 20
                control[2] = control[1] = 1  # the first step, and steps between frames
                control[19] = 24  # the version of CHARMM
                file.write(_record(b"CORD" + struct.pack("<20i", *control)))
                file.write(_record(struct.pack("<i", 1) + b"A benchmark".ljust(80)))
                file.write(_record(struct.pack("<i", len(frame))))
            for axis in np.asarray(frame, "<f4").T:
                file.write(_record(axis.tobytes()))
            count += 1
        file.seek(8)
        file.write(struct.pack("<i", count))
    return count


def read(path, first=0, end=None):
    """Yields frames `first` up to `end` as float32 arrays of shape (N, 3), of which one at a time is read."""
    with open(path, "rb") as file:

        def record():
            (length,) = struct.unpack("<i", file.read(4))
            data = file.read(length)
            if struct.unpack("<i", file.read(4)) != (length,) or len(data) != length:
                raise ValueError(f"{path}: a record is cut off")
            return data

        head = record()
        if head[:4] != b"CORD":
            raise ValueError(f"{path}: is no DCD file")
        control = struct.unpack("<20i", head[4:])
        if control[8] or control[10] or control[11]:
            raise ValueError(f"{path}: has fixed atoms, cells or a fourth dimension, which are not read")
        frames = control[0]
        record()
        (atoms,) = struct.unpack("<i", record())
        wanted = 3 * (4 * atoms + 8)
        file.seek(first * wanted, 1)
        for _ in range(first, frames if end is None else end):
            data = file.read(wanted)
            if len(data) != wanted:
                raise ValueError(f"{path}: the last frame is cut off")
            rows = np.frombuffer(data, "<f4").reshape(3, atoms + 2)
            frame = np.empty((atoms, 3), np.float32)
            frame.T[...] = rows[:, 1:-1]
            yield frame
