"""Exact measures of many structure files."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from vdwmesh import _core
from vdwmesh._arrays import number, thread_count
from vdwmesh._measure import topology_name
from vdwmesh._molecule import read_options
from vdwmesh.errors import InvalidInput, in_terms_of_python


@dataclass(frozen=True)
class BatchRow:
    """What is known of one structure of a batch; None where it was not computed.

    Attributes
    ----------
    name : str
        Path of the file, or name of the member in its archive.
    atoms : int
    left_out : dict of str to int
        How many atoms of the file are not measured, by reason.
    assumed_radii, guessed_elements : int
        Atoms whose element the radius set lacks, and whose element had to be guessed.
    method : str
        "cgal", "arcs" or "both".
    area, volume : float
        Å², Å³.
    components, tunnels, voids, euler_characteristic : int
    fallback_atoms : int
        Atoms that the arcs doubted, of which the triangulation gave the measures.
    doubtful_atoms : int
        Atoms for which the arcs leave the topology open, so that there are no counts.
    warnings : tuple of str
    error : str
        Why there are no measures.
    """

    name: str
    atoms: int | None
    left_out: dict[str, int] | None
    assumed_radii: int | None
    guessed_elements: int | None
    method: str | None
    area: float | None
    volume: float | None
    components: int | None
    tunnels: int | None
    voids: int | None
    euler_characteristic: int | None
    fallback_atoms: int | None
    doubtful_atoms: int | None
    warnings: tuple[str, ...]
    error: str | None


def batch(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    *,
    shard: tuple[int, int] = (0, 1),
    probe: float = 0.0,
    topology: bool | str = False,
    method: str = "auto",
    threads: int | None = None,
    format: str | None = None,
    model: str | int = "first",
    assembly: str | int | None = None,
    radii: str | os.PathLike[str] | None = None,
    select: str | None = None,
    altloc: str = "highest",
    waters: bool = False,
    hydrogens: bool = True,
    hetatm: bool = True,
    units: str | None = None,
) -> Iterator[BatchRow]:
    """Exact measures of many structures, one row for each, in the order of the inputs.

    Structures are measured side by side, each on one thread, and a few for each thread are in
    memory. The numbers are those of `exact` for each file alone. A structure that cannot be
    measured is a row with its `error`, and the others go on.

    Parameters
    ----------
    paths : path, or sequence of paths
        Folders, tar archives (also packed), structure files, and lists: files of other extensions
        with the path of a structure on each line.
    shard : (int, int)
        (i, n): part i of n parts that follow each other. i is from 0 to n - 1, as indices of Python
        are, while the program's ``--shard i/n`` counts from 1.
    probe, topology, method, threads
        As of `exact`.
    format, model, assembly, radii, select, altloc, waters, hydrogens, hetatm, units
        As of `read`.

    Yields
    ------
    BatchRow

    Raises
    ------
    FileFormatError
        A folder, list or archive cannot be read on.
    InvalidInput
        An argument is no such value, or an input is not there.

    Examples
    --------
    >>> import vdwmesh
    >>> for row in vdwmesh.batch("structures", probe=1.4):  # doctest: +SKIP
    ...     print(row.name, row.area, row.error)
    """
    part, parts = _shard(shard)
    inputs = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    workers, grown = thread_count(threads), number("probe", probe)
    if not math.isfinite(grown):
        raise InvalidInput(f"probe: {grown} is not finite")
    run = _core.BatchRun(
        [os.fspath(path) for path in inputs], part, parts, threads=workers,
        probe=grown, topology=topology_name(topology), method=method,
        **read_options(
            format, model, assembly, radii, select, altloc, units,
            waters=waters, hydrogens=hydrogens, hetatm=hetatm,
        ),
    )  # fmt: skip
    return _rows(run, 16 * (workers or os.cpu_count() or 1))


def _rows(run: _core.BatchRun, chunk: int) -> Iterator[BatchRow]:
    while rows := run.next(chunk):
        for row in rows:
            row["warnings"] = tuple(map(in_terms_of_python, row["warnings"]))
            yield BatchRow(**row)


def _shard(shard: Any) -> tuple[int, int]:
    try:
        part, parts = (int(number) for number in shard)
    except (TypeError, ValueError):
        raise InvalidInput(f"shard: {shard!r} is no pair (i, n)") from None
    if not 0 <= part < parts:
        raise InvalidInput(f"shard: {shard!r}; part i is from 0 to n - 1 (the program's --shard counts from 1)")
    return part, parts
