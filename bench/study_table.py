"""The tables of docs/studies.md from the document of a study: orders of convergence, and the meshes.

    python3 bench/study_table.py FOLDER/study.json [--input 0]

`vdwmesh study INPUT... -o FOLDER` writes the document. A row for each series of runs (one mesher, field, projection and
number of subdivisions), then a row for each mesh.
"""

import argparse
import json
import pathlib

PROJECTED = {"none": "", "vdw": "the union", "field": "the field"}


def number(value, form):
    return "" if value is None else format(value, form)


def name_of(key):
    surface = {"exact": "crease-exact"}.get(key["mesher"], f"marching cubes, {key['field']}")
    onto = PROJECTED.get(key["project"], key["project"])
    return f"{surface}, onto {onto}" if onto and key["subdivide"] and key["mesher"] != "exact" else surface


def orders(series):
    print("| mesh | subdivisions | area | volume | mesh → surface rms | Hausdorff | area against triangles "
          "| area's limit | volume's limit |\n|---|---|---|---|---|---|---|---|---|")  # fmt: skip
    for one in series:
        found = [(one["by_resolution"].get(name) or {}).get("order")
                 for name in ("area_error", "volume_error", "mesh_to_surface_rms", "hausdorff")]  # fmt: skip
        found.append((one["by_triangles"].get("area_error") or {}).get("order"))
        limits = [one["area_extrapolated_relative_error"], one["volume_extrapolated_relative_error"]]
        cells = [*(number(order, ".2f") for order in found), *(number(limit, "+.3%") for limit in limits)]
        print(f"| {name_of(one)} | {one['subdivide']} | {' | '.join(cells)} |")


def meshes(runs):
    print("\n| mesh | subdivisions | triangles | area error | volume error | Δχ | rms, Å | angles, 1 % / median |\n"
          "|---|---|---|---|---|---|---|---|")  # fmt: skip
    for run in runs:
        key, mesh, found = run["parameters"], run["mesh"], run["comparison"]
        angles = mesh["min_angle_deg"]
        rms = ((found["distances"] or {}).get("mesh_to_surface") or {}).get("rms")
        print(f"| {name_of(key)}, {key['resolution']:g} Å | {key['subdivide']} | {mesh['triangles']:,} "
              f"| {found['area_relative_error']:+.3%} | {found['volume_relative_error']:+.3%} "
              f"| {found['euler_characteristic_difference']} | {number(rms, '.4f')} "
              f"| {angles['p01']:.1f}° / {angles['median']:.1f}° |")  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("document", type=pathlib.Path)
    parser.add_argument("--input", type=int, default=0, help="number of the structure")
    given = parser.parse_args()
    molecule = json.loads(given.document.read_text())["inputs"][given.input]
    orders(molecule["series"])
    meshes(molecule["runs"])


if __name__ == "__main__":
    main()
