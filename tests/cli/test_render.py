"""Pictures as files: what they hold, and when they are refused."""

import math
import os
import struct
import tempfile
import unittest
import zlib

from program import BAD_INPUT, LIMIT_HIT, NO_BACKEND, SANITIZED, ProgramTest, missing, parse_json, run
from text_report import TextReport

SMALL = ("--size", "320x240", "--subdivide", "0")


def decode_png(path):
    """Width, height, and rows of pixels as tuples; 8 bits per channel, RGB or RGBA."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    position, compressed = 8, b""
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position : position + 8])
        body = data[position + 8 : position + 8 + length]
        checksum = struct.unpack(">I", data[position + 8 + length : position + 12 + length])[0]
        assert zlib.crc32(kind + body) == checksum
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            assert depth == 8
        if kind == b"IDAT":
            compressed += body
        position += 12 + length
    channels = {2: 3, 6: 4}[color]
    return width, height, unfilter(zlib.decompress(compressed), width, height, channels)


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def unfilter(raw, width, height, channels):
    """The five filters of the PNG specification, section 9."""
    stride, rows, above = width * channels, [], bytearray(width * channels)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        line = bytearray(raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            a = line[i - channels] if i >= channels else 0
            c = above[i - channels] if i >= channels else 0
            b = above[i]
            add = (0, a, b, (a + b) // 2, paeth(a, b, c))[kind]
            line[i] = (line[i] + add) & 255
        rows.append([tuple(line[i : i + channels]) for i in range(0, stride, channels)])
        above = line
    return rows


class PictureTest(ProgramTest):
    @classmethod
    def setUpClass(cls):
        """Skips where nothing can be drawn; fails there with VDWMESH_REQUIRE_EGL=1."""
        super().setUpClass()
        with tempfile.TemporaryDirectory() as folder:
            result = run("render", f"{folder}/missing.off", "-o", f"{folder}/out.png")
        if result.returncode == NO_BACKEND:
            missing("VDWMESH_REQUIRE_EGL", result.stderr)

    def picture(self, *arguments):
        path = self.folder / "picture.png"
        self.run_ok(*arguments, "-o", path)
        return decode_png(path)


class Render(PictureTest):
    def test_of_a_sample(self):
        width, height, rows = self.picture("render", "--sample", "bpti", *SMALL)
        self.assertEqual((width, height), (320, 240))
        self.assertEqual(rows[0][0], (255, 255, 255))
        colors = {pixel for row in rows for pixel in row}
        self.assertTrue(any(r > 150 and g < 60 and b < 60 for r, g, b in colors), "no oxygen red")
        self.assertTrue(any(b > 150 and r < 80 for r, g, b in colors), "no nitrogen blue")
        self.assertFalse(any(max(pixel) < 20 for pixel in colors), "black pixels")

    def test_fills_the_picture_from_every_side(self):
        views = ("front", "back", "left", "right", "top", "bottom", "x", "-y", "z", "1,2,3")
        for view in views[::5] if SANITIZED else views:
            with self.subTest(view=view):
                options = ("--background", "transparent", "--view", view, "--antialias", "1")
                width, height, rows = self.picture("render", "--sample", "bpti", *SMALL, *options)
                inside = [(x, y) for y, row in enumerate(rows) for x, p in enumerate(row) if p[3]]
                # 4 % of margin on the tighter pair of sides.
                xs, ys = [x for x, _ in inside], [y for _, y in inside]
                borders = (min(xs) / width, min(ys) / height)
                self.assertAlmostEqual(min(borders), 0.04, delta=1.5 / height)
                self.assertAlmostEqual((min(xs) + max(xs) + 1) / 2, width / 2, delta=2)
                self.assertAlmostEqual((min(ys) + max(ys) + 1) / 2, height / 2, delta=2)

    def test_the_same_picture_twice_is_the_same_file(self):
        first, second = self.folder / "1.png", self.folder / "2.png"
        for look in ((), ("--transparency", "0.4", "--outline", "--ambient-occlusion")):
            for path, threads in ((first, "1"), (second, "2")):
                self.run_ok("render", "--sample", "bpti", *SMALL, *look, "--threads", threads, "-o", path)
            self.assertEqual(first.read_bytes(), second.read_bytes())

    def test_options_change_the_picture(self):
        pictures = set()
        for options in (
            (),
            ("--camera", "perspective"),
            ("--shading", "gouraud"),
            ("--color", "distance"),
            ("--color", "angle"),
            ("--color", "angle", "--color-map", "cividis"),
            ("--color", "distance", "--color-range=-1,1"),
            ("--color", "#4080c0"),
            ("--background", "black"),
            ("--transparency", "50%"),
            ("--outline",),
            ("--ambient-occlusion",),
        ):
            path = self.folder / "picture.png"
            self.run_ok("render", "--sample", "bpti", *SMALL, *options, "-o", path)
            pictures.add(path.read_bytes())
        self.assertEqual(len(pictures), 12)

    def two_residues(self, first, second):
        """Two balls side by side along x: chains A and B of one residue each."""
        line = "ATOM      {0}  CA  {1} {2}   1    {3:8.3f}   0.000   0.000  1.00  0.00           C\n"
        return self.file("two.pdb", line.format(1, first, "A", 0) + line.format(2, second, "B", 5))

    def halves(self, path, *options):
        """The mean colour of the picture's left and right half without the background: A and B, as the camera looks along -z."""
        _, _, rows = self.picture("render", path, *SMALL, "--view", "z", *options)
        means = []
        for part in (slice(0, 120), slice(200, 320)):  # the bar of a scale is below
            pixels = [p for row in rows[:180] for p in row[part] if max(p) - min(p) > 20]
            self.assertGreater(len(pixels), 500, "no coloured ball")
            means.append([sum(p[k] for p in pixels) / len(pixels) for k in range(3)])
        return means

    def test_colors_of_atoms(self):
        path = self.two_residues("ILE", "ARG")
        (red, green, blue), (red_b, green_b, blue_b) = self.halves(path, "--color", "chain")
        self.assertTrue(blue > green > red and red_b > green_b > blue_b, "sky blue, then orange")
        told = self.run_ok("render", path, "-o", self.folder / "p.png", "--color", "chain").stdout
        self.assertIn("colours: A #56b4e9, B #e69f00", told)
        told = self.run_ok("render", path, "-o", self.folder / "p.png", "--color", "residue").stdout
        self.assertIn("colours: hydrophobic #e1aa50, basic #5078dc", told)
        (red, _, blue), (red_b, _, blue_b) = self.halves(path, "--color", "residue")
        self.assertTrue(red > blue and red_b < blue_b, "hydrophobic, then basic")
        (red, _, blue), (red_b, _, blue_b) = self.halves(path, "--color", "hydropathy")
        self.assertTrue(red > blue and red_b < blue_b, "from +4.5 to -4.5 in cool-warm")
        for surface in ((), ("--surface", "ses")):
            (red, _, blue), (red_b, _, blue_b) = self.halves(path, "--color", "chain", *surface)
            self.assertTrue(red < blue and red_b > blue_b)

    def test_exposure(self):
        """The scale is yellow where a residue stands alone, and without references there is none."""
        self.assert_refused(BAD_INPUT, "render", "--sample", "bpti", "-o", self.folder / "p.png", "--color", "exposure",
                            says=("--radii protor",))  # fmt: skip
        alone = self.two_residues("LEU", "LEU")
        # One atom has more than a tenth of the whole residue's area.
        for upper, is_yellow in ((10, True), (1000, False)):
            for red, _, blue in self.halves(alone, "--color", "exposure", "--radii", "protor", f"--color-range=0,{upper}"):
                self.assertEqual(red > blue, is_yellow)

    def test_of_a_mesh_file(self):
        mesh = self.folder / "mesh.stl"
        self.run_ok("mesh", "--sample", "bpti", "-o", mesh)
        plain = ("--color", "#ffffff", "--background", "black")
        from_file = self.picture("render", mesh, *SMALL[:2], *plain)[2]
        direct = self.picture("render", "--sample", "bpti", *SMALL, *plain)[2]
        # STL has no normals: only the outlines are the same.
        outline = [[pixel != (0, 0, 0) for pixel in row] for row in from_file]
        differing = sum(
            a != (b != (0, 0, 0)) for r, s in zip(outline, direct) for a, b in zip(r, s)
        )
        self.assertLessEqual(differing, 0.001 * 320 * 240)

    def test_quiet(self):
        path = self.folder / "picture.png"
        result = self.run_ok("render", "--sample", "bpti", *SMALL, "--quiet", "-o", path)
        self.assertEqual(result.stdout + result.stderr, "")


# Six atoms on the axes, farthest along x and nearest along z: their places in Å and the colours of
# their elements (Jmol's). Each hides none of the others in a view along an axis but its opposite.
SIX = {"O": ((6, 0, 0), (255, 13, 13)), "N": ((-6, 0, 0), (48, 80, 248)),
       "S": ((0, 4.5, 0), (255, 255, 48)), "CL": ((0, -4.5, 0), (31, 240, 31)),
       "I": ((0, 0, 2.5), (148, 0, 148)), "C": ((0, 0, -2.5), (144, 144, 144))}  # fmt: skip
OPPOSITE = {"O": "N", "N": "O", "S": "CL", "CL": "S", "I": "C", "C": "I"}
SIDES = ("middle", "left", "right", "top", "bottom")


def linear(pixel):
    return [(c / 255 / 12.92 if c <= 10 else ((c / 255 + 0.055) / 1.055) ** 2.4) for c in pixel]


def element_of(pixel):
    """The element whose colour it is, however much light falls on it."""
    def cosine(a, b):
        return sum(x * y for x, y in zip(a, b)) / math.hypot(*a) / math.hypot(*b)

    return max(SIX, key=lambda e: cosine(linear(pixel[:3]), linear(SIX[e][1])))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def element_along(direction):
    return next(e for e, (place, _) in SIX.items() if sum(a * b for a, b in zip(place, direction)) > 1)


class Views(PictureTest):
    """From where a picture is drawn, told by which atoms are in the middle and at its edges."""

    def setUp(self):
        super().setUp()
        line = "HETATM{0:5} {1:>2}   LIG A{0:4}    {2:8.3f}{3:8.3f}{4:8.3f}  1.00  0.00          {1:>2}\n"
        atoms = (line.format(i, e, *place) for i, (e, (place, _)) in enumerate(SIX.items(), 1))
        self.six = self.file("six.pdb", "".join(atoms) + "END\n")

    def seen(self, view):
        options = ("--view", view, "--size", "160x120", "--subdivide", "0", "--antialias", "1",
                   "--background", "transparent")  # fmt: skip
        width, height, rows = self.picture("render", self.six, *options)
        across = [(x, height // 2) for x in range(width) if rows[height // 2][x][3]]
        down = [(width // 2, y) for y in range(height) if rows[y][width // 2][3]]
        inside = 4  # pixels from the outline, where the light no longer grazes
        places = ((width // 2, height // 2), across[inside], across[-inside], down[inside], down[-inside])
        return dict(zip(SIDES, (element_of(rows[y][x]) for x, y in places)))

    def test_along_the_axes_of_the_file(self):
        for axis, toward in {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}.items():
            up = (0, 1, 0) if axis == "z" else (0, 0, 1)
            for sign, name in ((1, axis), (-1, "-" + axis)):
                viewer = tuple(sign * c for c in toward)
                right = element_along(cross(up, viewer))
                top = element_along(up)
                expected = (element_along(viewer), OPPOSITE[right], right, top, OPPOSITE[top])
                with self.subTest(view=name):
                    self.assertEqual(self.seen(name), dict(zip(SIDES, expected)))
                    self.assertEqual(self.seen(",".join(map(str, viewer))), dict(zip(SIDES, expected)))

    def test_sides_of_the_box(self):
        """Which end of an axis is the front is the program's choice; how the sides fit is not."""
        front = self.seen("front")
        self.assertEqual({front["left"], front["right"]}, {"O", "N"})  # the broadest side
        self.assertEqual({front["top"], front["bottom"]}, {"S", "CL"})
        middle, left, right, top, bottom = (front[side] for side in SIDES)
        behind = OPPOSITE[middle]
        for view, expected in {
            "back": (behind, right, left, top, bottom),
            "right": (right, middle, behind, top, bottom),
            "left": (left, behind, middle, top, bottom),
            "top": (top, left, right, behind, middle),
            "bottom": (bottom, left, right, middle, behind),
        }.items():
            with self.subTest(view=view):
                self.assertEqual(self.seen(view), dict(zip(SIDES, expected)))


class Meanings(PictureTest):
    """What the options of style say is what the picture shows."""

    def ball(self, name, radius):
        return self.file(name, f"0 0 0 {radius}\n")

    def pixels(self, *arguments):
        return [pixel for row in self.picture("render", *arguments)[2] for pixel in row]

    def test_perspective_makes_the_nearer_ball_larger(self):
        atom = "HETATM    {0}  {1}   LIG A   {0}    {2:8.3f}   0.000{3:8.3f}  1.00  0.00           {1}\n"
        pair = self.file("pair.pdb", atom.format(1, "O", -4, 6) + atom.format(2, "O", 4, -6))
        size = ("--size", "160x120", "--subdivide", "0", "--view", "z", "--background", "transparent")
        share = {}
        for camera in ("orthographic", "perspective"):
            width, _, rows = self.picture("render", pair, *size, "--camera", camera)
            left = sum(p[3] > 0 for row in rows for p in row[: width // 2])
            share[camera] = left / sum(p[3] > 0 for row in rows for p in row)
        self.assertAlmostEqual(share["orthographic"], 0.5, delta=0.02)
        self.assertGreater(share["perspective"], 0.6)

    def test_antialiasing_takes_so_many_samples(self):
        ball = self.ball("a.xyzr", 2)
        size = ("--size", "80x60", "--background", "transparent")
        for samples in (1, 2, 4):
            alphas = {p[3] for p in self.pixels(ball, *size, "--antialias", samples)}
            steps = {round(255 * k / samples**2) for k in range(samples**2 + 1)}
            self.assertLessEqual(alphas, steps)
            self.assertEqual(len(alphas) > 2, samples > 1)

    def test_background_and_plain_colours(self):
        ball = self.ball("a.xyzr", 2)
        size = ("--size", "80x60", "--color", "#ff0000")
        for background, corner in (("black", (0, 0, 0)), ("grey", (128, 128, 128)), ("#123456", (0x12, 0x34, 0x56))):
            rows = self.picture("render", ball, *size, "--background", background)[2]
            self.assertLessEqual(max(abs(a - b) for a, b in zip(rows[0][0], corner)), 1)
            red, green, blue = rows[30][40]
            self.assertTrue(red > 100 and green == blue < red / 2, rows[30][40])

    def test_transparency_is_what_two_layers_let_through(self):
        """A ball has a front and a back. Without a background, alpha says what they keep back together."""
        ball = self.ball("a.xyzr", 2)
        size = ("--size", "80x60", "--background", "transparent")
        for words in ("0.5", "50%", "0.9", "0", "0.000001"):
            share = float(words[:-1]) / 100 if words.endswith("%") else float(words)
            for shading in ("pixel", "gouraud"):
                rows = self.picture("render", ball, *size, "--transparency", words, "--shading", shading)[2]
                alpha = rows[30][40][3] if len(rows[30][40]) == 4 else 255
                self.assertAlmostEqual(alpha, 255 * (1 - share**2), delta=0.51)
        for words in ("1", "2", "100%", "-0.1", "half"):
            self.assert_refused(BAD_INPUT, "render", ball, "-o", self.folder / "p.png", "--transparency", words,
                                says=("--transparency",))  # fmt: skip

    def test_outline_is_around_the_ball_and_nowhere_else(self):
        """Black on white and white on black, as a ring at the border of the disc."""
        ball = self.ball("a.xyzr", 2)
        size = ("--size", "300x300", "--color", "#80c0ff", "--antialias", "1")
        for background, ink in (("white", (0, 0, 0)), ("black", (255, 255, 255))):
            row = self.picture("render", ball, *size, "--background", background, "--outline")[2][150]
            inked = {x for x, pixel in enumerate(row) if pixel == ink}
            sides = {x // 150 for x in inked}
            self.assertEqual(sides, {0, 1}, inked)  # 4 % of 300 is 12; the ball itself falls off steeply there
            self.assertTrue(all(11 <= x <= 14 or 285 <= x <= 288 for x in inked), inked)

    def test_ambient_occlusion_darkens_a_hole(self):
        """Two balls that touch, seen from the side: their crease is dark, unlike with light from one side alone."""
        pair = self.file("pair.xyzr", "0 0 0 2\n3.9 0 0 2\n")
        look = ("--size", "200x120", "--view", "z", "--color", "white", "--background", "#000001")
        level = {}
        for light in ((), ("--ambient-occlusion",)):
            rows = self.picture("render", pair, *look, *light)[2]
            level[light] = sum(rows[60][100]) / sum(rows[60][60])  # the crease, and the middle of a ball
        self.assertLess(level[("--ambient-occlusion",)], 0.8 * level[()])

    def test_gouraud_lights_the_vertices_alone(self):
        """Between the vertices of a coarse ball the highlight is missed."""
        ball = self.ball("a.xyzr", 2)
        size = ("--size", "160x120", "--spacing", "1.2", "--subdivide", "0", "--color", "grey",
                "--background", "black")  # fmt: skip
        brightest = {s: max(map(sum, self.pixels(ball, *size, "--shading", s))) for s in ("pixel", "gouraud")}
        self.assertGreater(brightest["pixel"], brightest["gouraud"])

    def test_color_maps_show_their_ends_in_the_bar(self):
        """First and last colour as published: viridis and cividis, and Moreland's cool and warm."""
        ball = self.ball("a.xyzr", 2)
        for name, ends in {"viridis": ((68, 1, 84), (253, 231, 37)), "cividis": ((0, 34, 78), (254, 232, 56)),
                           "cool-warm": ((59, 76, 192), (180, 4, 38))}.items():  # fmt: skip
            seen = set(self.pixels(ball, "--size", "320x240", "--color", "angle", "--color-map", name))
            for end in ends:
                nearest = min(max(abs(a - b) for a, b in zip(end, pixel)) for pixel in seen)
                self.assertLessEqual(nearest, 4, (name, end))

    def test_b_factors_of_atoms(self):
        """Three balls side by side: with no B factor, half of the largest and the largest one, from one end of viridis to the
        other. Light makes colours brighter or darker, so their shares are compared."""
        record = "HETATM{0:5}  C   LIG A{0:4}    {1:8.3f}   0.000   0.000  1.00{2:6.2f}           C\n"
        viridis = {0: (68, 1, 84), 40: (33, 145, 140), 80: (253, 231, 37)}  # as published, of 0, 0.5 and 1
        path = self.file("b.pdb", "".join(record.format(i, 5.0 * i, b) for i, b in enumerate(viridis, 1)) + "END\n")
        look = ("--view", "-y", "--size", "480x240", "--color", "b-factor")
        for surface in ("vdw", "ses"):
            rows = self.picture("render", path, *look, "--surface", surface, "--probe", "0.5" if surface == "ses" else "0")[2]
            line = rows[90]  # above the bar
            drawn = [x for x, pixel in enumerate(line) if pixel != (255, 255, 255)]
            for place, (_, expected) in zip((0.15, 0.5, 0.85), sorted(viridis.items())):
                seen = linear(line[round(drawn[0] + place * (drawn[-1] - drawn[0]))])
                shares = [[c / sum(color) for c in color] for color in (seen, linear(expected))]
                self.assertLess(max(abs(a - b) for a, b in zip(*shares)), 0.05, (surface, expected))

    def test_a_wide_range_leaves_small_distances_pale(self):
        """The mesh of a ball that is 0.1 Å too large: white within ±10 Å, warm within ±0.1 Å."""
        atom, larger = self.ball("atom.xyzr", 1), self.ball("larger.xyzr", 1.1)
        mesh, path = self.folder / "a.ply", self.folder / "picture.png"
        self.run_ok("mesh", larger, "-o", mesh, "--spacing", "0.1")
        excess = []
        for bound in (10, 0.1):
            self.run_ok("compare", mesh, atom, "--picture", path, "--size", "320x240", "--distances", "off",
                        f"--color-range={-bound},{bound}")  # fmt: skip
            red, _, blue = decode_png(path)[2][90][160][:3]
            excess.append(red - blue)
        self.assertLess(abs(excess[0]), 20)
        self.assertGreater(excess[1], 80)


class Refusals(PictureTest):
    def refused(self, *arguments, says=(), code=BAD_INPUT):
        self.assert_refused(code, "render", *arguments, says=says)
        self.assertFalse([name for name in self.files() if name.endswith(".png")])

    def test_broken_meshes(self):
        out = self.folder / "out.png"
        meshes = {
            "empty.off": ("OFF\n0 0 0\n", "empty.off"),
            "flat.off": ("OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n", "no area"),
            "nan.obj": ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "nan.obj"),
            "index.off": ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n", "index.off"),
            "cut.stl": ("solid x\nfacet normal 0 0 1\n", "cut.stl"),
        }
        for name, (text, says) in meshes.items():
            with self.subTest(name=name):
                self.refused(self.file(name, text), "-o", out, says=(says,))

    def test_edge_on(self):
        mesh = self.file("flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.refused(mesh, "-o", self.folder / "out.png", "--view", "x", says=("view",))

    def test_options(self):
        out = ("-o", self.folder / "out.png")
        for options, says in {
            ("--size", "0x10"): "--size",
            ("--size", "wide"): "--size",
            ("--size", "100x99999"): "--size",
            ("--view", "above"): "front",
            ("--view", "0,0,0"): "--view",
            ("--view", "1,2"): "--view",
            ("--background", "#12345"): "--background",
            ("--camera", "fisheye"): "orthographic",
            ("--shading", "flat"): "gouraud",
            ("--antialias", "9"): "--antialias",
            ("--color", "rainbow"): "element",
            ("--color-map", "jet"): "viridis",
            ("--color-range", "1,0"): "--color-range",
            ("--color-range=-1e308,1e308",): "--color-range",
            ("--color", "angle", "--size", "100x100"): "colour bar",
        }.items():
            with self.subTest(options=options):
                self.refused("--sample", "bpti", "--subdivide", "0", *out, *options, says=(says,))

    def test_b_factors_of_files_without(self):
        out = ("-o", self.folder / "out.png", "--color", "b-factor")
        self.refused(self.file("a.xyzr", "0 0 0 2\n"), *out, says=("a.xyzr", "PDB or mmCIF"))
        self.refused(self.file("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), *out, says=("no atoms",))

    def test_a_mesh_is_drawn_as_it_is(self):
        """In capitals too; what says how a structure is read or meshed would have no effect."""
        mesh = self.folder / "A.PLY"
        self.run_ok("mesh", self.file("a.xyzr", "0 0 0 2\n"), "-o", mesh)
        out = self.folder / "out.png"
        for options in (("--field", "blinn"), ("--spacing", "0.2"), ("--subdivide", "1"), ("--probe", "1"),
                        ("--waters",), ("--mesher", "exact"), ("--format", "pdb")):  # fmt: skip
            with self.subTest(options=options):
                self.refused(mesh, "-o", out, *options, says=(options[0], "A.PLY"))
        self.run_ok("render", mesh, "-o", out, *SMALL[:2])

    def test_warnings_of_the_structure(self):
        cut = self.cut_file()
        out = self.folder / "x.ignored.png"
        self.assertRegex(self.run_ok("render", cut, "-o", out, *SMALL).stdout, "WARNING .*may have been cut off")
        quiet = self.run_ok("render", cut, "-o", out, *SMALL, "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr.count("may have been cut off")), ("", 1))

    def test_files(self):
        self.refused("--sample", "bpti", says=("-o",))
        self.refused("--sample", "bpti", "-o", self.folder / "x.jpg", says=("PNG",))
        self.refused("--sample", "bpti", "-o", self.folder / "none" / "x.png", says=("folder",))
        mesh = self.file("flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        out = self.folder / "x.png"
        self.refused(mesh, "-o", out, "--color", "distance", says=("compare",))

    def test_memory_limit(self):
        out = self.folder / "x.png"
        mesh = self.file("flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.refused(mesh, "-o", out, "--memory-limit", "1M", says=("limit",), code=LIMIT_HIT)


class OfReports(PictureTest):
    def test_report(self):
        path = self.folder / "picture.png"
        options = ("--picture", path, *SMALL, "--view", "top")
        picture = self.report("report", "--sample", "bpti", *options)["picture"]
        self.assertEqual(decode_png(path)[:2], (320, 240))
        self.assertEqual((picture["width"], picture["height"]), (320, 240))
        self.assertEqual(picture["view"], "top")
        text = TextReport(*self.text_and_document("report", "--sample", "bpti", *options))
        self.assertEqual(text.problems, [])
        self.assertLessEqual({"Picture", "Drawn by"}, text.seen)
        scale = picture["scale"]
        self.assertEqual(scale["color_map"], "cool-warm")
        self.assertEqual(scale["lower"], -scale["upper"])
        self.assertIsNone(self.report("report", "--sample", "bpti", "--subdivide", "0")["picture"])

    def test_of_a_mesh_file_on_a_backend_that_is_not_there(self):
        if parse_json(self.run_ok("info", "--json", "-").stdout)["cuda"]["devices"]:
            self.skipTest("this machine has a CUDA device")
        mesh, path = self.folder / "a.off", self.folder / "a.png"
        self.run_ok("mesh", "--sample", "bpti", "--subdivide", "0", "-o", mesh)
        self.assert_refused(NO_BACKEND, "render", mesh, "-o", path, "--backend", "cuda")
        self.assertFalse(path.exists())

    def test_compare(self):
        mesh, path = self.folder / "mesh.ply", self.folder / "picture.png"
        self.run_ok("mesh", "--sample", "bpti", "-o", mesh)
        options = ("--picture", path, *SMALL[:2], "--distances", "off", "--color-range=-0.3,0.3")
        picture = self.report("compare", mesh, "--sample", "bpti", *options)["picture"]
        self.assertEqual((picture["scale"]["lower"], picture["scale"]["upper"]), (-0.3, 0.3))
        self.assertEqual(decode_png(path)[:2], (320, 240))

    # A mesh of a sphere that is too large by 0.1 Å is warm, one that is too small is cool.
    def test_sign_of_the_distance(self):
        atom = self.file("atom.xyzr", "0 0 0 1\n")
        for radius, warm in ((1.1, True), (0.9, False)):
            larger = self.file(f"{radius}.xyzr", f"0 0 0 {radius}\n")
            mesh, path = self.folder / "mesh.ply", self.folder / "picture.png"
            self.run_ok("mesh", larger, "-o", mesh, "--spacing", "0.1")
            self.run_ok("compare", mesh, atom, "--picture", path, *SMALL[:2])
            red, _, blue = decode_png(path)[2][90][160][:3]
            self.assertEqual(red > blue, warm)

    def test_style_without_picture(self):
        self.assert_refused(
            BAD_INPUT, "report", "--sample", "bpti", "--view", "top", says=("--view", "--picture")
        )
