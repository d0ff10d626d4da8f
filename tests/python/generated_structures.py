"""Small structure files by a seed, with the atoms that each of them means.

`make_plan` invents a molecule and a way to write it; `write` writes it; `intended` says what a reader must find, from
the molecule and never from the text. Columns are those of the format's own documents: wwPDB 3.30 and 1.0, CHARMM's and
psfgen's writers (residue name in 18-21, segment in 73-76), AutoDock's PDBQT (charge in 71-76, type in 78-79), PQR as
PDB2PQR documents it, the PDBx/mmCIF dictionary.
"""

import random

from generated_residues import (AMBER_IONS, BASES, CAPS, CHARMM_IONS, GROMACS_IONS, HYDROGENS, IONS, LIGANDS, LIPIDS,
                                MAIN, NUCLEIC_HYDROGENS, RADII, SIDE, SUGAR, WATER_NAMES, WATERS, Atom, Plan, atoms_of,
                                atoms_of_pairs)  # fmt: skip
from generated_writers import write_cif, write_pdb, write_pqr, write_xyzr

DIALECTS = ["wwpdb"] * 4 + ["old"] * 3 + ["charmm"] * 2 + ["namd"] * 2 + ["amber"] * 2 + ["gromacs"] * 2 + \
    ["pymol"] + ["vmd"] * 2 + ["alphafold", "left"] + ["pdbqt"] * 2 + ["pqr"] * 3 + ["xyzr"] + ["cif"] * 6  # fmt: skip
SUFFIXES = {"pqr": ".pqr", "xyzr": ".xyzr", "cif": ".cif", "pdbqt": ".pdbqt"}
AMBER_NAMES = {"HIS": ("HIE", "HID", "HIP"), "CYS": ("CYX", "CYM"), "ASP": ("ASH",), "GLU": ("GLH",), "LYS": ("LYN",)}
CHARMM_BASES = {"A": "ADE", "G": "GUA", "C": "CYT", "U": "URA"}
ALTLOC_DIALECTS = ("wwpdb", "old", "pymol", "cif")
# Symbols that names in LIGANDS begin with.
TWO_LETTERS = {"Ca", "Cd", "Cl", "Cm", "Co", "Br", "Fe", "Na", "Nb", "Nd", "Ho", "As", "Ce", "Cn", "Pa", "Pb", "Se"}
CHAINS = "ABCDEFGHXYZ"


def family(dialect):
    """Whose residues a dialect writes."""
    return dialect if dialect in ("amber", "gromacs") else "charmm" if dialect in ("charmm", "namd") else "wwpdb"


def make_plan(seed):
    rng = random.Random(seed)
    dialect = rng.choice(DIALECTS)
    style = {"dialect": dialect, "newline": rng.choice(["\n"] * 17 + ["\r\n"] * 2 + ["\r"]), "seed": rng.random()}
    choose_style(rng, dialect, style)
    plan = Plan(dialect, [], style, seed)
    if dialect == "xyzr":
        plan.atoms = [Atom("", "", "") for _ in range(rng.randint(1, 30))]
    else:
        add_residues(rng, plan)
    if dialect in ALTLOC_DIALECTS and style["altlocs"]:
        add_alternates(rng, plan)
    place(rng, plan)
    if style["contradictions"]:
        contradict(rng, plan)
    if style["models"] > 1:
        add_models(rng, plan)
    if style["zero"]:
        for atom in plan.atoms:
            atom.occupancy = 0.0
    numbered = all(atom.resname in SIDE and atom.number > 0 for atom in plan.atoms)
    if dialect == "cif" and not style["icodes"] and numbered:
        style["label_only"] = rng.random() < 0.3
    if rng.random() < 0.02:
        style["broken"], style["seed"] = rng.choice(["stars", "words", "cut"]), 0.5
    return plan


def choose_style(rng, dialect, style):
    often = lambda share: rng.random() < share  # noqa: E731
    no_symbols = dialect in ("old", "charmm", "left") or (dialect in ("namd", "amber", "gromacs") and often(0.5))
    style["symbols"] = "none" if no_symbols else "right"
    if dialect in ("pymol", "vmd") and often(0.3):
        style["symbols"] = rng.choice(["left", "mixed", "lower"])
    if dialect == "wwpdb" and often(0.08):
        style["symbols"] = "some"
    if dialect == "cif" and often(0.15):
        style["symbols"] = rng.choice(["missing", "unknown"])
    style["names"] = {"wwpdb": "aligned", "old": "aligned", "alphafold": "aligned", "pdbqt": "aligned",
                      "pymol": rng.choice(["aligned", "left"]), "vmd": rng.choice(["left", "second"]),
                      "left": "left"}.get(dialect, "second")  # fmt: skip
    style["hydrogens"] = dialect != "alphafold" and often(0.5)
    style["altlocs"] = often(0.5)
    style["repeats"] = not style["altlocs"] and often(0.2)
    style["icodes"] = dialect in ("wwpdb", "old", "pymol", "pqr", "cif", "namd") and often(0.3)
    style["models"] = rng.randint(2, 4) if dialect != "xyzr" and often(0.15) else 1
    if dialect == "alphafold":
        style["models"] = 1
    style["frames"] = dialect == "vmd" and often(0.5)  # VMD ends each frame by END, without MODEL
    style["contradictions"] = dialect in ("wwpdb", "pymol", "vmd", "cif", "namd") and \
        style["symbols"] in ("right", "mixed") and often(0.1)  # fmt: skip
    style["zero"] = not style["altlocs"] and often(0.1)
    style["bom"] = often(0.02)
    style["occupancy"] = style["altlocs"] or dialect == "pdbqt" or not often(0.15)
    style["short"] = not style["occupancy"] and dialect not in ("pqr", "cif", "xyzr") and often(0.4)
    if style["short"]:  # lines end behind z: no segments and symbols either
        style["symbols"], style["contradictions"] = "none", False
    style["chains"] = chain_names(rng, dialect)
    style["old_hydrogens"] = dialect == "old" or (dialect == "amber" and often(0.3))


def chain_names(rng, dialect):
    if dialect in ("charmm", "amber"):
        return [""] * (rng.randint(1, 3) if dialect == "charmm" else 1)
    if dialect in ("pymol", "left", "gromacs", "vmd", "old", "pqr", "pdbqt") and rng.random() < 0.35:
        return [""]
    if dialect == "cif" and rng.random() < 0.4:
        return rng.sample(["AA", "BA", "A1", "AAA", "X-2", "Z", "a", "heavy", "1"], 2)
    if dialect == "pymol" and rng.random() < 0.2:
        return rng.sample(["AA", "B1", "Cx"], 2)  # columns 21 and 22, as gemmi and cctbx write them
    if dialect == "pqr" and rng.random() < 0.15:
        return ["AA", "PROA"]
    if dialect == "alphafold":
        return ["A"]
    return rng.sample(CHAINS + "abz019", rng.randint(1, 3))


# Residues.


def standard_residue(rng, plan):
    resname = rng.choice(sorted(SIDE))
    if rng.random() < 0.15 and plan.dialect != "alphafold":
        return nucleotide(rng, plan)
    if rng.random() < 0.05 and family(plan.dialect) != "charmm" and plan.dialect != "alphafold":
        resname = rng.choice(sorted(CAPS))
        return atoms_of(resname, CAPS[resname] if plan.style["hydrogens"] else CAPS[resname].split(" H")[0])
    names = f"{MAIN} {SIDE[resname]}"
    if rng.random() < 0.08:
        names += " OT1 OT2" if family(plan.dialect) == "charmm" else " OXT"
    if plan.style["hydrogens"]:
        names += " " + HYDROGENS[resname]
    atoms = atoms_of(resname, names)
    for atom in atoms:
        rename_standard(rng, plan, resname, atom)
    called = resname
    if plan.dialect in ("charmm", "namd") and resname == "HIS":
        called = rng.choice(["HSD", "HSE", "HSP"])
    elif plan.dialect == "amber" and resname in AMBER_NAMES:
        called = rng.choice(AMBER_NAMES[resname])
    for atom in atoms:
        atom.resname = called
    if rng.random() < 0.05 and plan.style["symbols"] == "right" and plan.dialect in ("wwpdb", "cif"):
        for atom in atoms:
            if atom.element == "H":
                atom.element, atom.name = "D", "D" + atom.name[1:]
    return atoms


def rename_standard(rng, plan, resname, atom):
    if family(plan.dialect) == "charmm":
        if atom.name == "H":
            atom.name = "HN"
        if resname == "ILE" and atom.name == "CD1":
            atom.name = "CD"
    if plan.style["old_hydrogens"] and atom.element == "H" and len(atom.name) > 2 and atom.name[-1].isdigit():
        atom.name = atom.name[-1] + atom.name[:-1]  # 1HB, 2HG1: before the remediation of 2007, and PDB of AMBER


def nucleotide(rng, plan):
    base = rng.choice(sorted(BASES))
    names = f"{SUGAR} {BASES[base]}" + (f" {NUCLEIC_HYDROGENS}" if plan.style["hydrogens"] else "")
    resname = base
    if family(plan.dialect) == "charmm":
        resname = CHARMM_BASES[base]
    elif base != "U" and rng.random() < 0.5:
        resname = "D" + base
        names = names.replace(" O2'", "")
    atoms = atoms_of(resname, names)
    if plan.dialect in ("old", "charmm", "amber") and rng.random() < 0.5:
        for atom in atoms:
            atom.name = {"OP1": "O1P", "OP2": "O2P"}.get(atom.name, atom.name)
            if plan.dialect == "old":
                atom.name = atom.name.replace("''", "*").replace("'", "*")
    return atoms


def other_residue(rng, plan):
    kind, whose = rng.random(), family(plan.dialect)
    if kind < 0.35:
        return water(rng, plan)
    if kind < 0.65:
        ions = {"charmm": CHARMM_IONS, "amber": AMBER_IONS, "gromacs": GROMACS_IONS}.get(whose, IONS)
        resname, name, element = rng.choice(ions)
        return [Atom(element, name, resname, hetero=True)]
    if whose == "charmm":
        return atoms_of_pairs(*rng.choice(LIPIDS), hetero=False)
    if plan.dialect in ("gromacs", "vmd") and kind < 0.85:
        return atoms_of_pairs(*rng.choice(LIPIDS[:3]), hetero=False)
    return ligand(rng, plan)


def water(rng, plan):
    choices = [pair for pair in WATERS[family(plan.dialect)] if pair[0] != "DOD" or plan.style["symbols"] == "right"]
    atoms = atoms_of_pairs(*rng.choice(choices))
    if not plan.style["hydrogens"]:
        atoms = atoms[:1]
    elif plan.dialect in ("amber", "gromacs") and rng.random() < 0.2:  # the fourth point of TIP4P, which is no atom
        atoms.append(Atom("", "EPW" if plan.dialect == "amber" else "MW", atoms[0].resname))
    return atoms


def ligand(rng, plan):
    resname, pairs = rng.choice(LIGANDS)
    atoms = atoms_of_pairs(resname, pairs)
    if plan.dialect in ("pymol", "vmd", "pdbqt") and not plan.style["altlocs"] and rng.random() < 0.5:
        for atom in atoms:  # as Open Babel names them, all alike
            atom.name, atom.resname = atom.element.upper(), rng.choice(["UNL"]) if plan.style["seed"] < 0.7 else ""
    symbols = plan.style["symbols"] in ("right", "left", "mixed", "lower") and plan.dialect not in ("pqr", "pdbqt")
    aligned = plan.style["names"] == "aligned" and plan.dialect not in ("pqr", "cif")
    if not symbols and not aligned:  # then a name of two letters can mean two elements
        for atom in atoms:
            atom.doubtful = atom.name[:2].capitalize() in TWO_LETTERS
    return atoms


def add_residues(rng, plan):
    wanted, index = rng.randint(1, 30), 0
    for turn, chain in enumerate(plan.style["chains"]):
        number, segment = first_number(rng, plan), segment_of(rng, plan, chain, turn)
        for _ in range(rng.randint(1, 6)):
            if len(plan.atoms) >= wanted:
                break
            residue, index = any_residue(rng, plan), index + 1
            residue = residue[: max(1, wanted - len(plan.atoms))]
            icode, number = next_number(rng, plan, number, index)
            add_residue(plan, residue, number, icode, chain, segment, index)
    if all(atom.dropped for atom in plan.atoms):  # a molecule of waters alone would be refused
        add_residue(plan, atoms_of("ALA", "CA CB"), 7, "", chain, segment, index + 1)


def first_number(rng, plan):
    if plan.dialect in ("pqr", "cif", "amber", "charmm") and rng.random() < 0.08:
        return 12000
    if plan.dialect in ("wwpdb", "pymol") and rng.random() < 0.03:
        return 9999  # hybrid-36 follows
    return rng.choice([1, 1, 5, -4, -120, 0, 98, 997, rng.randint(1, 9000)])


def any_residue(rng, plan):
    wide = max(map(len, plan.style["chains"])) > 1 and plan.dialect == "pymol"  # names of four letters look the same
    standard = rng.random() < 0.65 or plan.dialect == "alphafold" or wide
    return standard_residue(rng, plan) if standard else other_residue(rng, plan)


def add_residue(plan, residue, number, icode, chain, segment, index):
    for atom in residue:
        atom.number, atom.icode, atom.chain, atom.segment, atom.residue = number, icode, chain, segment, index
        if atom.resname in WATER_NAMES:
            atom.stays, atom.dropped = False, "waters"
    plan.atoms += residue


def next_number(rng, plan, number, index):
    if plan.style["icodes"] and index > 1 and rng.random() < 0.4:
        plan.style.setdefault("letter", 0)
        plan.style["letter"] += 1
        return "ABCDEFGHJKLM"[plan.style["letter"] % 12], number
    if plan.style["repeats"] and rng.random() < 0.4:
        return "", rng.choice([number, 1, number])
    return "", number + rng.choice([1, 1, 1, 2, 7])


def segment_of(rng, plan, chain, turn):
    if plan.style["short"]:
        return ""
    if plan.dialect in ("charmm", "namd"):
        return rng.choice(["PROA", "PROT", "MEMB", "A", "SOLV", "HETA", "P1", "IONS", "C123", "CARA"])
    if plan.dialect in ("vmd", "pymol") and rng.random() < 0.6:
        return rng.choice(["P1", "PROA", "SEG", "A", "W1", chain])
    return ""


# Alternate locations, contradictions, models, places.


def add_alternates(rng, plan):
    made = []
    for index in sorted({atom.residue for atom in plan.atoms}):
        residue = [atom for atom in plan.atoms if atom.residue == index]
        draw = rng.random()
        if draw < 0.4:
            residue = alternates(rng, residue)
        elif draw < 0.47 and residue[0].resname in SIDE:
            residue = two_residues(rng, residue)
        made += residue
    if rng.random() < 0.15:  # the second locations behind the chain, as files of the eighties have them
        chains = [atom.chain for atom in made]
        made.sort(key=lambda atom: (chains.index(atom.chain), bool(atom.alt) and atom.alt in "B2D"))
    plan.atoms = made


def copy_of(atom, **changes):
    return Atom(**{**atom.__dict__, **changes})


def shares(rng, count):
    """Occupancies that differ by at least 0.1: ties are nobody's rule."""
    return rng.choice({1: [[0.5], [1.0], [0.35]], 2: [[0.7, 0.3], [0.35, 0.65], [0.55, 0.45], [0.2, 0.8], [0.6, 0.3]],
                       3: [[0.5, 0.3, 0.2], [0.2, 0.5, 0.3], [0.1, 0.2, 0.7]]}[count])  # fmt: skip


def alternates(rng, residue):
    """Some atoms in two or three locations, of which that of the highest mean occupancy stays."""
    count = rng.choice([1, 2, 2, 2, 2, 3])
    labels = rng.choice([["A", "B", "C"], ["1", "2", "3"], ["B", "A", "C"], ["C", "D", "E"]])[:count]
    occupancies = shares(rng, count)
    best = labels[occupancies.index(max(occupancies))]
    chosen = {id(atom) for atom in residue if rng.random() < 0.6} or {id(residue[0])}
    lone, lone_label = rng.choice([atom for atom in residue if id(atom) in chosen]), rng.choice(labels)
    lone = lone if rng.random() < 0.2 and len(chosen) > 1 else None  # an atom that one label alone has
    blocks, locations = rng.random() < 0.3, []
    for atom in residue:
        if id(atom) not in chosen:
            locations.append([atom])
            continue
        locations.append([copy_of(atom, alt=label, occupancy=occupancy) for label, occupancy in zip(labels, occupancies)
                          if atom is not lone or label == lone_label])  # fmt: skip
    flat = [atom for of_atom in locations for atom in of_atom]
    best = spread(rng, flat, labels) or best
    for atom in flat:
        only = lone is not None and atom.name == lone.name
        atom.stays = not atom.dropped and (atom.alt in ("", best) or only)
        atom.dropped = atom.dropped or ("" if atom.stays else "alternate locations")
    return sorted(flat, key=lambda atom: labels.index(atom.alt) if atom.alt else -1) if blocks else flat


def spread(rng, atoms, labels):
    """Occupancies that vary among the atoms of a location; the label of the highest mean, where it is clear."""
    if rng.random() < 0.6:
        return None
    before, means = [atom.occupancy for atom in atoms], {}
    for atom in atoms:
        atom.occupancy = rng.randint(5, 95) / 100 if atom.alt else atom.occupancy
    for label in labels:
        values = [atom.occupancy for atom in atoms if atom.alt == label]
        means[label] = sum(values) / len(values) if values else 0.0
    ranked = sorted(means.values(), reverse=True)
    if len(ranked) > 1 and ranked[0] - ranked[1] < 0.03:
        for atom, occupancy in zip(atoms, before):
            atom.occupancy = occupancy
        return None
    return max(means, key=means.get)


def two_residues(rng, residue):
    """One position with two residues (microheterogeneity): that of the highest mean occupancy stays."""
    other = rng.choice([name for name in sorted(SIDE) if name != residue[0].resname])
    first, second = rng.choice([(0.7, 0.3), (0.4, 0.6)])
    found = [copy_of(atom, alt="A", occupancy=first, stays=first > second) for atom in residue]
    template = atoms_of(other, f"{MAIN} {SIDE[other]}")
    for atom in template:
        found.append(copy_of(residue[0], element=atom.element, name=atom.name, resname=other, alt="B",
                             occupancy=second, stays=second > first))  # fmt: skip
    for atom in found:
        atom.dropped = "" if atom.stays else "microheterogeneity"
    if rng.random() < 0.3:  # atom by atom in turns, as refinement programs write them
        order = {id(atom): index for part in ("A", "B") for index, atom in
                 enumerate(other for other in found if other.alt == part)}  # fmt: skip
        found.sort(key=lambda atom: (order[id(atom)], atom.alt))
    return found


def contradict(rng, plan):
    """Symbols that are another element than the atom of a standard residue can be."""
    standard = [atom for atom in plan.atoms if atom.resname in SIDE and atom.element in "CNOS"]
    draw = rng.random()
    if draw < 0.25:  # a writer that takes the first letter
        for atom in plan.atoms:
            if atom.element in ("Ca", "Na", "Cl", "Hg", "Fe", "Cu", "Co", "Br") and atom.name == atom.resname:
                atom.symbol = atom.element[0]
        return
    if draw < 0.5:  # a writer that takes the first two letters of each name for its symbol
        for atom in standard:
            if atom.name in ("CA", "CD", "CE", "NE", "NE1", "CD1", "CE1", "CD2", "NE2", "CE2"):
                atom.symbol = atom.name[:2].capitalize()
        return
    for atom in rng.sample(standard, min(len(standard), rng.randint(1, 3))):
        others = [symbol for symbol in ("C", "N", "O", "S", "Zn", "Fe", "Na") if symbol != atom.element]
        atom.symbol = rng.choice(others)


def add_models(rng, plan):
    first = list(plan.atoms)
    for model in range(1, plan.style["models"]):
        for atom in first:
            moved = tuple(round(x + rng.uniform(-2, 2), 3) for x in atom.place)
            plan.atoms.append(copy_of(atom, model=model, place=moved, stays=False, dropped="other models"))


def place(rng, plan):
    centre = [rng.choice([0, 0, 50, -900, 8000, rng.uniform(-500, 500)]) for _ in range(3)]
    for index, atom in enumerate(plan.atoms):
        width = 1.5 * (len(plan.atoms) + 1) ** (1 / 3)
        atom.place = tuple(round(c + rng.uniform(-width, width) + 0.001 * index, 3) for c in centre)
        if plan.dialect in ("pqr", "xyzr"):
            atom.radius = rng.choice([1.2, 1.7, 1.55, 2.0, 0.6, round(rng.uniform(0.1, 3), 4)])
            if atom.element in ("H", "") and rng.random() < 0.08 and any(other.stays for other in plan.atoms[:index]):
                atom.radius = 0.0
                atom.stays, atom.dropped = False, atom.dropped or "zero_radius"
        else:
            atom.radius = RADII.get(atom.element, 0.0)


# Text, and what it means.


def write(plan):
    rng = random.Random(plan.style["seed"])
    writer = {"cif": write_cif, "pqr": write_pqr, "xyzr": write_xyzr}.get(plan.dialect, write_pdb)
    lines = writer(rng, plan)
    if "broken" in plan.style:
        lines = broken(plan, lines)
    return ("\ufeff" if plan.style["bom"] else "") + plan.style["newline"].join(lines) + plan.style["newline"]


def broken(plan, lines):
    """A coordinate of the first atom as no reader can take it."""
    x = f"{plan.atoms[0].place[0]:.3f}"
    index = next(i for i, line in enumerate(lines) if x in line and line[:5] not in ("CRYST", "REMAR", "_cell"))
    wrong = {"stars": "*" * len(x), "words": "x" * len(x), "cut": "-." + "-" * (len(x) - 2)}[plan.style["broken"]]
    return lines[:index] + [lines[index].replace(x, wrong, 1)] + lines[index + 1 :]


def intended(plan):
    return [atom for atom in plan.atoms if atom.stays]
