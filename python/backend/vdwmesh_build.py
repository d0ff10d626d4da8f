"""Makes the wheel of vdwmesh: the interface of PEP 517 around CMake.

It needs nothing but Python's own modules, CMake, Ninja and ldd, so it works without a network. The wheel holds
the shared libraries of others that it needs, in vdwmesh.libs/; CGAL is headers, so its code is in the extension.
It is for one version of Python, because pybind11 does not keep to the limited interface.

Settings, as `pip install . --config-settings build-dir=build/release`:
  build-dir  the build tree; one that is configured already is taken as it is. Default: build/wheel
CMAKE_ARGS in the environment has further arguments for a tree that is not configured yet.
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SUMMARY = "Exact areas, volumes and topology of molecules, and meshes of their surfaces"
# What every Linux with that C library has, by the lists of manylinux, and the driver.
EVERYWHERE = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s|cuda))\.so[.\d]*")
# Fixed, so that the same sources make the same archive.
LONG_AGO = (1980, 1, 1, 0, 0, 0)


def version():
    text = (SOURCE / "CMakeLists.txt").read_text()
    return re.search(r"^project\(vdwmesh VERSION ([\d.]+)", text, re.M)[1]


def metadata():
    return (
        f"Metadata-Version: 2.1\nName: vdwmesh\nVersion: {version()}\nSummary: {SUMMARY}\n"
        "License: GPL-3.0-or-later\nRequires-Python: >=3.9\nRequires-Dist: numpy>=1.21\n"
        f"Description-Content-Type: text/markdown\n\n{(SOURCE / 'README.md').read_text()}"
    )


def tag():
    """Python, its binary interface and the platform, as file names of wheels have them."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    libc, _, release = os.confstr("CS_GNU_LIBC_VERSION").partition(" ")
    if libc == "glibc" and platform.startswith("linux_"):
        platform = platform.replace("linux", f"manylinux_{release.replace('.', '_')}", 1)
    return f"{python}-{python}-{platform}"


def wheel_file():
    return f"Wheel-Version: 1.0\nGenerator: vdwmesh\nRoot-Is-Purelib: false\nTag: {tag()}\n"


def static_archive():
    """Options by which libarchive is linked in: the shared one brings 30 MB of ICU with it, for formats unused here."""
    folder = pathlib.Path("/usr/lib", sysconfig.get_config_var("MULTIARCH") or "")
    decompressors = [next(folder.glob(f"lib{name}.so.?*"), None) for name in ("bz2", "lzma", "zstd", "nettle", "acl")]
    if not (folder / "libarchive.a").exists() or None in decompressors:
        return {}
    return {"LibArchive_LIBRARY": folder / "libarchive.a",
            "CMAKE_CXX_STANDARD_LIBRARIES": " ".join(["-Wl,--as-needed", *map(str, decompressors)])}  # fmt: skip


def build_tree(settings):
    """A configured build tree."""
    tree = (SOURCE / (settings or {}).get("build-dir", "build/wheel")).resolve()
    if not (tree / "CMakeCache.txt").exists():
        options = {"CMAKE_BUILD_TYPE": "Release", "VDWMESH_BUILD_TESTS": "OFF",
                   "VDWMESH_BUILD_BENCHMARKS": "OFF", "VDWMESH_RENDER": "OFF",
                   "VDWMESH_MPI": "OFF", "VDWMESH_PYTHON": "ON", "Python_EXECUTABLE": sys.executable,
                   **static_archive()}  # fmt: skip
        subprocess.run(["cmake", "-S", SOURCE, "-B", tree, "-G", "Ninja",
                        *(f"-D{key}={value}" for key, value in options.items()),
                        *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)  # fmt: skip
    return tree


def built_package(tree, prefix):
    """The files of the package, built and installed below the prefix: name in the wheel -> path."""
    subprocess.run(["cmake", "--build", tree, "--target", "vdwmesh_python"], check=True)
    subprocess.run(["cmake", "--install", tree, "--component", "python", "--prefix", prefix, "--strip"], check=True)
    root = next(prefix.rglob("vdwmesh/__init__.py")).parents[1]
    files = {path.relative_to(root).as_posix(): path for path in sorted(root.rglob("*")) if path.is_file()}
    if f"vdwmesh/_core{sysconfig.get_config_var('EXT_SUFFIX')}" not in files:
        sys.exit(f"{tree} is for another Python than {sys.executable}; name another build-dir")
    return files


def libraries_of(extension):
    """Shared libraries that the extension needs and that not every Linux has: name in the wheel -> path."""
    listed = subprocess.run(["ldd", extension], check=True, capture_output=True, text=True).stdout
    if "not found" in listed:
        sys.exit(f"{extension} needs a library that is not here:\n{listed}")
    found = re.findall(r"^\s*(\S+) => (/\S+)", listed, re.M)
    return {f"vdwmesh.libs/{name}": pathlib.Path(path) for name, path in sorted(found) if not EVERYWHERE.fullmatch(name)}


def digest(content):
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    info = f"vdwmesh-{version()}.dist-info"
    with tempfile.TemporaryDirectory() as folder:
        files = built_package(build_tree(config_settings), pathlib.Path(folder))
        extension = next(path for name, path in files.items() if name.startswith("vdwmesh/_core."))
        files |= libraries_of(extension)
        contents = {name: path.read_bytes() for name, path in files.items()}
    contents[f"{info}/METADATA"] = metadata().encode()
    contents[f"{info}/WHEEL"] = wheel_file().encode()
    record = [f"{name},sha256={digest(content)},{len(content)}" for name, content in contents.items()]
    contents[f"{info}/RECORD"] = "\n".join([*record, f"{info}/RECORD,,", ""]).encode()
    name = f"vdwmesh-{version()}-{tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in contents.items():
            entry = zipfile.ZipInfo(path, LONG_AGO)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in path else 0o644) << 16
            archive.writestr(entry, content)
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = pathlib.Path(metadata_directory) / f"vdwmesh-{version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata())
    (info / "WHEEL").write_text(wheel_file())
    return info.name


def build_sdist(sdist_directory, config_settings=None):
    """The sources that git knows, and the metadata."""
    base = f"vdwmesh-{version()}"
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=SOURCE, check=True, capture_output=True)
    path = pathlib.Path(sdist_directory) / f"{base}.tar.gz"
    with tarfile.open(path, "w:gz") as archive, tempfile.TemporaryDirectory() as folder:
        for name in filter(None, listed.stdout.decode().split("\0")):
            archive.add(SOURCE / name, f"{base}/{name}", recursive=False)
        info = pathlib.Path(folder) / "PKG-INFO"
        info.write_text(metadata())
        archive.add(info, f"{base}/PKG-INFO")
    return path.name
