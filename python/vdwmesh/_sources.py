"""Coordinates and radii of what users have: arrays, molecules, objects of other packages.

Objects are told by the package that their class comes from, so none is imported unless its objects
are there already.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Callable, Iterator

import numpy as np

from vdwmesh._arrays import floats
from vdwmesh._cuda import CudaInput, is_on_device, on_device, require_cuda
from vdwmesh._molecule import Molecule, radii_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import NDArray


@dataclass(frozen=True)
class Atoms:
    """What a source has; `coords` is of shape (N, 3), or (T, N, 3) for frames, in units of `unit`."""

    coords: Any
    unit: float = 1.0  # Å
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


def comes_from(package: str, thing: Any) -> bool:
    """Whether the class of the thing, or one that it is made from, is of that package."""
    return any(kind.__module__.partition(".")[0] == package for kind in type(thing).__mro__)


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
    if atoms.unit != 1:
        centers = atoms.unit * centers.astype(np.float64)
    return centers, radii_for(radii, atoms), atoms


def arrays_anywhere(
    coords: Any, radii: Any, device: str, *, frames: bool = False
) -> tuple[NDArray[Any] | CudaInput, NDArray[Any] | CudaInput, Atoms]:
    """`arrays_of`, or coordinates and radii in the memory of a device, which stay there.

    Where the coordinates are there, the radii may be on either side.
    """
    atoms = atoms_of(coords)
    if not is_on_device(atoms.coords):
        return arrays_of(atoms, radii, frames=frames)
    require_cuda(device, "coords")
    shapes = ("(N, 3)", "(T, N, 3)") if frames else ("(N, 3)",)
    return on_device("coords", atoms.coords, *shapes), radii_anywhere(radii, atoms), atoms


def radii_anywhere(radii: Any, atoms: Atoms) -> NDArray[Any] | CudaInput:
    """The argument `radii` beside coordinates on a device."""
    return on_device("radii", radii, "(N,)") if is_on_device(radii) else radii_for(radii, atoms)


def _one_frame(centers: NDArray[Any]) -> NDArray[Any]:
    if centers.shape[1] != 3 and centers.size > 0:
        raise InvalidInput(f"coords: has shape {centers.shape}; (N, 3) is needed")
    return centers


def radii_for(radii: Any, atoms: Atoms) -> NDArray[Any]:
    """The argument `radii` as an array: a set by its name, or numbers, which are obeyed."""
    if radii is None and atoms.radii is not None:
        radii = atoms.radii
    if radii is None or isinstance(radii, str):
        if atoms.elements is None:
            raise InvalidInput("radii: are needed, one for each atom; coordinates alone have none")
        radii = radii_of(
            atoms.elements, set="bondi" if radii is None else radii, resnames=atoms.resnames, names=atoms.names
        )
    return floats("radii", radii, "(N,)")


def _labels(*columns: Any) -> list[tuple[Any, ...]]:
    return list(zip(*(np.asarray(column).tolist() for column in columns)))


def _from_columns(source: Any, coords: str, elements: str, resnames: str, names: str, *residue: str) -> Atoms:
    """Atoms that stand in arrays, by the names of these; those of `residue` tell residues apart."""
    return Atoms(
        coords=getattr(source, coords),
        elements=getattr(source, elements),
        resnames=getattr(source, resnames),
        names=getattr(source, names),
        residues=_labels(*(getattr(source, name) for name in residue)),
    )


def _from_vdwmesh(source: Any) -> Atoms:
    if not isinstance(source, Molecule):
        raise InvalidInput(f"coords: {type(source).__name__} has no atoms")
    found = _from_columns(source, "coords", "elements", "resnames", "names", "chains", "residues")
    return replace(found, radii=source.radii)


def _from_mdanalysis(source: Any) -> Atoms:
    """An AtomGroup, or what has one: a Universe, a residue, a segment. Lengths are in Å."""
    group = getattr(source, "atoms", source)
    return Atoms(
        coords=group.positions,
        elements=_mdanalysis_elements(group),
        resnames=getattr(group, "resnames", None),
        names=getattr(group, "names", None),
        residues=group.resindices.tolist(),
    )


def _mdanalysis_elements(group: Any) -> Any:
    """Topologies without elements have types, which are guesses of the same; both may be empty."""
    for attribute in ("elements", "types"):
        found = getattr(group, attribute, None)
        if found is not None and all(str(element) for element in found):
            return found
    return None


def _from_mdtraj(source: Any) -> Atoms:
    """A Trajectory, whose lengths are in nm. One frame is a structure, several are frames."""
    atoms = list(source.topology.atoms)
    return Atoms(
        coords=source.xyz[0] if len(source.xyz) == 1 else source.xyz,
        unit=10.0,
        elements=[atom.element.symbol if atom.element else "" for atom in atoms],
        resnames=[atom.residue.name for atom in atoms],
        names=[atom.name for atom in atoms],
        residues=[atom.residue.index for atom in atoms],
    )


def _from_biotite(source: Any) -> Atoms:
    """An AtomArray, or an AtomArrayStack of frames. Lengths are in Å.

    A residue is a run of atoms there: its numbers may come again.
    """
    place = ("chain_id", "res_id", "ins_code", "res_name")
    found = _from_columns(source, "coord", "element", "res_name", "atom_name", *place)
    columns = [np.asarray(getattr(source, name)) for name in place]
    begins = np.any([column[1:] != column[:-1] for column in columns], axis=0)
    return replace(found, residues=np.concatenate(([0], np.cumsum(begins))).tolist())


def _from_gemmi(source: Any) -> Atoms:
    """A Structure, whose first model is taken, or a Model, Chain or Residue. Lengths are in Å."""
    model = source[0] if type(source).__name__ == "Structure" else source
    found = list(_gemmi_atoms(model))
    return Atoms(
        coords=[(atom.pos.x, atom.pos.y, atom.pos.z) for atom, _, _ in found],
        elements=[atom.element.name for atom, _, _ in found],
        resnames=[residue.name for _, residue, _ in found],
        names=[atom.name for atom, _, _ in found],
        residues=[id(residue) for _, residue, _ in found],  # `found` keeps each one alive
    )


def _gemmi_atoms(part: Any, residue: Any = None, chain: str = "") -> Iterator[tuple[Any, Any, str]]:
    """The atoms of a part of gemmi's hierarchy with their residue and the name of their chain."""
    kind = type(part).__name__
    if kind == "Residue":
        residue = part
    elif kind == "Chain":
        chain = part.name
    elif kind != "Model":
        raise InvalidInput(f"coords: gemmi's {kind} has no atoms")
    for child in part:
        if kind == "Residue":
            yield child, residue, chain
        else:
            yield from _gemmi_atoms(child, residue, chain)


_ADAPTERS: dict[str, Callable[[Any], Atoms]] = {
    "MDAnalysis": _from_mdanalysis,
    "biotite": _from_biotite,
    "gemmi": _from_gemmi,
    "mdtraj": _from_mdtraj,
    "vdwmesh": _from_vdwmesh,
}
