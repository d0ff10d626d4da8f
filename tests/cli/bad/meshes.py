"""Damaged mesh files for `compare`: PLY, OBJ, OFF, STL and GLB, as text and binary."""

import json
import struct

from .case import Expect, Maker

REFUSED, READ, SAME, EITHER = Expect.REFUSED, Expect.READ, Expect.SAME, Expect.EITHER

# The octahedron inscribed in the unit ball.
VERTICES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
FACES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
KINDS = {"ply": ("text", "binary"), "obj": ("text",), "off": ("text",), "stl": ("text", "binary"),
         "glb": ("binary",)}


def encode(kind, vertices=VERTICES, faces=FACES, counts=None):
    """The mesh as bytes; `counts` overrules what a header says of vertices and faces."""
    return ENCODERS[kind](vertices, faces, counts or (len(vertices), len(faces)))


def ply_header(form, counts):
    return (f"ply\nformat {form} 1.0\nelement vertex {counts[0]}\nproperty double x\n"
            f"property double y\nproperty double z\nelement face {counts[1]}\n"
            "property list uchar int vertex_indices\nend_header\n").encode()


def ply_text(vertices, faces, counts):
    rows = [" ".join(map(str, v)) for v in vertices]
    rows += [" ".join(map(str, (len(f), *f))) for f in faces]
    return ply_header("ascii", counts) + ("\n".join(rows) + "\n").encode()


def ply_binary(vertices, faces, counts):
    body = b"".join(struct.pack("<3d", *map(float, v)) for v in vertices)
    body += b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces)
    return ply_header("binary_little_endian", counts) + body


def obj_text(vertices, faces, counts):
    rows = ["v " + " ".join(map(str, v)) for v in vertices]
    rows += ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    return ("\n".join(rows) + "\n").encode()


def off_text(vertices, faces, counts):
    rows = ["OFF", f"{counts[0]} {counts[1]} 0", *(" ".join(map(str, v)) for v in vertices)]
    rows += [" ".join(map(str, (len(f), *f))) for f in faces]
    return ("\n".join(rows) + "\n").encode()


def stl_text(vertices, faces, counts):
    rows = ["solid a"]
    for f in faces:
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += ["vertex " + " ".join(map(str, vertices[i])) for i in f]
        rows += ["endloop", "endfacet"]
    return ("\n".join([*rows, "endsolid a"]) + "\n").encode()


def stl_binary(vertices, faces, counts):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(float(x) for i in f for x in vertices[i]), 0)
                    for f in faces)
    return b"an octahedron".ljust(80) + struct.pack("<I", counts[1]) + body


def glb_binary(vertices, faces, counts):
    indices = b"".join(struct.pack(f"<{len(f)}I", *(i % 2**32 for i in f)) for f in faces)
    points = b"".join(struct.pack("<3f", *map(float, v)) for v in vertices)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(points) + len(indices)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(points)},
                        {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": counts[0], "type": "VEC3",
             "min": [-1, -1, -1], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5125, "count": 3 * counts[1], "type": "SCALAR"}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(points + indices), b"BIN\0") + points + indices
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


ENCODERS = {
    ("ply", "text"): ply_text, ("ply", "binary"): ply_binary, ("obj", "text"): obj_text,
    ("off", "text"): off_text, ("stl", "text"): stl_text, ("stl", "binary"): stl_binary,
    ("glb", "binary"): glb_binary,
}


def not_a_mesh(make, kind):
    dice = make.dice("noise")
    make.add("empty", b"", REFUSED)
    make.add("a megabyte of blanks", b" " * 2**20, REFUSED)
    make.add("random bytes", dice.randbytes(5000), REFUSED)
    make.add("zero bytes", bytes(5000), REFUSED)
    make.add("a web page", b"<!DOCTYPE html><html><body>404 Not Found</body></html>\n", REFUSED)
    for other in ENCODERS:
        if other[0] != kind[0]:
            make.add(f"holds {other[0].upper()} ({other[1]})", encode(other), REFUSED)
    make.add("no faces", encode(kind, faces=[]), REFUSED)


def cut(make, kind, data):
    # OBJ and the text forms cannot tell that lines are missing at their end; the mesh is open then.
    may_go_unseen = kind == ("obj", "text")
    for part in (1, 2, 3):
        make.add("cut in the middle", data[: len(data) * part // 4 - 1],
                 EITHER if may_go_unseen else REFUSED)
    make.add("cut by 2 bytes", data[:-2], EITHER if kind[1] == "text" else REFUSED)
    make.add("cut by 12 bytes", data[:-12], EITHER if kind[1] == "text" else REFUSED)


def text_forms(make, data):
    make.add("line ends CR LF", data.replace(b"\n", b"\r\n"), SAME, len(FACES))
    make.add("line ends CR", data.replace(b"\n", b"\r"), SAME, len(FACES))
    make.add("byte-order mark of UTF-8", b"\xef\xbb\xbf" + data, SAME, len(FACES))
    make.add("no line break at the end", data.rstrip(b"\n"), SAME, len(FACES))
    make.add("UTF-16", data.decode().encode("utf-16"), REFUSED)
    make.add("a zero byte inside", data[: len(data) // 2] + b"\0" + data[len(data) // 2:], REFUSED)


def bad_numbers(make, kind):
    for number in ("nan", "inf", "1e999" if kind[1] == "text" else "-inf"):
        make.add(f"x of a vertex is {number}", encode(kind, [(number, 0, 0), *VERTICES[1:]]), REFUSED)
    if kind[1] == "text":
        for number in ("****", "abc", "1,5"):
            make.add(f"x of a vertex is {number}", encode(kind, [(number, 0, 0), *VERTICES[1:]]),
                     REFUSED)
    make.add("x of a vertex is 1e30", encode(kind, [(1e30, 0, 0), *VERTICES[1:]]), EITHER, len(FACES))
    huge = [tuple(1e30 * x for x in v) for v in VERTICES]
    make.add("all coordinates are 1e30", encode(kind, huge), EITHER, len(FACES))


def bad_indices(make, kind):
    if kind[0] == "stl":
        return
    for index in (6, 2**31 - 2, -1):
        expect = EITHER if index == -1 and kind[0] == "obj" else REFUSED
        make.add(f"a face names vertex {index} of 6", encode(kind, faces=[(0, 2, index), *FACES[1:]]),
                 expect)


def bad_counts(make, kind):
    if kind[0] == "obj" or kind == ("stl", "text"):
        return
    for count in (5, 7, 10**6, 2**32 - 1, 2**63):
        if kind[0] != "stl" and not (kind[0] == "glb" and count < 10):
            make.add(f"{count} vertices promised, 6 there", encode(kind, counts=(count, 8)), REFUSED)
        if count < 2**32 or kind[0] != "stl":
            faces = {5: 7, 7: 9}.get(count, count)
            noted = faces == 7 and kind[0] in ("stl", "glb")
            make.add(f"{faces} faces promised, 8 there", encode(kind, counts=(6, faces)),
                     READ if noted else REFUSED, 7 if noted else None)


def odd_faces(make, kind):
    make.add("every face twice", encode(kind, faces=[f for f in FACES for _ in (0, 1)]), READ, 16)
    make.add("a face missing", encode(kind, faces=FACES[1:]), READ, 7)
    make.add("a face turned over", encode(kind, faces=[FACES[0][::-1], *FACES[1:]]), READ, 8)
    make.add("a face with a corner twice", encode(kind, faces=[*FACES, (0, 0, 1)]), READ, 9)
    make.add("all vertices in one place", encode(kind, [(1, 1, 1)] * 6), EITHER, 8)
    if kind[0] not in ("stl", "glb"):
        make.add("a quadrangle", encode(kind, faces=[(0, 2, 1, 3), *FACES]), READ, 10)
        make.add("a face of two corners", encode(kind, faces=[*FACES, (0, 1)]), EITHER)


def flipped_bits(make, kind, data):
    dice = make.dice("bits")
    for _ in range(12):
        broken = bytearray(data)
        broken[dice.randrange(len(data))] ^= 1 << dice.randrange(8)
        make.add("a bit flipped", bytes(broken), EITHER)


def damages(extension):
    make = Maker(extension)
    for form in KINDS[extension]:
        kind = (extension, form)
        data = encode(kind)
        make.add(f"as it should be ({form})", data, SAME, len(FACES))
        if form == KINDS[extension][0]:
            not_a_mesh(make, kind)
        cut(make, kind, data)
        if form == "text":
            text_forms(make, data)
        bad_numbers(make, kind)
        bad_indices(make, kind)
        bad_counts(make, kind)
        odd_faces(make, kind)
        flipped_bits(make, kind, data)
    return make.cases
