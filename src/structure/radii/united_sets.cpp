// The numbers of the three sets of united atoms. The choice of a type for each atom is that of
// FreeSASA 2.1 (S. Mitternacht, F1000Research 5 (2016) 189), so that its results can be compared:
// - ProtOr: types and radii of Tsai et al. 1999, extended by FreeSASA to nucleotides, selenium and
//   end groups. Both oxygens of a carboxylate count as those of the acid: one with a hydrogen.
// - NACCESS: the radii of the program NACCESS (Hubbard and Thornton 1993).
// - OONS: Ooi et al. 1987, in which carbonyl carbons count as polar.
#include "structure/radii/united_sets.hpp"

#include <array>

namespace vdwmesh {
namespace {

constexpr Polarity kPolar = Polarity::polar, kApolar = Polarity::apolar;

// Names of ProtOr: element, number of bonded atoms, number of hydrogens among them. C4H2 is a
// methylene group.
constexpr std::array kProtOrTypes{
    AtomType{"C3H0", "C", 1.61, kApolar},  AtomType{"C3H1", "C", 1.76, kApolar},
    AtomType{"C4H1", "C", 1.88, kApolar},  AtomType{"C4H2", "C", 1.88, kApolar},
    AtomType{"C4H3", "C", 1.88, kApolar},  AtomType{"N2H0", "N", 1.64, kPolar},
    AtomType{"N2H2", "N", 1.64, kPolar},   AtomType{"N3H0", "N", 1.64, kPolar},
    AtomType{"N3H1", "N", 1.64, kPolar},   AtomType{"N3H2", "N", 1.64, kPolar},
    AtomType{"N4H3", "N", 1.64, kPolar},   AtomType{"O1H0", "O", 1.42, kPolar},
    AtomType{"O2H0", "O", 1.46, kPolar},   AtomType{"O2H1", "O", 1.46, kPolar},
    AtomType{"O2H2", "O", 1.46, kPolar},   AtomType{"P4H0", "P", 1.80, kPolar},
    AtomType{"S2H0", "S", 1.77, kPolar},   AtomType{"S2H1", "S", 1.77, kPolar},
    AtomType{"SE2H0", "Se", 1.90, kPolar}, AtomType{"SE2H1", "Se", 1.90, kPolar},
    AtomType{"X1H0", "", 1.50, kPolar},  // N or O, which ASX and GLX leave open
};

constexpr std::array kProtOrAtoms{
    TypedAtoms{"ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL "
               "ASX GLX PYL SEC MSE",
               "N N3H1, C C3H0, O O1H0, OXT O2H1"},
    TypedAtoms{"ALA ARG ASN ASP CYS GLN GLU HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL "
               "ASX GLX PYL SEC MSE",
               "CA C4H1"},
    TypedAtoms{"GLY", "CA C4H2"},
    TypedAtoms{"ALA", "CB C4H3"},
    TypedAtoms{"ARG", "CB CG CD C4H2, NE N3H1, CZ C3H0, NH1 NH2 N3H2"},
    TypedAtoms{"ASN", "CB C4H2, CG C3H0, OD1 O1H0, ND2 N3H2"},
    TypedAtoms{"ASP", "CB C4H2, CG C3H0, OD1 O1H0, OD2 O2H1"},
    TypedAtoms{"CYS", "CB C4H2, SG S2H1"},
    TypedAtoms{"GLN", "CB CG C4H2, CD C3H0, OE1 O1H0, NE2 N3H2"},
    TypedAtoms{"GLU", "CB CG C4H2, CD C3H0, OE1 O1H0, OE2 O2H1"},
    TypedAtoms{"HIS", "CB C4H2, CG C3H0, ND1 NE2 N3H1, CD2 CE1 C3H1"},
    TypedAtoms{"ILE", "CB C4H1, CG1 C4H2, CG2 CD1 C4H3"},
    TypedAtoms{"LEU", "CB C4H2, CG C4H1, CD1 CD2 C4H3"},
    TypedAtoms{"LYS", "CB CG CD CE C4H2, NZ N4H3"},
    TypedAtoms{"MET", "CB CG C4H2, SD S2H0, CE C4H3"},
    TypedAtoms{"PHE", "CB C4H2, CG C3H0, CD1 CD2 CE1 CE2 CZ C3H1"},
    TypedAtoms{"PRO", "CB CG CD C4H2"},
    TypedAtoms{"SER", "CB C4H2, OG O2H1"},
    TypedAtoms{"THR", "CB C4H1, OG1 O2H1, CG2 C4H3"},
    TypedAtoms{"TRP", "CB C4H2, CG CD2 CE2 C3H0, NE1 N3H1, CD1 CE3 CZ2 CZ3 CH2 C3H1"},
    TypedAtoms{"TYR", "CB C4H2, CG CZ C3H0, CD1 CD2 CE1 CE2 C3H1, OH O2H1"},
    TypedAtoms{"VAL", "CB C4H1, CG1 CG2 C4H3"},
    TypedAtoms{"ASX", "CB C4H2, CG C3H0, XD1 XD2 X1H0"},
    TypedAtoms{"GLX", "CB CG C4H2, CD C3H0, XE1 XE2 X1H0"},
    TypedAtoms{"PYL",
               "CB CG CD CE C4H2, NZ N3H1, C2 C3H0, O2 O1H0, CA2 CG2 C4H1, CB2 C4H3, CD2 C4H2, "
               "CE2 C3H1, N2 N2H0"},
    TypedAtoms{"SEC", "CB C4H2, SE SE2H1"},
    TypedAtoms{"MSE", "CB CG C4H2, SE SE2H0, CE C4H3"},
    TypedAtoms{"HOH", "O O2H2"},
    TypedAtoms{"NH2", "N N2H2"},
    TypedAtoms{"ACE", "C C3H1, O O1H0, CH3 C4H3"},
    TypedAtoms{
        "A C G I T U DA DC DG DI DT DU",
        "P P4H0, OP1 O1H0, OP2 OP3 O2H1, O5' O4' O2H0, O3' O2H1, C5' C4H2, C4' C3' C1' C4H1"},
    TypedAtoms{"A C G I U", "C2' C4H1, O2' O2H1"},
    TypedAtoms{"T DA DC DG DI DT DU", "C2' C4H2"},
    TypedAtoms{"A DA", "N9 N3H0, N1 N3 N7 N2H0, N6 N3H2, C4 C5 C6 C3H0, C2 C8 C3H1"},
    TypedAtoms{"G DG", "N9 N3H0, N3 N7 N2H0, N1 N3H1, N2 N3H2, C2 C4 C5 C6 C3H0, C8 C3H1, O6 O1H0"},
    TypedAtoms{"I DI", "N9 N3H0, N3 N7 N2H0, N1 N3H1, C4 C5 C6 C3H0, C2 C8 C3H1, O6 O1H0"},
    TypedAtoms{"C DC", "N1 N3H0, N3 N2H0, N4 N3H2, C2 C4 C3H0, C5 C6 C3H1, O2 O1H0"},
    TypedAtoms{"T DT", "N1 N3H0, N3 N3H1, C2 C4 C5 C3H0, C6 C3H1, C7 C4H3, O2 O4 O1H0"},
    TypedAtoms{"U DU", "N1 N3H0, N3 N3H1, C2 C4 C3H0, C5 C6 C3H1, O2 O4 O1H0"},
};

constexpr std::array kNaccessTypes{
    AtomType{"C_ALI", "C", 1.87, kApolar}, AtomType{"C_CAR", "C", 1.76, kApolar},
    AtomType{"C_NUC", "C", 1.80, kApolar}, AtomType{"N_AMN", "N", 1.50, kPolar},
    AtomType{"N_AMD", "N", 1.65, kPolar},  AtomType{"N_NUC", "N", 1.60, kPolar},
    AtomType{"O", "O", 1.40, kPolar},      AtomType{"P", "P", 1.90, kApolar},
    AtomType{"S", "S", 1.85, kApolar},     AtomType{"SE", "Se", 1.80, kApolar},
};

constexpr std::array kNaccessAtoms{
    TypedAtoms{"*",
               "C C_CAR, CA CB C_ALI, N N_AMD, O OXT O, P P, OP1 OP2 OP3 O5' O4' O3' O2' O, "
               "C5' C4' C3' C2' C1' C_NUC"},
    TypedAtoms{"ARG", "CG CD C_ALI, CZ C_CAR, NE NH1 NH2 N_AMD"},
    TypedAtoms{"ASN", "CG C_CAR, OD1 O, ND2 N_AMD"},
    TypedAtoms{"ASP", "CG C_CAR, OD1 OD2 O"},
    TypedAtoms{"CYS", "SG S"},
    TypedAtoms{"GLN", "CG C_ALI, CD C_CAR, OE1 O, NE2 N_AMD"},
    TypedAtoms{"GLU", "CG C_ALI, CD C_CAR, OE1 OE2 O"},
    TypedAtoms{"HIS", "CG CD2 CE1 C_CAR, ND1 NE2 N_AMD"},
    TypedAtoms{"ILE", "CG1 CG2 CD1 C_ALI"},
    TypedAtoms{"LEU", "CG CD1 CD2 C_ALI"},
    TypedAtoms{"LYS", "CG CD CE C_ALI, NZ N_AMN"},
    TypedAtoms{"MET", "CG CE C_ALI, SD S"},
    TypedAtoms{"SEC MSE", "SE SE"},
    TypedAtoms{"PHE", "CG CD1 CD2 CE1 CE2 CZ C_CAR"},
    TypedAtoms{"PRO", "CG CD C_ALI"},
    TypedAtoms{"SER", "OG O"},
    TypedAtoms{"THR", "CG2 C_ALI, OG1 O"},
    TypedAtoms{"TRP", "CG CD1 CD2 CE2 CE3 CZ2 CZ3 CH2 C_CAR, NE1 N_AMD"},
    TypedAtoms{"TYR", "CG CD1 CD2 CE1 CE2 CZ C_CAR, OH O"},
    TypedAtoms{"VAL", "CG1 CG2 C_ALI"},
    TypedAtoms{"A DA", "N1 N3 N6 N7 N9 N_NUC, C2 C4 C5 C6 C8 C_NUC"},
    TypedAtoms{"G DG", "N1 N2 N3 N7 N9 N_NUC, C2 C4 C5 C6 C8 C_NUC, O6 O"},
    TypedAtoms{"I DI", "N1 N3 N7 N9 N_NUC, C2 C4 C5 C6 C8 C_NUC, O6 O"},
    TypedAtoms{"C DC", "N1 N3 N4 N_NUC, C2 C4 C5 C6 C_NUC, O2 O"},
    TypedAtoms{"T DT", "N1 N3 N_NUC, C2 C4 C5 C6 C7 C_NUC, O2 O4 O"},
    TypedAtoms{"U DU", "N1 N3 N_NUC, C2 C4 C5 C6 C_NUC, O2 O4 O"},
};

constexpr std::array kOonsTypes{
    AtomType{"C_ALI", "C", 2.00, kApolar}, AtomType{"C_ARO", "C", 1.75, kApolar},
    AtomType{"C_CAR", "C", 1.55, kPolar},  AtomType{"N", "N", 1.55, kPolar},
    AtomType{"O", "O", 1.40, kPolar},      AtomType{"P", "P", 1.80, kPolar},
    AtomType{"S", "S", 2.00, kPolar},      AtomType{"SE", "Se", 1.90, kPolar},
    AtomType{"U_POL", "", 1.50, kPolar},  // N or O, which ASX and GLX leave open
};

constexpr std::array kOonsAtoms{
    TypedAtoms{"*",
               "C C_CAR, CA CB CM2 C_ALI, N N, O OXT O, P P, OP1 OP2 OP3 O5' O4' O3' O2' O, "
               "C5' C_ALI, C4' C3' C2' C1' C_ARO, N1 N2 N3 N4 N6 N7 N9 N, "
               "C2 C4 C5 C6 C7 C8 C_ARO, O2 O4 O6 O"},
    TypedAtoms{"ARG", "CG CD CZ C_ALI, NE NH1 NH2 N"},
    TypedAtoms{"ASN", "CG C_CAR, OD1 O, ND2 N"},
    TypedAtoms{"ASP", "CG C_CAR, OD1 OD2 O"},
    TypedAtoms{"CYS", "SG S"},
    TypedAtoms{"GLN", "CG C_ALI, CD C_CAR, OE1 O, NE2 N"},
    TypedAtoms{"GLU", "CG C_ALI, CD C_CAR, OE1 OE2 O"},
    TypedAtoms{"HIS", "CG CD2 CE1 C_ARO, ND1 NE2 N"},
    TypedAtoms{"ILE", "CG1 CG2 CD1 C_ALI"},
    TypedAtoms{"LEU", "CG CD1 CD2 C_ALI"},
    TypedAtoms{"LYS", "CG CD CE C_ALI, NZ N"},
    TypedAtoms{"MET", "CG CE C_ALI, SD S"},
    TypedAtoms{"PHE", "CG CD1 CD2 CE1 CE2 CZ C_ARO"},
    TypedAtoms{"PRO", "CB CG CD C_ARO"},
    TypedAtoms{"SER", "OG O"},
    TypedAtoms{"THR", "CG2 C_ALI, OG1 O"},
    TypedAtoms{"TRP", "CG CD1 CD2 CE2 CE3 CZ2 CZ3 CH2 C_ARO, NE1 N"},
    TypedAtoms{"TYR", "CG CD1 CD2 CE1 CE2 CZ C_ARO, OH O"},
    TypedAtoms{"VAL", "CG1 CG2 C_ALI"},
    TypedAtoms{"ASX", "CG C_CAR, XD1 XD2 AD1 AD2 U_POL"},
    TypedAtoms{"GLX", "CG C_ALI, CD C_CAR, XE1 XE2 AE1 AE2 U_POL"},
    TypedAtoms{"SEC CSE", "SE SE"},
    TypedAtoms{"MSE", "CG CE C_ALI, SE SE"},
    TypedAtoms{"PYL", "CG CD CE CB2 C_ALI, CA2 CG2 CD2 CE2 C_ARO, C2 C_CAR, NZ N2 N, O2 O"},
    TypedAtoms{"ACE", "CH3 C_ALI"},
    TypedAtoms{"NH2", "NH2 N"},
    TypedAtoms{"HOH", "O O"},
};

constexpr std::array kSets{
    UnitedSet{"protor", kProtOrTypes, kProtOrAtoms},
    UnitedSet{"naccess", kNaccessTypes, kNaccessAtoms},
    UnitedSet{"oons", kOonsTypes, kOonsAtoms},
};

}  // namespace

std::span<const UnitedSet> united_sets() { return kSets; }

}  // namespace vdwmesh
