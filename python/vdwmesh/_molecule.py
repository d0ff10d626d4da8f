"""Structure files and radii."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import file_name, number, radius_set, refuse_masked, view
from vdwmesh.errors import InvalidInput, in_terms_of_python

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, NDArray, Strings


@dataclass(frozen=True, eq=False)
class Molecule:
    """Atoms with their radii, and an account of what was not taken from the file.

    Molecules are equal if their atoms are: all arrays have the same elements.

    Attributes
    ----------
    coords : ndarray of float64, shape (N, 3)
        Positions, Å.
    radii : ndarray of float64, shape (N,)
        Van der Waals radii, Å: from the file (PQR, XYZR) or from the radius set.
    elements, names, resnames, resids, chains : ndarray of str, shape (N,)
        Chemical symbols, names of atoms and residues, residue numbers as text, because they may have
        insertion codes ("52A"), chains (in an assembly with the number of the copy: "A1").
    left_out : dict of str to int
        How many atoms of the file are not here, by reason ("waters", "alternate_locations", ...).
    assumed_radii : dict of str to float
        Elements that the radius set lacks (of sets of united atoms, residue and atom, as "HEM FE"),
        with the radii that stand in, Å.
    notes, warnings : tuple of str
        What the reader chose or guessed, and what may be wrong with the file.
    path, format, model, assembly : str
        Where the atoms come from.
    segments : ndarray of str, shape (N,)
        Ids of segments, as columns 73-76 of PDB files have them.
    residues : ndarray of uint32, shape (N,)
        Tells residues of the file apart, also those of one chain, number and name. Copies in an
        assembly are told by their chains.
    radius_set : str
        Where the radii come from: "bondi", a file, or "file" for those of the structure file itself.
    """

    coords: Floats
    radii: Floats
    elements: Strings
    names: Strings
    resnames: Strings
    resids: Strings
    chains: Strings
    left_out: dict[str, int]
    assumed_radii: dict[str, float]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    path: str
    format: str
    model: str
    assembly: str
    segments: Strings
    residues: NDArray[np.uint32]
    radius_set: str = ""

    def __len__(self) -> int:
        return len(self.radii)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Molecule):
            return NotImplemented
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in _COLUMNS)

    def __getitem__(self, chosen: Any) -> Molecule:
        """The atoms that a mask, indices or a slice choose; the account of the file stays."""
        if isinstance(chosen, (int, np.integer)):
            chosen = [chosen]
        return replace(self, **{name: getattr(self, name)[chosen] for name in _COLUMNS})

    def __repr__(self) -> str:
        return f"<vdwmesh.Molecule of {len(self)} atoms from {self.path}>"


_COLUMNS = ("coords", "radii", "elements", "names", "resnames", "resids", "chains", "segments", "residues")


def _molecule(columns: dict[str, Any]) -> Molecule:
    for name in _COLUMNS:
        columns[name] = view(columns[name])
    for name in ("notes", "warnings"):
        columns[name] = tuple(map(in_terms_of_python, columns[name]))
    return Molecule(**{field.name: columns[field.name] for field in fields(Molecule)})


def read(
    source: str | os.PathLike[str] | bytes | BinaryIO,
    *,
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
) -> Molecule:
    """Read a structure file: PDB, mmCIF, BinaryCIF, PQR, XYZR, GRO, MOL2, SDF or XYZ, each also gzipped.

    Parameters
    ----------
    source : path, bytes or binary file
        The file, its bytes, or an object with a method ``read`` that returns them.
    format : {"pdb", "mmcif", "bcif", "pqr", "xyzr", "gro", "mol2", "sdf", "xyz"}, optional
        Needed for bytes; else the extension of the name decides.
    model : str or int
        "first", "all" or the number of a model.
    assembly : str, optional
        Name of a biological assembly of the file; by default the asymmetric unit.
    radii : str or path, optional
        "bondi" (the default) or "alvarez", by element; "protor", "naccess" or "oons", of united
        atoms, which drop the hydrogens; or a file with lines "ELEMENT RADIUS" or "RESIDUE ATOM
        RADIUS". "bondi,mine.txt" is a set with lines of a file, of which the last one holds. Files
        of PQR and XYZR bring their own, and take no others.
    select : str, optional
        A selection in words, as "chain A and not hydrogen" or "resi 10-40", or in gemmi's syntax, as
        "A/10-40/CA", "A/-3--1" or "A;segment=P1".
    altloc : str
        Which alternate locations are kept: "highest" (by occupancy), "all", or one label where
        there is one, and "highest" elsewhere.
    waters, hydrogens, hetatm : bool
        Whether these atoms are kept.
    units : {"angstrom", "nm", "pm"}, optional
        Of the coordinates, where a program wrote others than the format has.

    Returns
    -------
    Molecule

    Raises
    ------
    FileFormatError
        The file cannot be opened or understood. One that is not there is a `FileMissing`, which is
        a FileNotFoundError as well.
    InvalidInput
        No atom is left, an atom has no known radius, or the file lacks the model or assembly.
    """
    options = read_options(
        format, model, assembly, radii, select, altloc, units, waters=waters, hydrogens=hydrogens, hetatm=hetatm
    )
    if isinstance(source, (str, os.PathLike)):
        return _molecule(_core.read_file(file_name(source), **options))
    name = "bytes"
    if not isinstance(source, (bytes, bytearray, memoryview)):
        name = str(getattr(source, "name", "file"))
        source = _content(source)
    if not format and name in ("bytes", "file"):
        raise InvalidInput("format: is needed where the source has no name: pdb, mmcif, bcif, pqr, xyzr, gro, mol2, sdf or xyz")
    return _molecule(_core.read_bytes(raw(name), bytes(source), **options))


def read_options(
    format: str | None,
    model: str | int,
    assembly: str | int | None,
    radii: str | os.PathLike[str] | None,
    select: str | None,
    altloc: str,
    units: str | None,
    *,
    waters: bool,
    hydrogens: bool,
    hetatm: bool,
) -> dict[str, Any]:
    """The arguments of `read` as the C++ side takes them."""
    return {
        "format": format or None,
        "model": raw(str(model)),
        "assembly": raw("asymmetric" if assembly is None else str(assembly)),
        "radii": b"" if radii is None else radius_set("radii", _given("radii", radii)),
        "select": raw(_given("select", select)),
        "altloc": raw(altloc),
        "units": units or None,
        "waters": waters,
        "hydrogens": hydrogens,
        "hetatm": hetatm,
    }


def raw(text: str) -> bytes:
    """A text as the C++ side takes it; surrogates, as of os.listdir, are the bytes that they stand for."""
    return text.encode("utf-8", "surrogateescape")


def _given(name: str, value: Any) -> Any:
    """An argument that may be left out; an empty text is a slip."""
    if value == "":
        raise InvalidInput(f"{name}: is empty; give a value, or None")
    return "" if value is None else value


def _content(source: Any) -> bytes:
    if not hasattr(source, "read"):
        raise InvalidInput(f"source: {type(source).__name__} is no path, bytes or file")
    content = source.read()
    return content.encode() if isinstance(content, str) else bytes(content)


def sample(name: str = "ubiquitin", *, radii: str | os.PathLike[str] = "bondi") -> Molecule:
    """Read a structure that is part of the library: "ubiquitin" (PDB entry 1UBQ) or "bpti".

    Examples
    --------
    >>> import vdwmesh
    >>> molecule = vdwmesh.sample("ubiquitin")
    >>> len(molecule), molecule.left_out
    (602, {'waters': 58})
    """
    return _molecule(
        _core.read_sample(
            name, format=None, units=None, model="first", assembly="asymmetric", radii=radius_set("radii", radii), select="",
            altloc="highest", waters=False, hydrogens=True, hetatm=True,
        )  # fmt: skip
    )


def radii_of(
    elements: ArrayLike,
    *,
    set: str | os.PathLike[str] = "bondi",
    resnames: ArrayLike | None = None,
    names: ArrayLike | None = None,
    unknown: float | None = None,
) -> Floats:
    """Van der Waals radii of atoms by element, Å.

    Parameters
    ----------
    elements : sequence of str, length N
        Chemical symbols in any case ("ZN", "Zn", "Zn2+").
    set : str or path
        "bondi" (J. Phys. Chem. 68 (1964) 441, completed from Alvarez), "alvarez" (Dalton Trans. 42
        (2013) 8617); "protor", "naccess" or "oons", of united atoms; or a file with lines "ELEMENT
        RADIUS" or "RESIDUE ATOM RADIUS"; or "bondi,mine.txt", a set with lines of a file.
    resnames, names : sequence of str, length N, optional
        Names of residues and atoms, for united atoms and for files with lines by residue and atom.
    unknown : float, optional
        The radius of atoms that the set does not know, Å. By default they are an error.

    Returns
    -------
    ndarray of float64, shape (N,)

    Raises
    ------
    InvalidInput
        An atom has no known radius, or the sequences differ in length.

    Examples
    --------
    >>> import vdwmesh
    >>> vdwmesh.radii_of(["C", "ZN", "o"])
    array([1.7 , 1.39, 1.52])
    """
    table = _core.RadiusTable(radius_set("set", set))
    columns = [_texts("elements", elements)]
    for name, given in (("resnames", resnames), ("names", names)):
        columns.append([""] * len(columns[0]) if given is None else _texts(name, given))
        if len(columns[-1]) != len(columns[0]):
            raise InvalidInput(f"{name}: has {len(columns[-1])} entries for {len(columns[0])} elements")
    known: dict[tuple[str, str, str], float] = {}
    found = np.empty(len(columns[0]))
    for i, key in enumerate(zip(columns[0], columns[1], columns[2])):
        if key not in known:
            known[key] = _radius(table, key, i, unknown)
        found[i] = known[key]
    return found


def _texts(name: str, values: ArrayLike) -> list[str]:
    refuse_masked(name, values)
    texts = np.asarray(values)
    if texts.ndim != 1 or (texts.size > 0 and texts.dtype.kind not in "USO"):
        raise InvalidInput(f"{name}: a sequence of strings is needed")
    return [
        text.decode(errors="surrogateescape") if isinstance(text, bytes) else str(text)
        for text in texts.tolist()
    ]


def _radius(
    table: _core.RadiusTable, key: tuple[str, str, str], index: int, unknown: float | None
) -> float:
    element, residue, atom = key
    found = table.find(raw(residue.strip()), raw(atom.strip()), raw(element.strip()))
    if found is not None:
        return found
    if unknown is None and element.strip().upper() in ("H", "D") and table.is_united():
        raise InvalidInput(
            f"elements[{index}]: the radii of the set include the hydrogens; leave these out, as read() does"
        )
    if unknown is None:
        raise InvalidInput(
            f"elements[{index}]: no radius is known for {element!r}; give the radii as numbers, which "
            "vdwmesh.radii_of(..., unknown=RADIUS) makes"
        )
    return number("unknown", unknown)
