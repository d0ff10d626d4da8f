"""Coordinates and radii of what users have: arrays, molecules, objects of other packages.

Objects are told by the package that their class comes from, so none is imported unless its objects
are there already.
"""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Callable, Iterator

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import floats
from vdwmesh._cuda import CudaInput, is_on_device, on_device, require_cuda
from vdwmesh._molecule import Molecule, radii_of, raw
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import NDArray


VIRTUAL = "virtual site"


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
    chains: Any = None
    resids: Any = None  # numbers of residues
    icodes: Any = None  # insertion codes, where the numbers are without
    advice: str = "give radii="  # where an element is not known

    def untold(self, i: int) -> str:
        """The message about an atom whose element is not known."""
        names = [str(column[i]) for column in (self.names, self.resnames) if column is not None]
        what = f" ({' of '.join(names)})" if names else ""
        return f"coords: the element of atom {i}{what} cannot be told; {self.advice}"


def atoms_of(source: Any) -> Atoms:
    """The atoms of the argument `coords`, whatever it is."""
    if isinstance(source, Atoms):
        return source
    if isinstance(source, (list, tuple)) and source and comes_from("Bio", source[0]):
        return _with_remarks(_from_biopython(source), "Bio")
    for kind in type(source).__mro__:
        adapter = _ADAPTERS.get(kind.__module__.partition(".")[0])
        if adapter:
            return _with_remarks(adapter(source), kind.__module__.partition(".")[0])
    return Atoms(coords=source)


# How waters are left out of the objects of a package; {} are the names of the residues.
_WITHOUT_WATERS = {
    "Bio": "leave out residues whose id[0] is 'W'",
    "MDAnalysis": "ag.select_atoms('not resname {}') leaves them out",
    "biotite": "array[~numpy.isin(array.res_name, '{}'.split())] leaves them out",
    "gemmi": "structure.remove_waters() leaves them out",
    "mdtraj": "traj.remove_solvent() leaves them out",
}


def _with_remarks(atoms: Atoms, package: str) -> Atoms:
    """Objects are measured as they are given; a warning says what a file would have been read without."""
    if package not in _WITHOUT_WATERS or atoms.resnames is None:
        return atoms
    names = set(atoms.resnames)
    waters = sorted(name for name in names if _core.is_water(raw(str(name).strip())))
    if 0 < len(waters) < len(names):
        count, all_names = sum(name in waters for name in atoms.resnames), " ".join(waters)
        warnings.warn(
            f"{count} of {len(atoms.resnames)} atoms are those of waters and are measured, while "
            f"vdwmesh.read() leaves them out; {_WITHOUT_WATERS[package].format(all_names)}",
            stacklevel=5,
        )
    return atoms


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
        centers = floats("coords", atoms.coords, "(T, N, 3)")
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


def joined(name: str, sets: list[Any], radii: Any) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.int64]]:
    """The arrays of sets, one after another, and where each begins; their argument is `name`.

    `radii` is the name of a set of radii for all, or an iterable of the radii of each.
    """
    if not sets:
        raise InvalidInput(f"{name}: is empty")
    one_for_all = radii is None or isinstance(radii, (str, os.PathLike))
    each = [radii] * len(sets) if one_for_all else list(radii)
    if len(each) != len(sets):
        raise InvalidInput(f"radii: has those of {len(each)} molecules, but there are {len(sets)}")
    pairs = []
    for i, (one, own) in enumerate(zip(sets, each)):
        try:
            centers, sizes, _ = arrays_of(one, own)
        except InvalidInput as error:
            raise InvalidInput(f"{name}[{i}]: {error}") from None
        if len(centers) != len(sizes):
            raise InvalidInput(f"{name}[{i}]: has {len(centers)} atoms and {len(sizes)} radii")
        pairs.append((centers.astype(np.float64), sizes.astype(np.float64)))
    places, lengths = (np.concatenate(column) for column in zip(*pairs))
    return places, lengths, np.cumsum([0, *(len(own) for _, own in pairs)])


def _one_frame(centers: NDArray[Any]) -> NDArray[Any]:
    if centers.shape[1] != 3 and centers.size > 0:
        raise InvalidInput(f"coords: has shape {centers.shape}; (N, 3) is needed")
    return centers


def radii_for(radii: Any, atoms: Atoms) -> NDArray[Any]:
    """The argument `radii` as an array: a set by its name, or numbers, which are obeyed."""
    if radii is None and atoms.radii is not None:
        radii = atoms.radii
    if radii is None or isinstance(radii, (str, os.PathLike)):
        if atoms.elements is None:
            raise InvalidInput("radii: are needed, one for each atom; coordinates alone have none")
        for i, element in enumerate(atoms.elements):
            if not element or element == VIRTUAL:
                raise InvalidInput(atoms.untold(i))
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
    return replace(found, radii=source.radii, chains=source.chains, resids=source.resids)


def _from_mdanalysis(source: Any) -> Atoms:
    """An AtomGroup, or what has one: a Universe, a residue, a segment. Lengths are in Å."""
    group = one_location(getattr(source, "atoms", source))
    coords, resnames, names = group.positions, getattr(group, "resnames", None), getattr(group, "names", None)
    elements = getattr(group, "elements", None)
    masses = None if _is_guessed(group, "masses") else getattr(group, "masses", None)
    is_told = any(column is not None for column in (elements, names, masses))
    return Atoms(
        coords=coords,
        elements=_told(len(coords), elements, resnames, names, masses) if is_told else None,
        resnames=resnames,
        names=names,
        residues=group.resindices.tolist(),
        chains=_first_of(group, "chainIDs", "segids"),
        resids=getattr(group, "resids", None),
        icodes=getattr(group, "icodes", None),
        advice="types of a force field are no elements: give "
        "u.add_TopologyAttr('elements', [...]) or radii=; atoms without mass are left out by "
        "ag.select_atoms('prop mass > 0')",
    )


def _first_of(group: Any, *names: str) -> Any:
    """The first of these attributes that the group has; None without any."""
    return next((getattr(group, name) for name in names if hasattr(group, name)), None)


def _is_guessed(group: Any, attribute: str) -> bool:
    """Whether MDAnalysis guessed the attribute, as masses from types that are no elements."""
    topology = getattr(getattr(group, "universe", None), "_topology", None)
    return bool(getattr(getattr(topology, attribute, None), "is_guessed", True))


def _told(count: int, elements: Any, resnames: Any, names: Any, masses: Any) -> list[str]:
    """The elements that are given, weighed against the names as those of files are; else those that
    names and masses tell, "" where they do not."""
    found = [""] * count if elements is None else [str(element).strip() for element in elements]
    known: dict[tuple[str, str, str, float | None], tuple[str, bool]] = {}
    overruled = []
    for i, element in enumerate(found):
        mass = None if element or masses is None or np.isnan(masses[i]) else float(masses[i])
        residue, name = (
            "" if column is None else str(column[i]).strip() for column in (resnames, names)
        )
        if element == VIRTUAL:
            continue
        key = (residue, name, element, mass)
        if key not in known:
            told = (raw(residue), raw(name))
            known[key] = (
                _core.weighed_element(*told, raw(element)) if element else (_core.told_element(*told, mass), False)
            )
        found[i], is_overruled = known[key]
        if is_overruled:
            overruled.append(f"{found[i]} for {name} of {residue}")
    if overruled:
        warnings.warn(
            f"the elements of {len(overruled)} atoms contradict the names of atom and residue, which decided: "
            f"the first is {overruled[0]}",
            stacklevel=5,
        )
    return found


def one_location(group: Any) -> Any:
    """The AtomGroup with one of the alternate locations of each atom."""
    labels = getattr(group, "altLocs", None)
    if labels is None or not any(str(label).strip() for label in labels):
        return group
    segments = group.segids if hasattr(group, "segids") else [""] * len(group)
    chains = group.chainIDs if hasattr(group, "chainIDs") else [""] * len(group)
    codes = group.icodes if hasattr(group, "icodes") else [""] * len(group)
    kept = _highest(
        (f"{segment} {chain}" for segment, chain in zip(segments, chains)),
        (f"{number}{code}" for number, code in zip(group.resids, codes)),
        group.resnames, group.names, labels,
        getattr(group, "occupancies", np.ones(len(group))),
    )  # fmt: skip
    return group[kept] if len(kept) < len(group) else group


def _highest(*columns: Any) -> list[int]:
    """The indices of the atoms that stay, of all whose chains, residue numbers and names, atom names,
    labels and occupancies these are. A warning says how many do not."""
    atoms = [(*(raw(str(text).strip()) for text in row[:5]), float(row[5])) for row in zip(*columns)]
    kept = _core.highest_locations(atoms)
    if len(kept) < len(atoms):
        warnings.warn(
            f"{len(atoms) - len(kept)} of {len(atoms)} atoms are alternate locations that are left out, "
            f"as vdwmesh.read() leaves them out (altloc='highest'); arrays by atom are of the "
            f"{len(kept)} others",
            stacklevel=5,
        )
    return kept


def _from_mdtraj(source: Any) -> Atoms:
    """A Trajectory, whose lengths are in nm. One frame is a structure, several are frames."""
    atoms = list(source.topology.atoms)
    return Atoms(
        coords=source.xyz[0] if len(source.xyz) == 1 else source.xyz,
        unit=10.0,
        elements=_told(
            len(atoms),
            [_symbol_of_mdtraj(atom.element) for atom in atoms],
            [atom.residue.name for atom in atoms],
            [atom.name for atom in atoms],
            None,
        ),
        resnames=[atom.residue.name for atom in atoms],
        names=[atom.name for atom in atoms],
        residues=[atom.residue.index for atom in atoms],
        chains=[getattr(atom.residue.chain, "chain_id", None) or atom.residue.chain.index for atom in atoms],
        resids=[atom.residue.resSeq for atom in atoms],
        advice="virtual sites are left out by traj.atom_slice([...]), or give radii=",
    )


def _symbol_of_mdtraj(element: Any) -> str:
    """Virtual sites are elements of the number 0, which names are not asked for."""
    if element is None:
        return ""
    return str(element.symbol) if element.number > 0 else VIRTUAL


def _from_biotite(source: Any) -> Atoms:
    """An AtomArray, or an AtomArrayStack of frames. Lengths are in Å.

    A residue is a run of atoms there: its numbers may come again.
    """
    place = ("chain_id", "res_id", "ins_code", "res_name")
    found = _from_columns(source, "coord", "element", "res_name", "atom_name", *place)
    columns = [np.asarray(getattr(source, name)) for name in place]
    begins = np.any([column[1:] != column[:-1] for column in columns], axis=0)
    return replace(
        found,
        elements=_told(len(found.names), found.elements, found.resnames, found.names, None),
        residues=np.concatenate(([0], np.cumsum(begins))).tolist(),
        chains=columns[0],
        resids=columns[1],
        icodes=columns[2],
    )


def _from_gemmi(source: Any) -> Atoms:
    """A Structure, whose first model is taken, or a Model, Chain or Residue. Lengths are in Å.

    Of alternate locations one is taken.
    """
    model = source[0] if type(source).__name__ == "Structure" else source
    found = list(_gemmi_atoms(model))
    if any(atom.has_altloc() for atom, _, _ in found):
        kept = _highest(
            (f"{chain} {residue.segment}" for _, residue, chain in found),
            (residue.seqid for _, residue, _ in found),
            (residue.name for _, residue, _ in found),
            (atom.name for atom, _, _ in found),
            (atom.altloc.strip("\0") for atom, _, _ in found),
            (atom.occ for atom, _, _ in found),
        )
        found = [found[i] for i in kept]
    resnames, names = [residue.name for _, residue, _ in found], [atom.name for atom, _, _ in found]
    symbols = [atom.element.name for atom, _, _ in found]  # "X" where gemmi tells none
    return Atoms(
        coords=[(atom.pos.x, atom.pos.y, atom.pos.z) for atom, _, _ in found],
        elements=_told(len(found), symbols, resnames, names, None),
        resnames=resnames,
        names=names,
        residues=[id(residue) for _, residue, _ in found],  # `found` keeps each one alive
        chains=[chain for _, _, chain in found],
        resids=[str(residue.seqid) for _, residue, _ in found],
    )


def _from_biopython(source: Any) -> Atoms:
    """A Structure, whose first model is taken, a Model, Chain or Residue of Bio.PDB, or a list of its atoms, in Å.

    Bio.PDB itself chooses one of the alternate locations of an atom.
    """
    if not isinstance(source, (list, tuple)) and not hasattr(source, "get_atoms"):
        raise InvalidInput(f"coords: Bio.PDB's {type(source).__name__} has no atoms")
    model = next(iter(source), source) if getattr(source, "level", "") == "S" else source
    atoms = list(model.get_atoms() if hasattr(model, "get_atoms") else model)
    residues = [atom.get_parent() for atom in atoms]
    resnames, names = [residue.get_resname() for residue in residues], [atom.get_name() for atom in atoms]
    symbols = ["" if atom.element in (None, "X") else atom.element for atom in atoms]
    return Atoms(
        coords=[atom.get_coord() for atom in atoms],
        elements=_told(len(atoms), symbols, resnames, names, None),
        resnames=resnames,
        names=names,
        residues=[residue.get_full_id() for residue in residues],
        chains=[residue.get_full_id()[-2] for residue in residues],
        resids=[f"{residue.id[1]}{residue.id[2].strip()}" for residue in residues],
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
    "Bio": _from_biopython,
    "MDAnalysis": _from_mdanalysis,
    "biotite": _from_biotite,
    "gemmi": _from_gemmi,
    "mdtraj": _from_mdtraj,
    "vdwmesh": _from_vdwmesh,
}
