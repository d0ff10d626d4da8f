"""vdwmesh.read of generated structure files: the atoms that were meant, or words that say otherwise.

`generated_structures` invents small molecules by a seed and writes them as PDB in the dialects of many programs, as
PDBQT, PQR, mmCIF and XYZR. It knows no reader: what is expected comes from the molecule, not from the text. A difference
counts as silent if no warning of the molecule speaks of it, or where nothing in the file tells an element for certain,
no note. One file in fifty has a coordinate that is none and must be refused; of the others at most 1 % may be.

1,500 files are read here; `VDWMESH_GENERATED=20000` in the environment reads as many as it says (seeds from 0 on), and
`python3 -B test_generated_structures.py SEED` shows the file of one seed and what was read of it.
"""

import collections
import os
import pathlib
import re
import sys
import tempfile
import unittest

import generated_structures as generated
import vdwmesh

FILES = int(os.environ.get("VDWMESH_GENERATED", "1500"))
# Which words of a warning or note announce which difference.
WORDS = {"elements": "element|symbol", "radii": "element|symbol|radi", "left_out": "left out",
         "resnames": "residue name|resname", "resids": "residue number|resid",
         "count": "location|left out"}  # fmt: skip


def read(plan, folder):
    """The molecule, or the error that refuses its file."""
    path = pathlib.Path(folder, "x" + generated.SUFFIXES.get(plan.dialect, ".pdb"))
    path.write_bytes(generated.write(plan).encode())
    try:
        return vdwmesh.read(path, format="pdb" if path.suffix == ".pdbqt" else None)
    except vdwmesh.Error as error:
        return error


def differences(plan, molecule):
    """(kind, found, meant, of a doubtful atom) for each attribute that is not as meant."""
    meant = generated.intended(plan)
    if len(molecule) != len(meant):
        return [("count", len(molecule), len(meant), False)]
    found = []

    def compare(kind, values, wanted):
        found.extend((kind, value, want, atom.doubtful) for value, want, atom in zip(values, wanted, meant)
                     if value != want)  # fmt: skip

    compare("coords", molecule.coords.tolist(), [[float(f"{x:.3f}") for x in atom.place] for atom in meant])
    compare("radii", molecule.radii.tolist(), [atom.radius for atom in meant])
    if plan.dialect != "xyzr":
        compare("elements", molecule.elements.tolist(), [atom.element for atom in meant])
        compare("names", molecule.names.tolist(), [atom.name for atom in meant])
        compare("resnames", molecule.resnames.tolist(), [atom.resname for atom in meant])
        compare("resids", molecule.resids.tolist(), [atom.resid for atom in meant])
        compare("chains", molecule.chains.tolist(), [atom.chain for atom in meant])
        compare("segments", molecule.segments.tolist(), [atom.segment for atom in meant])
    left, dropped = sum(molecule.left_out.values()), len(plan.atoms) - len(meant)
    if left != dropped and not plan.style["frames"]:  # what stands behind END need not be counted
        found.append(("left_out", dict(molecule.left_out), dropped, False))
    return found


def silent(plan, molecule):
    """The differences that nothing announces."""
    told = [str(word) for word in molecule.warnings]
    noted = [str(word) for word in molecule.notes]
    return [(kind, found, meant) for kind, found, meant, doubtful in differences(plan, molecule)
            if not any(re.search(WORDS.get(kind, kind.rstrip("s")), word)
                       for word in told + (noted if doubtful else []))]  # fmt: skip


def smallest(plan, kind, folder):
    """The plan with as few atoms as still show a silent difference of the kind.

    Residues with alternate locations go as a whole, because what stays of them depends on all of their atoms.
    """
    def with_parts(parts):
        atoms = [atom for part in parts for atom in part]
        return generated.Plan(plan.dialect, sorted(atoms, key=order.get), plan.style, plan.seed)

    def shows(parts):
        fewer = with_parts(parts)
        molecule = read(fewer, folder) if any(atom.stays for atom in fewer.atoms) else None
        return isinstance(molecule, vdwmesh.Molecule) and any(row[0] == kind for row in silent(fewer, molecule))

    order = Places(plan.atoms)
    parts, step = together(plan.atoms), max(1, len(plan.atoms) // 2)
    while step:
        index = 0
        while index < len(parts):
            fewer = parts[:index] + parts[index + step :]
            if fewer and shows(fewer):
                parts = fewer
            else:
                index += step
        step //= 2
    return with_parts(parts)


class Places(dict):
    """Where each atom stands in a list."""

    def __init__(self, atoms):
        super().__init__((id(atom), index) for index, atom in enumerate(atoms))

    def get(self, atom):
        return self[id(atom)]


def together(atoms):
    """Atoms one by one, but all those of a residue and model that has alternate locations."""
    split = {(atom.residue, atom.model) for atom in atoms if atom.alt}
    parts = collections.defaultdict(list)
    for index, atom in enumerate(atoms):
        residue = atom.residue, atom.model
        parts[residue if residue in split else index].append(atom)
    return list(parts.values())


def read_all(seeds):
    """Silent differences and refusals, each with the plans that show them."""
    differing, refused = collections.defaultdict(list), collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            plan = generated.make_plan(seed)
            molecule = read(plan, folder)
            if "broken" in plan.style:
                if not isinstance(molecule, vdwmesh.Error):
                    differing[plan.dialect, "refusal"].append(plan)
                continue
            if isinstance(molecule, vdwmesh.Error):
                refused[str(molecule).split(": ", 1)[-1]].append(plan)
                continue
            for kind in {row[0] for row in silent(plan, molecule)}:
                differing[plan.dialect, kind].append(plan)
    return differing, refused


def story(plan, kind=None):
    """The smallest file that shows a difference, and what was read of it."""
    with tempfile.TemporaryDirectory() as folder:
        plan = smallest(plan, kind, folder) if kind not in (None, "refusal") else plan
        molecule = read(plan, folder)
        lines = [f"seed {plan.seed}, {plan.dialect}:", generated.write(plan)]
        if isinstance(molecule, vdwmesh.Error):
            return "\n".join([*lines, f"refused: {molecule}"])
        rows = [f"{name}: read {found!r}, meant {meant!r}" for name, found, meant, _ in differences(plan, molecule)]
        return "\n".join([*lines, *rows, f"left out: {dict(molecule.left_out)}", f"warnings: {list(molecule.warnings)}",
                          f"notes: {list(molecule.notes)}"])  # fmt: skip


class GeneratedTest(unittest.TestCase):
    def test_no_difference_is_silent(self):
        differing, refused = read_all(range(FILES))
        told = [f"{dialect}, {kind}: {len(plans)} files, such as\n{story(plans[0], kind)}"
                for (dialect, kind), plans in sorted(differing.items())]  # fmt: skip
        self.assertFalse(told, "\n\n".join(told))
        count = sum(map(len, refused.values()))
        self.assertLess(count, FILES / 100, "\n".join(sorted(refused)))

    def test_the_comparison_sees_every_attribute(self):
        changes = {"element": "X", "name": "X", "resname": "X", "number": 31999, "chain": "?", "segment": "X",
                   "radius": 9.0, "place": (1.5, 2.5, 3.5), "stays": False}  # fmt: skip
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(40):
                plan = generated.make_plan(seed)
                molecule = read(plan, folder)
                if plan.dialect == "xyzr" or isinstance(molecule, vdwmesh.Error):
                    continue
                for attribute, value in changes.items():
                    atom = generated.intended(plan)[-1]
                    before = len(differences(plan, molecule))
                    meant, atom.__dict__[attribute] = getattr(atom, attribute), value
                    with self.subTest(seed=seed, attribute=attribute):
                        self.assertTrue(len(differences(plan, molecule)) > before or attribute == "stays" and
                                        differences(plan, molecule)[0][0] == "count")  # fmt: skip
                    atom.__dict__[attribute] = meant

    def test_the_generator_is_the_same_every_time(self):
        for seed in range(50):
            self.assertEqual(generated.write(generated.make_plan(seed)), generated.write(generated.make_plan(seed)))


if __name__ == "__main__":
    if sys.argv[1:] and sys.argv[1].isdigit():
        print(story(generated.make_plan(int(sys.argv[1]))))
    else:
        unittest.main()
