"""Accessible areas of residues, as a table with their names."""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import Brief, number
from vdwmesh._exact import numbered, sasa
from vdwmesh._molecule import Molecule, raw
from vdwmesh._sources import atoms_of
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
    resnames = _texts(atoms.resnames)[first]
    radius_set = named or (coords.radius_set if isinstance(coords, Molecule) else "bondi")
    is_comparable = number("probe", probe) == _core.reference_probe
    references = [_core.reference_area(radius_set, raw(name)) if is_comparable else None for name in resnames]
    return ResidueAreas(
        chains=_texts(atoms.chains, count, first),
        resids=np.char.add(_texts(atoms.resids, count, first), _texts(atoms.icodes, count, first)),
        resnames=resnames,
        atoms=np.bincount(numbers).astype(np.uint32),
        area=areas,
        relative=areas / np.array([np.nan if one is None else one for one in references]),
    )


def _plain(labels: Any) -> list[Any]:
    return list(labels.tolist() if isinstance(labels, np.ndarray) else labels)


def _texts(column: Any, count: int = 0, rows: Any = slice(None)) -> Strings:
    """The rows of a column as text without blanks; empty ones where there is no column."""
    if column is None:
        return np.full(count, "")
    return np.array([str(text).strip() for text in np.asarray(column)[rows]])
