"""What `generated_structures` puts molecules together from: atoms with the elements that chemistry gives them.

Names are those of the Chemical Component Dictionary of the wwPDB, and where a program has its own, of the
topologies of CHARMM36, AMBER ff14SB and GROMACS.
"""

from dataclasses import dataclass, field

# Bondi, J. Phys. Chem. 68 (1964) 441, hydrogen 1.20 Å; what he has not, Alvarez, Dalton Trans. 42 (2013) 8617. Å.
RADII = {"H": 1.20, "D": 1.20, "C": 1.70, "N": 1.55, "O": 1.52, "F": 1.47, "Na": 2.27, "Mg": 1.73, "P": 1.80, "S": 1.80,
         "Cl": 1.75, "K": 2.75, "Ca": 2.62, "Mn": 2.45, "Fe": 2.44, "Co": 2.40, "Ni": 1.63, "Cu": 1.40, "Zn": 1.39,
         "Se": 1.90, "Br": 1.85, "Cd": 1.58, "I": 1.98, "Hg": 1.55, "Li": 1.82, "Ag": 1.72, "Au": 1.66, "Pb": 2.02,
         "Sr": 2.84, "Ba": 3.03, "As": 1.85, "B": 1.91, "V": 2.42}  # fmt: skip

MAIN = "N CA C O"
SIDE = {
    "GLY": "", "ALA": "CB", "SER": "CB OG", "CYS": "CB SG", "VAL": "CB CG1 CG2", "LEU": "CB CG CD1 CD2",
    "ILE": "CB CG1 CG2 CD1", "MET": "CB CG SD CE", "PHE": "CB CG CD1 CD2 CE1 CE2 CZ", "PRO": "CB CG CD",
    "TYR": "CB CG CD1 CD2 CE1 CE2 CZ OH", "THR": "CB OG1 CG2", "TRP": "CB CG CD1 CD2 NE1 CE2 CE3 CZ2 CZ3 CH2",
    "HIS": "CB CG ND1 CD2 CE1 NE2", "LYS": "CB CG CD CE NZ", "ARG": "CB CG CD NE CZ NH1 NH2",
    "ASP": "CB CG OD1 OD2", "GLU": "CB CG CD OE1 OE2", "ASN": "CB CG OD1 ND2", "GLN": "CB CG CD OE1 NE2",
}  # fmt: skip
HYDROGENS = {
    "GLY": "H HA2 HA3", "ALA": "H HA HB1 HB2 HB3", "SER": "H HA HB2 HB3 HG", "CYS": "H HA HB2 HB3 HG",
    "VAL": "H HA HB HG11 HG12 HG13 HG21 HG22 HG23", "LEU": "H HA HB2 HB3 HG HD11 HD12 HD21 HD23",
    "ILE": "H HA HB HG12 HG13 HG21 HD11 HD12", "MET": "H HA HB2 HG2 HG3 HE1 HE2 HE3",
    "PHE": "H HA HB2 HD1 HD2 HE1 HE2 HZ", "PRO": "HA HB2 HB3 HG2 HG3 HD2 HD3", "TYR": "H HA HD1 HD2 HE1 HE2 HH",
    "THR": "H HA HB HG1 HG21 HG22 HG23", "TRP": "H HA HD1 HE1 HE3 HZ2 HZ3 HH2", "HIS": "H HA HB2 HD1 HD2 HE1 HE2",
    "LYS": "H HA HB2 HG2 HD2 HE2 HE3 HZ1 HZ2 HZ3", "ARG": "H HA HB2 HG2 HD2 HE HH11 HH12 HH21 HH22",
    "ASP": "H HA HB2 HB3", "GLU": "H HA HB2 HG2 HG3", "ASN": "H HA HB2 HD21 HD22", "GLN": "H HA HB2 HG2 HE21 HE22",
}  # fmt: skip
CAPS = {"ACE": "C O CH3 HH31 HH32 HH33", "NME": "N CH3 H HH31 HH32 HH33"}
SUGAR = "P OP1 OP2 O5' C5' C4' O4' C3' O3' C2' C1'"
BASES = {"A": "N9 C8 N7 C5 C6 N6 N1 C2 N3 C4", "G": "N9 C8 N7 C5 C6 O6 N1 C2 N2 N3 C4", "C": "N1 C2 O2 N3 C4 N4 C5 C6",
         "U": "N1 C2 O2 N3 C4 O4 C5 C6"}  # fmt: skip
NUCLEIC_HYDROGENS = "HO5' H5' H5'' H4' H3' H1' HO3'"

# (residue, (name, element) of its atoms): names that begin like another element, which the columns tell apart.
LIGANDS = [
    ("HEM", "FE:Fe NA:N NB:N NC:N ND:N CHA:C CHB:C CMA:C CAA:C CBA:C CGA:C O1A:O O2A:O HHA:H HMA1:H HBA1:H"),
    ("MSE", "N:N CA:C C:C O:O CB:C CG:C SE:Se CE:C"),
    ("LIG", "C1:C C2:C N1:N O1:O CL1:Cl BR1:Br F1:F S1:S H1:H"),
    ("UNL", "C1:C CA:C CD:C CL:Cl BR:Br I1:I P1:P HO:H NB:N"),
    ("SO4", "S:S O1:O O2:O O3:O O4:O"),
    ("PO4", "P:P O1:O O2:O O3:O O4:O"),
    ("GOL", "C1:C O1:O C2:C O2:O C3:C O3:O"),
    ("NAG", "C1:C C2:C N2:N O3:O O4:O C7:C O7:O C8:C"),
    ("ATP", "PG:P O1G:O PB:P O1B:O PA:P O1A:O O5':O C5':C C4':C O4':O N9:N C8:C"),
    ("SF4", "FE1:Fe FE2:Fe FE3:Fe FE4:Fe S1:S S2:S S3:S S4:S"),
    ("HEC", "FE:Fe NA:N NB:N NC:N ND:N CHA:C CAC:C"),
    ("CAC", "AS:As O1:O O2:O C1:C C2:C"), ("BO3", "B:B O1:O O2:O O3:O"), ("VO4", "V:V O1:O O2:O O3:O O4:O"),
    ("FME", "N:N CN:C O1:O CA:C CB:C CG:C SD:S CE:C C:C O:O"), ("HYP", "N:N CA:C C:C O:O CB:C CG:C CD:C OD1:O"),
    ("SEP", "N:N CA:C CB:C OG:O C:C O:O P:P O1P:O O2P:O O3P:O"), ("CSO", "N:N CA:C CB:C SG:S C:C O:O OD:O"),
    ("CMO", "C:C O:O"), ("NO", "N:N O:O"), ("CYN", "C:C N:N"), ("OXY", "O1:O O2:O"),
    ("CLR", "C1:C C2:C O1:O C27:C"),
]  # fmt: skip
IONS = [("ZN", "ZN", "Zn"), ("CA", "CA", "Ca"), ("MG", "MG", "Mg"), ("NA", "NA", "Na"), ("CL", "CL", "Cl"),
        ("K", "K", "K"), ("MN", "MN", "Mn"), ("CU", "CU", "Cu"), ("NI", "NI", "Ni"), ("CO", "CO", "Co"),
        ("CD", "CD", "Cd"), ("HG", "HG", "Hg"), ("FE", "FE", "Fe"), ("BR", "BR", "Br"), ("IOD", "I", "I"),
        ("FE2", "FE", "Fe"), ("AG", "AG", "Ag"), ("AU", "AU", "Au"), ("PB", "PB", "Pb"), ("LI", "LI", "Li"),
        ("SR", "SR", "Sr"), ("BA", "BA", "Ba"), ("3CO", "CO", "Co"), ("CU1", "CU", "Cu")]  # fmt: skip
CHARMM_IONS = [("SOD", "SOD", "Na"), ("CLA", "CLA", "Cl"), ("POT", "POT", "K"), ("CAL", "CAL", "Ca"),
               ("ZN2", "ZN", "Zn"),
               ("MG", "MG", "Mg")]  # fmt: skip
AMBER_IONS = [("Na+", "Na+", "Na"), ("Cl-", "Cl-", "Cl"), ("K+", "K+", "K"), ("MG", "MG", "Mg"), ("ZN", "ZN", "Zn"),
              ("NA", "NA", "Na"), ("CL", "CL", "Cl")]  # fmt: skip
GROMACS_IONS = [("NA", "NA", "Na"), ("CL", "CL", "Cl"), ("K", "K", "K"), ("CA", "CA", "Ca"), ("ZN", "ZN", "Zn"),
                ("MG", "MG", "Mg")]  # fmt: skip
LIPIDS = [("POPC", "N:N C12:C H12A:H C13:C C15:C P:P O13:O O11:O C21:C O22:O C218:C H18R:H C316:C"),
          ("DPPC", "N:N C11:C P:P O14:O C2:C HS:H O21:O C216:C"),
          ("CHL1", "C3:C O3:O H3':H C4:C C5:C H18A:H C19:C"),
          ("TIP3", "OH2:O H1:H H2:H")]  # fmt: skip
WATERS = {"wwpdb": [("HOH", "O:O"), ("HOH", "O:O H1:H H2:H"), ("DOD", "O:O D1:D D2:D")],
          "charmm": [("TIP3", "OH2:O H1:H H2:H")],
          "amber": [("WAT", "O:O H1:H H2:H")],
          "gromacs": [("SOL", "OW:O HW1:H HW2:H"), ("HOH", "OW:O HW1:H HW2:H")]}  # fmt: skip
WATER_NAMES = {"HOH", "DOD", "TIP3", "WAT", "SOL"}


@dataclass
class Atom:
    """One atom as it is meant, and how its file is to place it."""

    element: str
    name: str
    resname: str
    number: int = 1
    icode: str = ""
    chain: str = ""
    segment: str = ""
    place: tuple = (0.0, 0.0, 0.0)
    radius: float = 0.0
    alt: str = ""
    occupancy: float = 1.0
    hetero: bool = False
    stays: bool = True  # by the rules of docs/options.md: no water, first model, the location of the highest occupancy
    model: int = 0
    symbol: str = ""  # what stands for the element, where that is another one
    doubtful: bool = False  # nothing in the file tells the element for certain: a note that it was guessed is enough
    residue: int = 0
    dropped: str = ""

    @property
    def resid(self):
        return f"{self.number}{self.icode}"


@dataclass
class Plan:
    """A molecule, and all that was chosen about its file."""

    dialect: str
    atoms: list
    style: dict = field(default_factory=dict)
    seed: int = 0


def atoms_of(resname, names):
    """Atoms of a standard residue: the first letter of a name is its element there."""
    return [Atom(element=name[0], name=name, resname=resname) for name in names.split()]


def atoms_of_pairs(resname, pairs, hetero=True):
    found = []
    for pair in pairs.split():
        name, element = pair.split(":")
        found.append(Atom(element=element, name=name, resname=resname, hetero=hetero))
    return found
