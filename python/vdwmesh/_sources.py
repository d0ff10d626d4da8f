"""Coordinates and radii of what users have: arrays, molecules, objects of other packages.

Objects are told by the package that their class comes from, so none is imported unless its objects
are there already.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from vdwmesh._arrays import floats
from vdwmesh._molecule import Molecule, radii_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import NDArray


@dataclass(frozen=True)
class Atoms:
    """What a source has; `coords` is of shape (N, 3), or (T, N, 3) for frames, in Å."""

    coords: Any
    radii: Any = None
    elements: Any = None
    resnames: Any = None
    names: Any = None
    residues: Any = None  # one label for each atom, equal for atoms of one residue


def atoms_of(source: Any) -> Atoms:
    """The atoms of the argument `coords`, whatever it is."""
    if isinstance(source, Atoms):
        return source
    for kind in type(source).__mro__:
        adapter = _ADAPTERS.get(kind.__module__.partition(".")[0])
        if adapter:
            return adapter(source)
    return Atoms(coords=source)


def arrays_of(
    coords: Any, radii: Any, *, frames: bool = False
) -> tuple[NDArray[Any], NDArray[Any], Atoms]:
    """Coordinates (N, 3) and radii (N,) for the C++ side, and where they come from.

    With `frames` coordinates of shape (T, N, 3) pass as well.
    """
    atoms = atoms_of(coords)
    centers = np.asarray(atoms.coords) if frames else None
    if centers is None or centers.ndim != 3:
        centers = _one_frame(floats("coords", atoms.coords, "(N, 3)"))
    else:
        centers = floats("coords", centers, "(T, N, 3)")
    if centers.size == 0:
        raise InvalidInput(f"coords: is empty, of shape {centers.shape}")
    return centers, _radii(radii, atoms), atoms


def _one_frame(centers: NDArray[Any]) -> NDArray[Any]:
    if centers.shape[1] != 3 and centers.size > 0:
        raise InvalidInput(f"coords: has shape {centers.shape}; (N, 3) is needed")
    return centers


def _radii(radii: Any, atoms: Atoms) -> NDArray[Any]:
    if radii is None and atoms.radii is not None:
        radii = atoms.radii
    if radii is None or isinstance(radii, str):
        if atoms.elements is None:
            raise InvalidInput("radii: are needed, one for each atom; coordinates alone have none")
        radii = radii_of(
            atoms.elements, set=radii or "bondi", resnames=atoms.resnames, names=atoms.names
        )
    return floats("radii", radii, "(N,)")


def _labels(*columns: Any) -> list[tuple[Any, ...]]:
    return list(zip(*(np.asarray(column).tolist() for column in columns)))


def _from_vdwmesh(source: Any) -> Atoms:
    if not isinstance(source, Molecule):
        raise InvalidInput(f"coords: {type(source).__name__} has no atoms")
    return Atoms(
        coords=source.coords,
        radii=source.radii,
        elements=source.elements,
        resnames=source.resnames,
        names=source.names,
        residues=_labels(source.chains, source.resids, source.resnames),
    )


_ADAPTERS: dict[str, Callable[[Any], Atoms]] = {"vdwmesh": _from_vdwmesh}
