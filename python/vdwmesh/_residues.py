"""Accessible areas of residues, as a table with their names, of one structure or of frames."""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, Iterator

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import Brief, number, radius_set
from vdwmesh._exact import numbered, sasa
from vdwmesh._frames import frames
from vdwmesh._molecule import Molecule, raw
from vdwmesh._sources import Atoms, atoms_of
from vdwmesh._trajectories import Chunk, Trajectory, Window, some_atoms, trajectory_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import Floats, Ids, Strings


@dataclass(frozen=True, eq=False, repr=False)
class ResidueAreas(Brief):
    """Solvent-accessible areas of residues, in the order of their first atoms.

    Attributes
    ----------
    chains, resids, resnames : ndarray of str, shape (R,)
        As of `Molecule`.
    atoms : ndarray of uint32, shape (R,)
        How many atoms the residue has.
    area : ndarray of float64, shape (R,)
        Å².
    relative : ndarray of float64, shape (R,)
        The share of the area that the residue has in an extended tripeptide Ala-X-Ala. NaN without a
        reference: there are some for the standard amino acids with "protor", "naccess" and "oons",
        and a probe of 1.4 Å.
    """

    chains: Strings
    resids: Strings
    resnames: Strings
    atoms: Ids
    area: Floats
    relative: Floats

    def __len__(self) -> int:
        return len(self.area)

    def to_dict(self) -> dict[str, list[Any]]:
        """The columns as lists, by name."""
        return {name: values.tolist() for name, values in vars(self).items()}

    def to_pandas(self) -> Any:
        """The columns as a ``pandas.DataFrame``, a row for each residue."""
        return import_module("pandas").DataFrame(self.to_dict())


def residue_areas(
    coords: Any,
    radii: str | os.PathLike[str] | None = None,
    *,
    probe: float = 1.4,
    threads: int | None = None,
    device: str = "auto",
) -> ResidueAreas:
    """Exact solvent-accessible areas of the residues of a molecule, with names and relative areas.

    Parameters
    ----------
    coords : a molecule
        A `Molecule`, or a structure of another package, as of `exact`; one frame.
    radii : the name of a set or a path, optional
        A molecule brings its own.
    probe, threads, device
        As of `sasa`.

    Returns
    -------
    ResidueAreas

    Raises
    ------
    InvalidInput
        As of `exact`; or what is given has no residues.

    Examples
    --------
    >>> import vdwmesh
    >>> table = vdwmesh.residue_areas(vdwmesh.sample("ubiquitin", radii="protor"))
    >>> len(table), str(table.resnames[7]), round(float(table.relative[7]), 2)
    (76, 'LEU', 0.76)
    """
    atoms = atoms_of(coords)
    if atoms.residues is None or atoms.resnames is None:
        raise InvalidInput("coords: has no residues; give a molecule, or sasa(..., mode='residue', groups=...)")
    named = None if radii is None else os.fspath(radii)
    labels = _plain(atoms.residues)
    areas = sasa(atoms, named, probe=probe, mode="residue", groups=labels, threads=threads, device=device)
    if areas.ndim != 1:
        raise InvalidInput("coords: has several frames; sasa(..., mode='residue') takes them")
    numbers, count = numbered(labels, len(atoms.resnames))
    first = np.unique(numbers, return_index=True)[1]
    chains, resids, resnames = _names(atoms, count, first)
    set_name = named or (coords.radius_set if isinstance(coords, Molecule) else "bondi")
    return ResidueAreas(
        chains=chains,
        resids=resids,
        resnames=resnames,
        atoms=np.bincount(numbers).astype(np.uint32),
        area=areas,
        relative=areas / _references(set_name, resnames, probe),
    )


def residue_table(
    traj: Any,
    path: str | os.PathLike[str],
    *,
    radii: str | os.PathLike[str] = "protor",
    probe: float = 1.4,
    select: Any = None,
    start: int | None = None,
    stop: int | None = None,
    step: int | None = None,
    **options: Any,
) -> int:
    """Write the accessible areas of the residues in each frame of a trajectory, as CSV: a row for each frame and residue.

    Parameters
    ----------
    traj, select, start, stop, step
        As of `frames`; what has residues: of MDAnalysis or mdtraj.
    path : path
        Of the table, which is written frame by frame. `relative` is as of `ResidueAreas`, and empty
        where that is NaN.
    radii : the name of a set or a path
        Hydrogens are left out where its radii include them, as `read` does.
    probe : float
        Å.
    **options
        As of `frames`: ``chunk``, ``threads``, ``device``.

    Returns
    -------
    int
        The number of frames.

    Raises
    ------
    InvalidInput
        As of `frames`; or what is given has no residues.
    """
    given = trajectory_of(traj, select, Window.of(start, stop, step))
    if given.atoms.residues is None or given.atoms.resnames is None:
        raise InvalidInput("traj: has no residues; give a Universe of MDAnalysis or a trajectory of mdtraj")
    if _core.RadiusTable(radius_set("radii", radii)).is_united():
        given = _without_hydrogens(given)
    numbers, count = numbered(_plain(given.atoms.residues), given.count)
    first = np.unique(numbers, return_index=True)[1]
    names = _names(given.atoms, count, first)
    references = _references(os.fspath(radii), names[2], probe)
    done = 0
    measured = frames(given, radii=os.fspath(radii), surface="sas", probe=probe, per_atom=True, **options)
    with open(path, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("frame", "time", "chain", "resid", "resname", "area", "relative"))
        for done, one in enumerate(measured, 1):
            areas = np.bincount(numbers, weights=one.atom_area)
            shares = ["" if np.isnan(share) else share for share in (areas / references).tolist()]
            for row in zip(*names, areas.tolist(), shares):
                table.writerow((one.frame, one.time, *row))
    return done


def _without_hydrogens(given: Trajectory) -> Trajectory:
    if given.atoms.elements is None:
        return given
    symbols = [str(element).strip().upper() for element in given.atoms.elements]
    kept = np.flatnonzero([symbol not in ("H", "D") for symbol in symbols]).astype(np.uint32)

    def chunks(size: int) -> Iterator[Chunk]:
        return (replace(part, coords=np.asarray(part.coords)[:, kept]) for part in given.chunks(size))

    return replace(given, atoms=some_atoms(given.atoms, kept), count=len(kept), chunks=chunks)


def _names(atoms: Atoms, count: int, first: Any) -> tuple[Strings, Strings, Strings]:
    """Chains, numbers with insertion codes, and names of residues, of which these are the first atoms."""
    resids = np.char.add(_texts(atoms.resids, count, first), _texts(atoms.icodes, count, first))
    return _texts(atoms.chains, count, first), resids, _texts(atoms.resnames)[first]


def _references(set_name: str, resnames: Strings, probe: float) -> Floats:
    """Areas of the residues in extended tripeptides, Å²; NaN where there are none."""
    is_comparable = number("probe", probe) == _core.reference_probe
    found = [_core.reference_area(set_name, raw(name)) if is_comparable else None for name in resnames]
    return np.array([np.nan if one is None else one for one in found])


def _plain(labels: Any) -> list[Any]:
    return list(labels.tolist() if isinstance(labels, np.ndarray) else labels)


def _texts(column: Any, count: int = 0, rows: Any = slice(None)) -> Strings:
    """The rows of a column as text without blanks; empty ones where there is no column."""
    if column is None:
        return np.full(count, "")
    return np.array([str(text).strip() for text in np.asarray(column)[rows]])
