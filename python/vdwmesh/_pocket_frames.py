"""Pockets of the frames of trajectories, followed through time in constant memory."""

from __future__ import annotations

import csv
import os
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterator

from vdwmesh import _core
from vdwmesh._arrays import thread_count
from vdwmesh._cuda import is_on_device
from vdwmesh._frames import chunk_size, radii_of_frames
from vdwmesh._pockets import Pocket, is_exact, pocket_of
from vdwmesh._trajectories import Trajectory, Window, trajectory_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike


@dataclass(frozen=True)
class PocketFrame:
    """The pockets of one frame.

    Attributes
    ----------
    frame : int
        Its number in the trajectory, from 0.
    time : float or None
        As of `FrameResult`.
    pockets : dict of int to Pocket
        By the number of the track that they continue, in the order of `pockets`.
    overlaps : dict of int to float
        Of the atoms of each with those that its track had last; 0 where the track begins.
    """

    frame: int
    time: float | None
    pockets: dict[int, Pocket]
    overlaps: dict[int, float]


def pocket_frames(
    traj: Any,
    *,
    radii: ArrayLike | str = "bondi",
    select: Any = None,
    probe: float | None = None,
    measures: str = "exact",
    overlap: float = 1 / 3,
    patience: int = 10,
    start: int | None = None,
    stop: int | None = None,
    step: int | None = None,
    chunk: int = 16,
    threads: int | None = None,
) -> Iterator[PocketFrame]:
    """Pockets of each frame of a trajectory, with a number that they keep through time.

    A pocket continues the track whose last pocket shares most atoms with it: those at the corners of
    its tetrahedra, by Jaccard's index, the number that both have by the number that either has.
    Pairs of track and pocket are taken by falling overlap, of equal ones first the lower track, then
    the larger pocket. What is left begins tracks, numbered from 1. Two chunks of frames are in memory.

    Parameters
    ----------
    traj, radii, select, start, stop, step, chunk, threads
        As of `frames`; not in the memory of a device.
    probe, measures
        As of `pockets`.
    overlap : float
        The least of a pocket and its track, above 0 and at most 1. With 1/3, two sets of one size have
        half of each in common.
    patience : int
        Frames for which a track waits for its pocket to come back, before it ends.

    Yields
    ------
    PocketFrame
        With the digits that `pockets` gives for the frame alone.

    Raises
    ------
    InvalidInput
        As of `frames`.

    Examples
    --------
    A cage that opens by one bar:

    >>> import itertools, numpy, vdwmesh
    >>> cage = numpy.array(list(itertools.product((0, 4.6), repeat=3)))
    >>> path = [cage * scale for scale in (1, 1.02)]
    >>> for frame in vdwmesh.pocket_frames(path, radii=[1.5] * 8):
    ...     print(frame.frame, {track: round(p.volume, 3) for track, p in frame.pockets.items()})
    0 {1: 13.497}
    1 {1: 16.842}
    """
    exact, size, workers = is_exact(measures), chunk_size(chunk), thread_count(threads)
    grown = _core.probe_of("sas", None if probe is None else float(probe))
    if isinstance(patience, bool) or not isinstance(patience, int) or patience < 0:
        raise InvalidInput(f"patience: {patience!r} is no number of frames")
    given = trajectory_of(traj, select, Window.of(start, stop, step))
    if is_on_device(given.atoms.coords):
        raise InvalidInput("traj: pockets of frames are found on the host; copy the frames there")
    sizes = radii_of_frames(radii, given)
    run = _core.PocketRun(sizes, given.count, grown, exact, float(overlap), patience, workers)
    return _followed(given, run, size)


def _followed(given: Trajectory, run: _core.PocketRun, size: int) -> Iterator[PocketFrame]:
    for part in given.chunks(size):
        frames, refusal = run.next(part.coords, given.atoms.unit)
        for number, time, (found, tracks, overlaps, ties) in zip(part.numbers, part.times, frames):
            if ties > 0:
                warnings.warn(
                    f"frame {number}: {ties} ties: the pockets depend on how they are broken",
                    RuntimeWarning,
                    stacklevel=2,
                )
            pockets = dict(zip(tracks, map(pocket_of, found)))
            yield PocketFrame(number, time, pockets, dict(zip(tracks, overlaps)))
        if refusal is not None:
            raise InvalidInput(f"traj: frame {part.numbers[len(frames)]}: {refusal}")


_COLUMNS = (
    "frame", "time", "track", "overlap", "kind", "volume", "volume_sum", "area", "area_sum", "mouths", "mouth_area",
    "mouth_area_sum", "depth_probe", "bottleneck_radius", "atoms", "x", "y", "z",
)  # fmt: skip


def pocket_table(traj: Any, path: str | os.PathLike[str], **options: Any) -> int:
    """Write the pockets of a trajectory against time, as CSV: a row for each frame and track.

    Parameters
    ----------
    traj, **options
        As of `pocket_frames`.
    path : path
        Of the table, which is written frame by frame. What was not computed is empty.

    Returns
    -------
    int
        The number of frames.
    """
    frames = 0
    options_checked = pocket_frames(traj, **options)
    with open(path, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(_COLUMNS)
        for frames, one in enumerate(options_checked, 1):
            table.writerows(_row(one, track, pocket) for track, pocket in one.pockets.items())
    return frames


def _row(one: PocketFrame, track: int, p: Pocket) -> tuple[Any, ...]:
    open_area = None if p.area is None else sum(m.area for m in p.mouths if m.area is not None)
    return (
        one.frame, one.time, track, one.overlaps[track], p.kind, p.volume, p.volume_sum, p.area, p.area_sum,
        len(p.mouths), open_area, sum(m.area_sum for m in p.mouths), p.depth_probe, p.bottleneck_radius, p.atoms,
        *p.center,
    )  # fmt: skip
