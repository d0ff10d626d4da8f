"""The version stands in CMakeLists.txt; wherever else it is written, it is the same.

    check_versions.py SOURCE_DIR [--release]

With --release the changelog has to have a date for it, too.
"""

import pathlib
import re
import sys

# File, and where in it the version or the part of it that counts stands.
PLACES = {
    "CITATION.cff": r"^version: (.*)$",
    "CHANGELOG.md": r"^## (\S+) \(",
    "debian/changelog": r"^vdwmesh \((\S+)\)",
    "apps/build_id.hpp": r'kVersion;  // "(.*)"',
    "tests/consumer/CMakeLists.txt": r"find_package\(vdwmesh (\S+) REQUIRED",
}


def version_of(root):
    return re.search(r"^project\(vdwmesh VERSION (\d+\.\d+\.\d+) ", (root / "CMakeLists.txt").read_text(), re.M)[1]


def wrong_versions(root):
    version = version_of(root)
    for name, pattern in PLACES.items():
        found = re.search(pattern, (root / name).read_text(), re.M)
        if not found:
            yield f"{name}: no version where {pattern} would find it"
        elif version != found[1] and version.rpartition(".")[0] != found[1]:
            yield f"{name} says {found[1]}, CMakeLists.txt {version}"
    if 'dynamic = ["version"]' not in (root / "pyproject.toml").read_text():
        yield "pyproject.toml has a version of its own; python/backend takes that of CMakeLists.txt"


def not_ready(root):
    heading = re.search(r"^## .*$", (root / "CHANGELOG.md").read_text(), re.M)[0]
    if not re.search(r"\(\d{4}-\d\d-\d\d\)$", heading):
        yield f"CHANGELOG.md: '{heading}' has no date of release"


def main(root, *options):
    root = pathlib.Path(root)
    faults = list(wrong_versions(root))
    if "--release" in options:
        faults += not_ready(root)
    print("\n".join(faults) or f"no fault: {version_of(root)}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
