"""Reads the report made for people and holds every number in it against the report's JSON.

Nothing here rounds as the program does: a printed number agrees with the document's where it is
within half a unit of its last digit. Each line must be of a kind known here, so that a line the
program adds is noticed."""

import collections
import re

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)")
NO_VALUE = "–"
SPACE_OF_ROUNDING = 1e-9  # relative: of what is computed here from the document's digits


def half_a_unit(token):
    mantissa, _, exponent = token.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - decimals)


def agrees(token, value):
    """Fails on NaN. A value that was not computed is a dash."""
    if value is None or token == NO_VALUE:
        return value is None and token == NO_VALUE
    slack = half_a_unit(token) + SPACE_OF_ROUNDING * abs(value)
    return abs(float(token) - value) <= slack


def differs_by(a, b):
    return abs(a - b) / abs(b) if b else abs(a - b)


def at(block, *keys):
    for key in keys:
        block = None if block is None else block[key]
    return block



TABLE = {
    "Area": ("area", "area"),
    "polar area": (None, "polar_area"),
    "apolar area": (None, "apolar_area"),
    "unclassified area": (None, "unclassified_area"),
    "Volume": ("volume", "volume"),
    "outer area": ("outer_area", "outer_area"),
    "area of voids": ("void_area", "void_area"),
    "Shells": ("shells", "shells"),
    "Components": ("components", "components"),
    "Tunnels (genus)": ("genus", "tunnels"),
    "Voids": ("voids", "voids"),
    "Euler characteristic": ("euler_characteristic", "euler_characteristic"),
}
RELATIVE = {"Area": "area_relative_error", "Volume": "volume_relative_error"}
QUALITY = {"Smallest angle": "min_angle_deg", "Aspect ratio": "aspect_ratio", "Edge length": "edge_length"}
DISTANCES = {"mesh to surface": "mesh_to_surface", "surface to mesh": "surface_to_mesh"}
HEADERS = (
    r"(mesh *)?(exact *)?(mesh - exact)?",
    r"Level +triangles +angle 1 % +median +edge +crossings",
    r"min +1 % +median +99 % +max",
    r"Distance +mean +rms +95 % +99 % +max",
)


class TextReport:
    def __init__(self, text, document):
        self.document = document
        self.problems = []
        self.seen = set()
        self.label = ""
        for line in text.splitlines():
            if line and not any(re.fullmatch(header, line.strip()) for header in HEADERS):
                self.check_line(line)

    def expect(self, line, tokens, values):
        if len(tokens) != len(values) or not all(map(agrees, tokens, values)):
            self.problems.append(f"{line!r}: printed {tokens}, the document has {values}")

    def expect_numbers(self, line, text, values):
        text = text.replace("2-manifold", "manifold")
        self.expect(line, NUMBER.findall(text), values)

    def check_line(self, line):
        name = next((n for n in (*TABLE, *QUALITY, *DISTANCES) if line.strip().startswith(n + "  ")), None)
        is_answer = name in RELATIVE and line[13] != " "  # where figures of tables do not begin
        if name and not is_answer:
            self.seen.add(name)
            return self.check_row(line, name)
        if re.match(r"\d+ {10}", line):
            self.seen.add("Level")
            return self.check_level(line)
        if line.startswith("Hausdorff"):
            self.seen.add("Hausdorff")
            comparison = self.document["comparison"]
            values = [comparison[k] for k in ("hausdorff_lower_bound", "samples", "seed")]
            return self.expect_numbers(line, line, values)
        if line.startswith("Bounds "):
            bounds = self.document["comparison"]["bounds"]
            values = [bounds[k]["upper"] for k in ("mesh_to_surface", "surface_to_mesh")]
            self.seen.add("Bounds")
            return self.expect_numbers(line, line, values)
        if line.startswith("  standard error "):
            return self.expect(line, line.split()[2:4], [self.distances[k] for k in ("mean_error", "rms_error")])
        label, text = line[:13].strip(), line[13:]
        self.label = label or self.label
        self.seen.add(self.label)
        check = getattr(self, "check_" + self.label.lower().split(" (")[0].replace(" ", "_"), None)
        if check is None:
            self.problems.append(f"{line!r}: is of no kind that is known")
        else:
            check(line, text)

    def check_row(self, line, name):
        doc, tokens = self.document, line.strip()[len(name):].split()
        if name in QUALITY:
            q = doc["mesh"][QUALITY[name]]
            return self.expect(line, tokens[:5], [q[k] for k in ("min", "p01", "median", "p99", "max")])
        if name in DISTANCES:
            self.distances = d = doc["comparison"][DISTANCES[name]]
            return self.expect(line, tokens[:5], [d[k] for k in ("mean", "rms", "p95", "p99", "max")])
        values = []
        if doc["mesh"] and TABLE[name][0]:
            values.append(at(doc, "mesh", TABLE[name][0]))
        if doc["exact"]:
            values.append(at(doc, "exact", TABLE[name][1]))
        if doc["comparison"]:
            if name in RELATIVE and doc["comparison"][RELATIVE[name]] is not None:
                values.append(100 * doc["comparison"][RELATIVE[name]])
            difference = doc["comparison"]["euler_characteristic_difference"]
            if name == "Euler characteristic" and difference is not None:
                values.append(difference)
        tokens = ["0" if t == "equal" else t for t in tokens if t not in ("%", "Å²", "Å³")]
        self.expect(line, tokens, values)

    def check_level(self, line):
        tokens = [NO_VALUE if t == "-" else t for t in line.split()]
        level = self.document["mesh"]["levels"][int(tokens[0])]
        angle = level["min_angle_deg"]
        self.expect(line, tokens, [level["level"], level["triangles"], angle["p01"], angle["median"],
                                   level["edge_length"]["median"], level["self_intersections"]])

    def check_structure(self, line, text):
        i = self.document["input"]
        part = "asymmetric unit" if i["assembly"] == "asymmetric" else "assembly " + i["assembly"]
        if text != f"{i['path']} ({i['format']}), model {i['model']}, {part}":
            self.problems.append(line)

    def check_atoms(self, line, text):
        """Those of all kinds are the used ones."""
        i = self.document["input"]
        kept, left_out = text.split("; left out: ")
        skipped = [count for count in i["skipped"].values() if count]
        self.expect_numbers(line, left_out, skipped)
        if " used of " in kept:
            return self.expect_numbers(line, kept, [i["atoms_used"], i["atoms_read"]])
        kinds = [int(part.split()[0]) for part in kept.split(", ")]
        if sum(kinds) != i["atoms_used"]:
            self.problems.append(line)

    def sizes(self, key, *exact):
        """Of the exact surface, then of the mesh, with how far it is off in percent."""
        doc = self.document
        values = [at(doc, "exact", k) for k in (key, *exact)] if doc["exact"] else []
        if at(doc, "mesh", key) is not None:
            values += [doc["mesh"][key]]
            error = at(doc, "comparison", key + "_relative_error")
            values += [] if error is None else [100 * error]
        return values

    def check_area(self, line, text):
        exact, extra = self.document["exact"], ()
        if at(exact, "polar_area") is not None:
            extra = ("polar_area", "apolar_area", *["unclassified_area"] * (exact["unclassified_area"] > 0))
        if at(exact, "voids"):
            extra = (*extra, "void_area")
        self.expect_numbers(line, text, self.sizes("area", *extra))

    def check_volume(self, line, text):
        self.expect_numbers(line, text, self.sizes("volume"))

    def check_topology(self, line, text):
        """In words, so none are 0; those of a mesh that is connected alike are not said again."""
        doc = self.document
        text = re.sub(r"\bno (tunnels|voids)", r"0 \1", text)
        shape = lambda block, keys: [block[k] for k in keys] if block else []
        values = shape(doc["exact"], ("components", "tunnels", "voids"))
        exact_known = bool(values) and None not in values
        if doc["exact"] and not exact_known:
            values = [doc["exact"][k] for k in ("components", "euler_characteristic") if doc["exact"][k] is not None]
        if doc["mesh"] and "mesh alike" not in text:
            keys = ("components", "genus", "voids")
            whole = None not in shape(doc["mesh"], keys)
            values += shape(doc["mesh"], keys if whole else ("shells", "euler_characteristic"))
        self.expect_numbers(line, text, values)
        if "mesh alike" in text and doc["comparison"]["euler_characteristic_difference"] != 0:
            self.problems.append(line)

    def check_distance(self, line, text):
        comparison = self.document["comparison"]
        self.expect_numbers(line, text, [comparison["mesh_to_surface"]["mean"], comparison["hausdorff_lower_bound"]])

    def check_radii(self, line, text):
        i = self.document["input"]
        by_element = [r for r in i["radii_assumed"] if r["residue"] is None and r["atom"] is None]
        assumed = [x for radius in by_element for x in (radius["radius"], radius["count"])]
        by_residue = collections.Counter()
        for radius in i["radii_assumed"]:
            if radius not in by_element:
                by_residue[radius["residue"]] += radius["count"]
        names = re.findall(r"(\S+) by element", text)
        if names != sorted(by_residue):
            self.problems.append(line)
        text = re.sub(r"\S+ by element", "by element", text)  # names may be numbers
        self.expect_numbers(line, text.split(",", 1)[1],
                            [i["probe"], *assumed, *(by_residue[name] for name in names)])

    def check_surface(self, line, text):
        p = self.document["parameters"]
        values = [p[k] for k in ("edge_length", "isovalue", "blobbiness") if p[k] is not None]
        self.expect_numbers(line, text, [*values, p["subdivide"]])
        for name in ("exact" if p["mesher"] == "exact" else p["field"],
                     "no projection" if p["subdivide"] and p["project"] == "none" else "",
                     "crossings allowed" if p["crossings"] == "allow" else ""):
            if name not in text:
                self.problems.append(f"{line!r}: does not say {name}")

    def check_grid(self, line, text):
        p = self.document["parameters"]
        self.expect_numbers(line, text, [p["spacing"], *p["grid"]["cells"], p["grid"]["cell_count"]])

    def check_backend(self, line, text):
        b = self.document["backend"]
        if not text.startswith(b["used"]):
            self.problems.append(line)
        threads = re.search(r"(\d+) CPU thread", text)[1]
        self.expect(line, [threads], [b["threads"]])

    def check_exact_union(self, line, text):
        e = self.document["exact"]
        if not line.startswith("Exact"):
            return self.expect_numbers(line, text, [e["certificate"][k] for k in ("wide_spheres", "bits")])
        values = [] if e["hidden_atoms"] is None else [e["hidden_atoms"], e["point_contacts"]]
        if e["check_area"] is not None and e["check_volume"] is not None:
            values += [differs_by(e["check_area"], e["area"]), differs_by(e["check_volume"], e["volume"])]
        if e["fallback_spheres"]:
            values.append(e["fallback_spheres"])
        self.expect_numbers(line, text, values)

    def check_certified(self, line, text):
        c = self.document["exact"]["certificate"]
        # A rounded end might not contain the value: every digit must be there.
        for name in ("area", "volume"):
            if text.startswith(name):
                ends = [float(token) for token in NUMBER.findall(text)]
                if ends != [c[name]["lower"], c[name]["upper"]]:
                    self.problems.append(line)
                return
        self.problems.append(line)

    def check_measured(self, line, text):
        i = self.document["input"]
        figures, selection = text.split(", those of ")
        self.expect_numbers(line, figures, [i["spheres_measured"], i["spheres"]])
        if not selection.startswith(i["measure"] + ";"):
            self.problems.append(line)

    def check_mesh(self, line, text):
        m = self.document["mesh"]
        size, _, *rest = text.split("; ")
        found = " ".join(part for part in rest if part.endswith("self-intersections"))
        file = [part for part in rest if not part.endswith("self-intersections")]
        self.expect_numbers(line, size, [m["vertices"], m["triangles"]])
        for name, word in (("closed", "closed"), ("manifold", "2-manifold"), ("oriented", "oriented")):
            if (f"NOT {word}" not in text) != m[name]:
                self.problems.append(line)
        self.expect_numbers(line, found, [m["self_intersections"]] if m["self_intersections"] is not None else [])
        if file != ([m["path"]] if m["path"] else []):
            self.problems.append(line)

    def check_counts(self, line, text):
        m = self.document["mesh"]
        if "CGAL" in text:
            return self.check_projection(line, text)
        values = [m["degenerate_triangles"]] + [m["clamped_vertices"]] * (m["clamped_vertices"] is not None)
        if m["arrangement"]:
            values += [m["arrangement"][k] for k in ("arcs", "pieces", "corners")]
        values += [m["grid_clipped"]] if m["grid_clipped"] is not None else []
        self.expect_numbers(line, text, values)

    def check_projection(self, line, text):
        m = self.document["mesh"]
        if "CGAL" in text:
            pairs = [(m["cgal"][key], m[key]) for key in ("area", "volume") if m["cgal"][key] is not None]
            return self.expect_numbers(line, text, [abs(a / b - 1) for a, b in pairs])
        n = m["newton"]
        self.expect_numbers(line, text, [n[k] for k in (
            "projected", "iterations_max", "residual_max", "unconverged", "out_of_reach", "undone", "turned")])

    def check_proof(self, line, text):
        m, proof = self.document["mesh"], self.document["comparison"]["proof"]
        for measure in ("area", "volume"):
            if text.startswith("extrapolated " + measure):
                return self.expect_numbers(
                    line, text, [m["extrapolated_" + measure], proof[f"extrapolated_{measure}_error"]])
        if text.startswith("area of an atom"):
            atoms = proof["atom_area_error"]
            if f"({atoms['worst']})" not in text:
                self.problems.append(line)
            return self.expect_numbers(line, text.replace(atoms["worst"], "").replace("1 Å²", ""),
                                       [100 * atoms["max"], 100 * atoms["rms"], atoms["atoms"]])
        if text.endswith(("below its floor, before subdivision", "below their floors, before subdivision")):
            return self.expect_numbers(line, text, [proof["below_floor"]])
        told = {True: "those of the union", False: "NOT that of the union", None: "not computed"}
        if told[proof["topology_is_exact"]] not in text:
            self.problems.append(line)

    def check_picture(self, line, text):
        p = self.document["picture"]
        if line.startswith("Picture"):
            numbers = NUMBER.findall(text.replace(p["path"], ""))
            return self.expect(line, numbers[:2], [p["width"], p["height"]])
        self.expect_numbers(line, text.rsplit(" from ", 1)[1], [p["scale"]["lower"], p["scale"]["upper"]])

    def check_drawn_by(self, line, text):
        if not text.startswith(self.document["picture"]["device"]):
            self.problems.append(line)

    def check_note(self, line, text):
        if text not in (*self.document["notes"], *(at(self.document, "mesh", "notes") or ())):
            self.problems.append(line)

    def check_warning(self, line, text):
        if text not in self.document["warnings"]:
            self.problems.append(line)

    def check_time(self, line, text):
        self.check_seconds(line, text, {k: v for k, v in self.document["timing"].items() if k != "cpu"})

    def check_cpu(self, line, text):
        self.check_seconds(line, text, self.document["timing"]["cpu"])

    def check_seconds(self, line, text, stages):
        timing = {key.replace("_", " "): value for key, value in stages.items() if value is not None}
        printed = dict(part.rsplit(" ", 1) for part in text.split(", "))
        if set(printed) != set(timing):
            self.problems.append(f"{line!r}: the document has {timing}")
        self.expect(line, [printed[k] for k in printed], [timing.get(k) for k in printed])
