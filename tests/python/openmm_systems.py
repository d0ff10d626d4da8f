"""Molecules for OpenMM, made of its own force field amber14 without a cutoff and without constraints."""

import pathlib

import numpy as np
from openmm import Vec3, app, unit

UBIQUITIN = pathlib.Path(__file__).resolve().parents[2] / "data" / "ubiquitin.pdb"
FIELD = "amber14/protein.ff14SB.xml"


def atom_from(a, b, c, length, angle, torsion):
    """The place at a distance from c (nm), at the angle a bond makes at c and the torsion about b-c (degrees)."""
    angle, torsion = np.radians((angle, torsion))
    along = (c - b) / np.linalg.norm(c - b)
    across = np.cross(b - a, along)
    across /= np.linalg.norm(across)
    turned = np.cos(torsion) * np.cross(across, along) + np.sin(torsion) * across
    return c + length * (np.sin(angle) * turned - np.cos(angle) * along)


def with_hydrogens(topology, positions):
    field = app.ForceField(FIELD)
    modeller = app.Modeller(topology, positions)
    modeller.addHydrogens(field)
    return modeller, field.createSystem(modeller.topology, nonbondedMethod=app.NoCutoff)


def alanine_dipeptide():
    """ACE-ALA-NME, 22 atoms, by the usual bonds and angles with phi = -80 and psi = 80 degrees."""
    methyl, carbonyl = np.zeros(3), np.array([0.152, 0, 0])
    n = carbonyl + 0.133 * np.array([np.cos(np.radians(64)), np.sin(np.radians(64)), 0])
    alpha = atom_from(methyl, carbonyl, n, 0.145, 122, 180)
    c = atom_from(carbonyl, n, alpha, 0.152, 110, -80)
    last = atom_from(n, alpha, c, 0.133, 116, 80)
    residues = {
        "ACE": {"CH3": methyl, "C": carbonyl, "O": atom_from(alpha, n, carbonyl, 0.123, 123, 0)},
        "ALA": {"N": n, "CA": alpha, "CB": atom_from(carbonyl, n, alpha, 0.153, 110, 158),
                "C": c, "O": atom_from(n, alpha, c, 0.123, 121, -100)},
        "NME": {"N": last, "C": atom_from(alpha, c, last, 0.145, 122, 180)}}  # fmt: skip
    topology, places = app.Topology(), []
    chain = topology.addChain()
    for residue, atoms in residues.items():
        added = topology.addResidue(residue, chain)
        for name, place in atoms.items():
            topology.addAtom(name, app.Element.getBySymbol(name[0]), added)
            places.append(Vec3(*place))
    topology.createStandardBonds()
    return with_hydrogens(topology, places * unit.nanometer)


def ubiquitin():
    """The sample with hydrogens, 1,231 atoms."""
    sample = app.PDBFile(str(UBIQUITIN))
    modeller = app.Modeller(sample.topology, sample.positions)
    modeller.deleteWater()
    return with_hydrogens(modeller.topology, modeller.positions)
