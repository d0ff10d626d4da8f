"""Meshes as objects of other packages, and results of trajectories as their tables; the packages are imported when they
are asked for."""

from __future__ import annotations

import csv
import os
from importlib import import_module
from importlib.util import find_spec
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from vdwmesh.errors import BackendUnavailable, FileFormatError, InvalidInput

if TYPE_CHECKING:
    from vdwmesh._frames import TrajectoryResult
    from vdwmesh._mesh import Mesh

_UNITS = {"time": "ps", "area": "Å²", "volume": "Å³", "atom_area": "Å²", "atom_volume": "Å³"}
_ASCII = {"Å²": "angstrom2", "Å³": "angstrom3"}


def to_pandas(result: TrajectoryResult) -> Any:
    """One row for each frame, by its number; atoms have columns of their own."""
    pandas = import_module("pandas")
    return pandas.DataFrame(_columns(result)).set_index("frame")


def to_xarray(result: TrajectoryResult) -> Any:
    """Dimensions are "frame" and "atom"; units are attributes."""
    xarray = import_module("xarray")
    values = {name: (_dimensions(array), array, _attributes(name)) for name, array in _values(result)}
    coordinates: dict[str, Any] = {"frame": result.frames}
    if result.times is not None:
        coordinates["time"] = ("frame", result.times, _attributes("time"))
    return xarray.Dataset(values, coordinates)


def save(result: TrajectoryResult, path: str | os.PathLike[str]) -> None:
    """The extension says how."""
    name = os.fspath(path)
    extension = os.path.splitext(name)[1]
    if extension not in _WRITERS:
        raise InvalidInput(f"path: {name} ends with none of {', '.join(_WRITERS)}")
    # Written in a folder of its own beside it, so that a file is whole or not there, and that no
    # other file is written to.
    try:
        folder = TemporaryDirectory(prefix=".vdwmesh-", dir=os.path.dirname(name) or ".")
    except OSError as error:
        raise FileFormatError(f"{name}: cannot be written: {error.strerror}") from None
    with folder as place:
        partial = os.path.join(place, f"part{extension}")
        _WRITERS[extension](result, partial)
        os.replace(partial, name)


def _values(result: TrajectoryResult) -> list[tuple[str, Any]]:
    """What there is for each frame beside its number and time."""
    names = ("area", "volume", "components", "tunnels", "voids", "euler_characteristic",
             "hidden_atoms", "atom_area", "atom_volume")  # fmt: skip
    found = [(name, getattr(result, name)) for name in names]
    return [(name, array) for name, array in found if array is not None]


def _arrays(result: TrajectoryResult) -> dict[str, Any]:
    arrays: dict[str, Any] = {"frame": result.frames}
    if result.times is not None:
        arrays["time"] = result.times
    arrays.update(_values(result))
    return arrays


def _columns(result: TrajectoryResult) -> dict[str, Any]:
    """The arrays with a column of its own for each atom."""
    columns: dict[str, Any] = {}
    for name, array in _arrays(result).items():
        if array.ndim == 1:
            columns[name] = array
        else:
            columns.update((f"{name}_{atom}", array[:, atom]) for atom in range(array.shape[1]))
    return columns


def _dimensions(array: Any) -> tuple[str, ...]:
    return ("frame", "atom")[: array.ndim]


def _attributes(name: str) -> dict[str, str]:
    return {"units": _UNITS[name]} if name in _UNITS else {}


def _save_csv(result: TrajectoryResult, path: str) -> None:
    """Numbers have all their digits, and what was not measured is empty."""
    columns = _columns(result)
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        for row in zip(*(array.tolist() for array in columns.values())):
            writer.writerow("" if value != value else value for value in row)


def _save_hdf5(result: TrajectoryResult, path: str) -> None:
    if find_spec("h5py"):
        with import_module("h5py").File(path, "w") as file:
            for name, array in _arrays(result).items():
                file[name] = array
                file[name].attrs.update(_attributes(name))
    elif find_spec("tables"):
        with import_module("tables").open_file(path, "w") as file:
            for name, array in _arrays(result).items():
                node = file.create_array("/", name, array)
                for key, value in _attributes(name).items():
                    node.set_attr(key, value)
    else:
        raise BackendUnavailable("path: .h5 needs h5py or PyTables (Debian: python3-tables)")


def _save_netcdf(result: TrajectoryResult, path: str) -> None:
    """NetCDF 3 with 64-bit offsets, which every reader knows. It has no integers of 64 bits."""
    if not find_spec("scipy"):
        raise BackendUnavailable("path: .nc needs SciPy (Debian: python3-scipy)")
    with import_module("scipy.io").netcdf_file(path, "w", version=2) as file:
        file.createDimension("frame", len(result))
        if result.atom_area is not None:
            file.createDimension("atom", result.atom_area.shape[1])
        for name, array in _arrays(result).items():
            whole = array.dtype.kind in "iu"
            if whole and abs(array).max(initial=0) >= 2**31:
                raise InvalidInput(f"path: {name} has numbers beyond those of .nc; .h5 takes them")
            variable = file.createVariable(name, np.int32 if whole else np.float64, _dimensions(array))
            variable[:] = array
            for key, value in _attributes(name).items():
                setattr(variable, key, _ASCII.get(value, value))


_WRITERS: dict[str, Callable[[Any, str], None]] = {
    ".csv": _save_csv,
    ".h5": _save_hdf5,
    ".nc": _save_netcdf,
}


def to_trimesh(mesh: Mesh) -> Any:
    """Vertices are not merged (trimesh#222: process=False), so that they keep their order."""
    trimesh = import_module("trimesh")

    return trimesh.Trimesh(
        vertices=np.array(mesh.vertices),
        faces=mesh.faces.astype(np.int64),
        vertex_normals=None if mesh.normals is None else np.array(mesh.normals, np.float64),
        vertex_attributes=_given(atom=mesh.vertex_atoms),
        face_attributes=_given(atom=mesh.face_atoms),
        process=False,
    )


def to_pyvista(mesh: Mesh) -> Any:
    """PyVista's faces are one list: the number of corners of each, then the corners."""
    pyvista = import_module("pyvista")

    corners = np.full((len(mesh.faces), 4), 3, np.int64)
    corners[:, 1:] = mesh.faces
    surface = pyvista.PolyData(np.array(mesh.vertices), corners.ravel())
    if mesh.normals is not None:
        surface.point_data["Normals"] = np.array(mesh.normals)
    for name, array in _given(atom=mesh.vertex_atoms).items():
        surface.point_data[name] = array
    for name, array in _given(atom=mesh.face_atoms).items():
        surface.cell_data[name] = array
    return surface


def to_meshio(mesh: Mesh) -> Any:
    """Atoms are point data and cell data of the name "atom"."""
    meshio = import_module("meshio")

    points = {} if mesh.normals is None else {"normals": np.array(mesh.normals)}
    points.update(_given(atom=mesh.vertex_atoms))
    cells = {name: [array] for name, array in _given(atom=mesh.face_atoms).items()}
    return meshio.Mesh(
        np.array(mesh.vertices),
        [("triangle", mesh.faces.astype(np.int64))],
        point_data=points,
        cell_data=cells,
    )


def to_open3d(mesh: Mesh) -> Any:
    """Open3D has no place for atoms."""
    open3d = import_module("open3d")

    surface = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(np.array(mesh.vertices)),
        open3d.utility.Vector3iVector(mesh.faces.astype(np.int32)),
    )
    if mesh.normals is not None:
        surface.vertex_normals = open3d.utility.Vector3dVector(np.array(mesh.normals, np.float64))
    return surface


def _given(**arrays: Any) -> dict[str, Any]:
    return {name: array.astype(np.int64) for name, array in arrays.items() if array is not None}
