"""Exact measures as an analysis of MDAnalysis, which this module imports."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase  # type: ignore[import]

from vdwmesh._frames import chunk_size, refuse
from vdwmesh._measure import Options, measure
from vdwmesh._sources import atoms_of, one_location, radii_for
from vdwmesh._trajectories import Chunk
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike

__all__ = ["SurfaceAnalysis"]


class SurfaceAnalysis(AnalysisBase):  # type: ignore[misc]
    """Exact area, volume and topology of a group of atoms in each frame of its trajectory.

    Frames are measured side by side, a chunk at a time.

    Parameters
    ----------
    ag : AtomGroup
        The atoms that are measured.
    probe : float
        Added to every radius, Å. With 1.4 the area is the solvent-accessible one.
    radii : array_like, or the name of a set (as of `read`) or a path
        Å; an array has one for each atom of `ag`, or of ``context | ag`` where there is a context.
    topology : bool or "counts"
        Whether the Euler characteristic is computed. It is that of the union with the context.
    context : AtomGroup, optional
        Atoms that are not measured and bury those that are.
    per_atom : bool
        Whether `atom_area` is kept: 8 bytes for each atom and frame.
    chunk, threads, device
        As for `frames`.
    **options
        As of ``AnalysisBase``: ``verbose``.

    Attributes
    ----------
    results.area, results.volume : ndarray of float64, shape (T,)
        Å², Å³.
    results.residue_area : ndarray of float64, shape (T, R)
        Å², in the order of ``ag.residues``.
    results.atom_area : ndarray of float64, shape (T, N), or None
        Å², in the order of `ag`.
    results.euler_characteristic : ndarray of int64, shape (T,), or None
    frames, times : ndarray, shape (T,)
        As of every analysis.

    Raises
    ------
    InvalidInput
        By ``run``, for a frame with coordinates that are not finite. The results of the frames
        before it are there.
    """

    def __init__(
        self,
        ag: Any,
        probe: float = 0.0,
        radii: ArrayLike | str = "bondi",
        topology: bool | str = False,
        context: Any = None,
        *,
        per_atom: bool = True,
        chunk: int = 64,
        threads: int | None = None,
        device: str = "auto",
        **options: Any,
    ) -> None:
        super().__init__(ag.universe.trajectory, **options)
        if len(ag) == 0:
            raise InvalidInput("ag: has no atoms")
        ag, context = one_location(ag), None if context is None else one_location(context)
        everything = ag if context is None else context | ag
        self._ids = everything.ix
        self._radii = radii_for(radii, atoms_of(everything))
        if len(self._radii) != len(self._ids):
            raise InvalidInput(f"radii: has {len(self._radii)} radii for {len(self._ids)} atoms")
        # The groups of atoms and residues are sorted, and so are the numbers of the residues.
        self._measured = np.arange(len(ag)) if context is None else np.searchsorted(self._ids, ag.ix)
        _, residues = np.unique(ag.resindices, return_inverse=True)
        groups = np.zeros(len(self._ids), np.uint32)
        groups[self._measured] = residues
        self._chunk, self._per_atom = chunk_size(chunk), per_atom
        self._options = Options.of(
            probe,
            topology,
            threads,
            device,
            atoms=None if context is None else self._measured.astype(np.uint32),
            per_atom=bool(per_atom),
            groups=groups,
            group_count=int(residues.max()) + 1,
        )

    def _prepare(self) -> None:
        self._wanted = replace(self._options, balls=len(self._ids) * self.n_frames)
        self._coords = np.empty((self._chunk, len(self._ids), 3), np.float32)
        self._numbers: list[int] = []
        self._rows: dict[str, list[Any]] = {name: [] for name in _RESULTS}

    def _single_frame(self) -> None:
        self._coords[len(self._numbers)] = self._ts.positions[self._ids]
        self._numbers.append(self._ts.frame)
        if len(self._numbers) == self._chunk:
            self._measure()

    def _measure(self) -> None:
        part = Chunk(self._coords[: len(self._numbers)], self._numbers, [])
        found, by_residue, invalid, _ = measure(part.coords, self._radii, self._wanted)
        for one, areas in zip(found, by_residue):
            self._rows["area"].append(one["area"])
            self._rows["volume"].append(one["volume"])
            self._rows["residue_area"].append(areas)
            if self._per_atom:
                self._rows["atom_area"].append(one["atom_area"][self._measured])
            if one["counts"] is not None:
                self._rows["euler_characteristic"].append(one["counts"].euler_characteristic)
        self._numbers = []
        if invalid is not None:
            self._store()
            refuse(invalid, part)

    def _conclude(self) -> None:
        if self._numbers:
            self._measure()
        self._store()

    def _store(self) -> None:
        for name, rows in self._rows.items():
            self.results[name] = np.array(rows)
        if not self._per_atom:
            self.results.atom_area = None
        if self._options.topology == "off":
            self.results.euler_characteristic = None


_RESULTS = ("area", "volume", "residue_area", "atom_area", "euler_characteristic")
