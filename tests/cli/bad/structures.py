"""Damaged structure files: PDB, mmCIF, PQR and XYZR, plain and gzipped."""

import gzip
import zlib

from .case import Expect, Maker

REFUSED, READ, SAME = Expect.REFUSED, Expect.READ, Expect.SAME
EITHER, DOUBTED = Expect.EITHER, Expect.DOUBTED

ATOMS = 60
NUMBERS_THAT_ARE_NONE = ("nan", "inf", "-inf", "1e999", "********", "", "abc", "0x1F", "1,5", "--1")
FORMATS = {"pdb": "pdb", "ent": "pdb", "cif": "cif", "mmcif": "cif", "pqr": "pqr", "xyzr": "xyzr"}
CIF_COLUMNS = (
    "group_PDB id type_symbol label_atom_id label_alt_id label_comp_id label_asym_id "
    "auth_seq_id Cartn_x Cartn_y Cartn_z occupancy B_iso_or_equiv pdbx_PDB_model_num"
).split()


class Sample:
    """The first atoms of a protein, as rows of each format."""

    def __init__(self, pdb_text):
        self.pdb = [line for line in pdb_text.splitlines() if line.startswith("ATOM")][:ATOMS]
        self.rows = {kind: [getattr(self, "_" + kind)(line) for line in self.pdb] for kind in
                     ("pdb", "cif", "pqr", "xyzr")}

    @staticmethod
    def _pdb(line):
        return line

    @staticmethod
    def _fields(line):
        return dict(
            serial=line[6:11].strip(), name=line[12:16].strip(), residue=line[17:20].strip(),
            chain=line[21], number=line[22:26].strip(), element=line[76:78].strip() or line[13],
            x=line[30:38].strip(), y=line[38:46].strip(), z=line[46:54].strip())

    def _cif(self, line):
        return ("ATOM {serial} {element} {name} . {residue} {chain} {number} {x} {y} {z} "
                "1.00 20.00 1").format(**self._fields(line))

    def _pqr(self, line):
        return "ATOM {serial} {name} {residue} {chain} {number} {x} {y} {z} 0.1 1.5".format(
            **self._fields(line))

    def _xyzr(self, line):
        return "{x} {y} {z} 1.5".format(**self._fields(line))

    def text(self, kind, rows=None):
        lines = [*HEAD[kind], *(self.rows[kind] if rows is None else rows), *FOOT[kind]]
        return "\n".join(lines) + "\n"


HEAD = {
    "pdb": ["HEADER    A SAMPLE", "REMARK   1 MADE FOR A TEST"],
    "cif": ["data_sample", "#", "loop_", *("_atom_site." + column for column in CIF_COLUMNS)],
    "pqr": ["REMARK   1 MADE FOR A TEST"],
    "xyzr": ["# made for a test"],
}
FOOT = {"pdb": ["TER", "END"], "cif": ["#"], "pqr": ["TER", "END"], "xyzr": []}


def with_x(kind, row, x):
    """The row with another x coordinate."""
    if kind == "pdb":
        return row[:30] + x.rjust(8) + row[38:]
    fields = row.split()
    fields[{"cif": 8, "pqr": 6, "xyzr": 0}[kind]] = x or ("''" if kind == "cif" else "")
    return " ".join(fields)


def replaced(rows, index, row):
    return [*rows[:index], *([row] if row is not None else []), *rows[index + 1:]]


def same_meaning(make, text):
    make.add("as it should be", text, SAME, ATOMS)
    make.add("line ends CR LF", text.replace("\n", "\r\n"), SAME, ATOMS)
    make.add("line ends CR", text.replace("\n", "\r"), SAME, ATOMS)
    make.add("byte-order mark of UTF-8", b"\xef\xbb\xbf" + text.encode(), SAME, ATOMS)
    make.add("blank lines between all lines", text.replace("\n", "\n\n"), SAME, ATOMS)
    make.add("no line break at the end", text.rstrip("\n"), SAME, ATOMS)


def not_a_structure(make, text, sample, kind):
    dice = make.dice("noise")
    make.add("empty", b"", REFUSED)
    make.add("a megabyte of blanks", " " * 2**20, REFUSED)
    make.add("a megabyte of line breaks", "\n" * 2**20, REFUSED)
    make.add("random bytes", dice.randbytes(5000), REFUSED)
    make.add("random letters", "".join(dice.choices("ABCDEFG xyz.123\n", k=5000)), REFUSED)
    make.add("zero bytes", bytes(5000), REFUSED)
    make.add("a zero byte inside", text[:2000] + "\0" + text[2000:], REFUSED)
    make.add("UTF-16", text.encode("utf-16"), REFUSED)
    make.add("a web page", "<!DOCTYPE html><html><body>404 Not Found</body></html>\n", REFUSED)
    make.add("JSON", '{"error": "no such entry"}\n', REFUSED)
    make.add("a zip archive", b"PK\x03\x04" + dice.randbytes(500), REFUSED)
    for other in sample.rows:
        if other != kind:
            make.add(f"holds {other.upper()}", sample.text(other), REFUSED)
    make.add("no atoms", "\n".join([*HEAD[kind], *FOOT[kind]]) + "\n", REFUSED)


def count_atoms(kind, text):
    if kind == "xyzr":
        return sum(1 for line in text.splitlines() if line and not line.startswith("#"))
    return sum(1 for line in text.splitlines() if line.startswith("ATOM"))


def cut(make, text, kind, last_row):
    for part in (3, 2):
        whole_lines = text[: text.index("\n", len(text) * part // 4) + 1]
        make.add(f"cut after a line at {part}/4", whole_lines, READ, count_atoms(kind, whole_lines))
    end = text.rindex(last_row) + len(last_row)
    for back in (2, 12, 30):
        make.add("cut inside a line", text[: end - back], DOUBTED)
    make.add("cut inside the first atom", text[: text.index(first_atom(text)) + 9], REFUSED)


def first_atom(text):
    lines = text.split("\n")
    return next(line for line in lines if line[:4] == "ATOM" or line[:1].isdigit() or
                line.startswith("-"))


def bad_numbers(make, sample, kind):
    rows = sample.rows[kind]
    for number in NUMBERS_THAT_ARE_NONE:
        if number == "" and kind != "pdb" and kind != "cif":
            continue
        label = f"x of an atom is '{number}'"
        make.add(label, sample.text(kind, replaced(rows, 30, with_x(kind, rows[30], number))),
                 REFUSED)
    for number in ("1e30", "-9e307"):
        make.add(f"x of an atom is {number}",
                 sample.text(kind, replaced(rows, 30, with_x(kind, rows[30], number))), REFUSED)
    everywhere = [with_x(kind, row, "1e30") for row in rows]
    make.add("x of all atoms is 1e30", sample.text(kind, everywhere), REFUSED)


def repeated(make, sample, kind):
    rows = sample.rows[kind]
    make.add("every atom twice", sample.text(kind, [row for row in rows for _ in range(2)]), SAME,
             2 * ATOMS)
    make.add("one atom 500 times", sample.text(kind, rows[:1] * 500), READ, 500)


def radii(make, sample, kind):
    rows = sample.rows[kind]
    for radius in ("-1.5", "nan", "inf", "1e30", "****", "abc"):
        row = " ".join([*rows[30].split()[:-1], radius])
        make.add(f"radius of an atom is '{radius}'", sample.text(kind, replaced(rows, 30, row)),
                 REFUSED)
    row = " ".join([*rows[30].split()[:-1], "0"])
    make.add("radius of an atom is 0", sample.text(kind, replaced(rows, 30, row)), READ, ATOMS)
    row = " ".join(rows[30].split()[:-1])
    make.add("an atom without its radius", sample.text(kind, replaced(rows, 30, row)), REFUSED)
    all_zero = [" ".join([*row.split()[:-1], "0"]) for row in rows]
    make.add("all radii are 0", sample.text(kind, all_zero), REFUSED)


def letters(make, sample, kind):
    text = sample.text(kind)
    note = {"pdb": "REMARK   2 Å, naïve, 蛋白质", "cif": "# Å, naïve, 蛋白质",
            "pqr": "REMARK   2 Å, naïve, 蛋白质", "xyzr": "# Å, naïve, 蛋白质"}[kind]
    lines = text.split("\n")
    make.add("non-ASCII letters in a remark", "\n".join([lines[0], note, *lines[1:]]), SAME, ATOMS)
    latin = "\n".join([lines[0], note.split(", 蛋")[0], *lines[1:]]).encode("latin-1")
    make.add("Latin-1 letters in a remark", latin, SAME, ATOMS)
    long_note = note[:1] if kind in ("cif", "xyzr") else "REMARK   2 "
    make.add("a remark of a megabyte", "\n".join([lines[0], long_note + "x" * 2**20, *lines[1:]]),
             SAME, ATOMS)


def pdb_columns(make, sample):
    rows = sample.rows["pdb"]
    row = rows[30]

    def one(damage, line, expect, items=None):
        make.add(damage, sample.text("pdb", replaced(rows, 30, line)), expect, items)

    one("a line shifted right by 1", " " + row, REFUSED)
    one("coordinates shifted right by 1", row[:30] + " " + row[30:], REFUSED)
    one("coordinates shifted right by 4", row[:30] + "    " + row[30:], REFUSED)
    one("coordinates shifted left by 4", row[:26] + row[30:], REFUSED)
    make.add("all lines shifted right by 1", sample.text("pdb", [" " + line for line in rows]),
             REFUSED)
    one("a coordinate that overflows its columns", row[:30] + "12345.678" + row[38:], REFUSED)
    one("blanks turned into tabs", "\t".join(row.split()), REFUSED)
    one("a record of 20 columns", row[:20], REFUSED)
    one("an unknown element", row[:12] + " J? " + row[16:76] + "J?" + row[78:], REFUSED)
    one("serial and residue numbers that are none", row[:6] + "*****" + row[11:22] + "****" +
        row[26:], EITHER, ATOMS)
    one("occupancy and B that are none", row[:54] + "************" + row[66:], EITHER, ATOMS)
    make.add("columns end after z", sample.text("pdb", [line[:54] for line in rows]), SAME, ATOMS)
    make.add("lower case", sample.text("pdb").lower(), EITHER, ATOMS)


def many_models(make, sample, kind):
    rows = sample.rows[kind][:3]
    if kind == "cif":
        model_rows = [row[: -1] + str(m) for m in range(1, 3001) for row in rows]
        make.add("3,000 models", sample.text(kind, model_rows), READ, 9000)
        return

    def models(count):
        body = "".join(f"MODEL     {m:4}\n" + "\n".join(rows) + "\nENDMDL\n"
                       for m in range(1, count + 1))
        return body + "END\n"

    make.add("3,000 models", models(3000), READ, 9000)
    if kind == "pdb":
        make.add("10,000 models", models(10_000), REFUSED)
    unclosed = "".join(f"MODEL     {m:4}\n" + "\n".join(rows) + "\n" for m in range(1, 4))
    make.add("models without end", unclosed, READ, 9)
    make.add("models of one number", models(3).replace("MODEL        2", "MODEL        1"), READ, 9)


def cif_syntax(make, sample):
    text, rows = sample.text("cif"), sample.rows["cif"]
    make.add("a row lacks a value",
             sample.text("cif", replaced(rows, 30, rows[30].rsplit(" ", 1)[0])), REFUSED)
    make.add("a row has a value too many", sample.text("cif", replaced(rows, 30, rows[30] + " 1")),
             REFUSED)
    make.add("a quote without end", text.replace(" CA ", " 'CA ", 1), REFUSED)
    make.add("a text field without end", text.replace("#\nloop_", "_title\n;no end\nloop_"), REFUSED)
    make.add("two blocks with atoms", text + text.replace("sample", "second"), REFUSED)
    make.add("a column twice", text.replace("_atom_site.Cartn_y", "_atom_site.Cartn_x"), REFUSED)
    for column in ("Cartn_z", "label_asym_id"):
        make.add(f"without the column {column}", text.replace(f"site.{column}\n", f"site.{column}_\n"),
                 REFUSED)
    make.add("without the column type_symbol",  # elements are told from names
             text.replace("site.type_symbol\n", "site.type_symbol_\n"), READ, ATOMS)
    make.add("no data_ line", text.replace("data_sample\n", ""), REFUSED)
    make.add("x of an atom is '?'", sample.text("cif", replaced(rows, 30, with_x("cif", rows[30], "?"))),
             REFUSED)
    make.add("x of an atom is '1.5(3)'",
             sample.text("cif", replaced(rows, 30, with_x("cif", rows[30], "1.5(3)"))), READ, ATOMS)


def pqr_fields(make, sample):
    rows = sample.rows["pqr"]
    make.add("a line shifted right by 1", sample.text("pqr", [" " + row for row in rows]), SAME, ATOMS)
    make.add("blanks turned into tabs", sample.text("pqr", [row.replace(" ", "\t") for row in rows]),
             SAME, ATOMS)
    make.add("a field too many", sample.text("pqr", replaced(rows, 30, rows[30] + " 7")), EITHER, ATOMS)


def damages(extension, sample):
    kind, make = FORMATS[extension], Maker(extension)
    text = sample.text(kind)
    same_meaning(make, text)
    not_a_structure(make, text, sample, kind)
    cut(make, text, kind, sample.rows[kind][-1])
    bad_numbers(make, sample, kind)
    repeated(make, sample, kind)
    letters(make, sample, kind)
    if kind in ("pqr", "xyzr"):
        radii(make, sample, kind)
    if kind != "xyzr":
        many_models(make, sample, kind)
    if kind == "pdb":
        pdb_columns(make, sample)
    elif kind == "cif":
        cif_syntax(make, sample)
    elif kind == "pqr":
        pqr_fields(make, sample)
    return make.cases


def packed(data):
    return gzip.compress(data, mtime=0)


def bomb(head):
    """A gibibyte of blanks behind `head`, in a megabyte."""
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    blanks = b" " * 2**20
    return packer.compress(head) + b"".join(packer.compress(blanks) for _ in range(1024)) + packer.flush()


def packed_damages(extension, sample):
    make = Maker(extension + ".gz")
    text = sample.text(FORMATS[extension]).encode()
    whole, dice = packed(text), make.dice("bits")
    flipped, crc = bytearray(whole), bytearray(whole)
    flipped[len(whole) // 2] ^= 1 << dice.randrange(8)
    crc[-6] ^= 0xFF
    make.add("as it should be", whole, SAME, ATOMS)
    make.add("not packed", text, SAME, ATOMS)
    make.add("two members", packed(text[:900]) + packed(text[900:]), SAME, ATOMS)
    make.add("zeros after the last member", whole + bytes(512), SAME, ATOMS)
    make.add("empty", b"", REFUSED)
    make.add("an empty file packed", packed(b""), REFUSED)
    make.add("cut in the middle", whole[: len(whole) // 2], REFUSED)
    make.add("cut in its header", whole[:5], REFUSED)
    make.add("cut in its checksum", whole[:-3], REFUSED)
    make.add("a bit flipped", bytes(flipped), REFUSED)
    make.add("a wrong checksum", bytes(crc), REFUSED)
    make.add("something after the last member", whole + b"and more", REFUSED)
    make.add("packed twice", packed(whole), REFUSED)
    make.add("random bytes packed", packed(dice.randbytes(5000)), REFUSED)
    return make.cases
