"""Meshes and recordings in memory, which scenes read as files that last as long as they."""

from __future__ import annotations

import os
import pathlib
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import SceneError

#: VTK's numbers of the types of cells, by their names in meshio.
VTK = {
    **{"vertex": 1, "line": 3, "triangle": 5, "polygon": 7, "pixel": 8, "quad": 9, "tetra": 10, "hexahedron": 12, "wedge": 13},
    **{"pyramid": 14, "penta_prism": 15, "hexa_prism": 16, "line3": 21, "triangle6": 22, "quad8": 23, "tetra10": 24},
    **{"hexahedron20": 25, "wedge15": 26, "pyramid13": 27, "quad9": 28, "hexahedron27": 29, "quad6": 30, "wedge12": 31},
    **{"wedge18": 32, "hexahedron24": 33, "triangle7": 34, "line4": 35},
}
#: Gmsh's numbers of types and dimensions by those of VTK: files of Gmsh have groups.
GMSH = {1: (15, 0), 3: (1, 1), 5: (2, 2), 9: (3, 2), 10: (4, 3), 12: (5, 3), 13: (6, 3), 14: (7, 3), 21: (8, 1), 22: (9, 2)}
GMSH.update({28: (10, 2), 24: (11, 3), 29: (12, 3), 32: (13, 3), 23: (16, 2), 25: (17, 3), 26: (18, 3), 27: (19, 3)})
POLYHEDRON = 42


class Recording:
    """States that another program computed, as the ``states`` of a run.

    ``times`` (F, s) rise; ``positions`` (F x N x 3, in the plane F x N x 2, m) are those of the nodes of the run's bodies. With
    ``elements`` (E x most nodes, counted from 0, with -1 at the end of shorter rows) the recording has a body of its own, whose
    nodes at ``rest`` (N x 3 or N x 2, m) are by default those of the first moment. ``velocities`` (as positions, m/s) are by default
    differences of positions. ``masses`` (N, kg) and ``faces`` (as elements) belong to a body of its own. ``step`` is the time step (s) of the
    program, and ``name`` its name in pictures. All arrays are copied.
    """

    def __init__(
        self,
        times: ArrayLike,
        positions: ArrayLike,
        elements: ArrayLike | None = None,
        *,
        rest: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        masses: ArrayLike | None = None,
        faces: ArrayLike | None = None,
        step: float | None = None,
        name: str = "Python",
    ) -> None:
        given = {"times": times, "positions": positions, "rest": rest, "velocities": velocities, "masses": masses, "step": step}
        arrays: dict[str, NDArray[Any]] = {key: _numbers(key, value) for key, value in given.items() if value is not None}
        if elements is not None and rest is None and arrays["positions"].ndim and arrays["positions"].size:
            arrays["rest"] = arrays["positions"][:1].reshape(arrays["positions"].shape[1:])
        arrays.update({key: _rows(key, value) for key, value in [("elements", elements), ("faces", faces)] if value is not None})
        names = {"times": "time", "positions": "position", "velocities": "velocity", "masses": "mass"}
        self._arrays: dict[str, NDArray[Any]] = {names.get(key, key): array for key, array in arrays.items()}
        self._arrays["engine"] = np.array(str(name))

    def __repr__(self) -> str:
        return f"<localshape.Recording by {self._arrays['engine']}: positions {self._arrays['position'].shape}>"

    def _write(self, path: pathlib.Path) -> None:
        np.savez(path, **self._arrays)  # type: ignore[arg-type, unused-ignore]


class Held:
    """A folder of files, which is removed with this object."""

    def __init__(self) -> None:
        self.folder = ""
        self.names: set[str] = set()

    def add(self, name: str, ending: str, write: Callable[[pathlib.Path], None]) -> str:
        """Writes a file and returns its path."""
        if not self.folder:
            self.folder = pathlib.Path(tempfile.mkdtemp(prefix="localshape-")).resolve().as_posix() + "/"
            weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        path = next(path for at in range(len(self.names) + 1) if (path := f"{name}{at or ''}{ending}") not in self.names)
        self.names.add(path)
        write(pathlib.Path(self.folder, path))
        return self.folder + path


def files(keys: dict[str, Any] | None) -> tuple[dict[str, Any], str, Held]:
    """The keys of a scene with paths in place of meshes and recordings, and the folder of these."""
    keys, held = dict(keys or {}), Held()
    for key, inner, change in [("body", "mesh", _mesh), ("run", "states", _states)]:
        if key in keys:
            keys[key] = _changed(keys[key], key, inner, change, held)
    return keys, held.folder, held


def _changed(value: Any, place: str, key: str, change: Callable[[Any, str, Held], Any], held: Held) -> Any:
    """A table, or each of several, with another value of a key."""
    if isinstance(value, dict) and key in value:
        return {**value, key: change(value[key], f"{place}.{key}", held)}
    if isinstance(value, (list, tuple)) and any(isinstance(one, dict) and key in one for one in value):
        return [_changed(one, f"{place}[{at}]", key, change, held) if isinstance(one, dict) else one for at, one in enumerate(value)]
    return value


def _states(states: Any, place: str, held: Held) -> Any:
    return held.add("Recording", ".npz", states._write) if isinstance(states, Recording) else states


def _mesh(mesh: Any, place: str, held: Held) -> Any:
    """The path of a file with a mesh."""
    if mesh is None or isinstance(mesh, (str, os.PathLike, bool, int, float, bytes, list, tuple, dict, np.ndarray, np.generic)):
        return mesh
    if hasattr(mesh, "cast_to_unstructured_grid") and not hasattr(mesh, "celltypes") and not hasattr(mesh, "faces"):
        mesh = mesh.cast_to_unstructured_grid()
    if hasattr(mesh, "geometry") and hasattr(mesh, "to_mesh"):
        mesh = mesh.to_mesh()
    name, blocks, groups = type(mesh).__name__, [], {}
    kinds: NDArray[Any] = np.empty(0, "int64")
    flat: NDArray[Any] = kinds
    if hasattr(mesh, "points") and hasattr(mesh, "celltypes"):
        points = _points(mesh.points, f"{place}.points")
        kinds, flat = _padded(mesh.cells, mesh.celltypes, len(points), place)
    elif hasattr(mesh, "points") and hasattr(mesh, "faces"):
        points = _points(mesh.points, f"{place}.points")
        kinds, flat = _padded(mesh.faces, None, len(points), place)
    elif hasattr(mesh, "points") and hasattr(mesh, "cells"):
        points = _points(mesh.points, f"{place}.points")
        blocks = [_block(block, len(points), f"{place}.cells[{at}]") for at, block in enumerate(_list(mesh.cells, f"{place}.cells", "blocks of cells"))]
        groups = _groups(mesh, blocks, len(points), place)
    elif hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        points = _points(mesh.vertices, f"{place}.vertices")
        blocks = [(7, _cells(mesh.faces, len(points), f"{place}.faces"))]
    else:
        help = "give a mesh of meshio, trimesh or pyvista, or `nodes` and `elements`"
        raise _wrong(place, f"is {name}; expected the path of a mesh file, or points and cells", help)
    if groups and all(kind in GMSH for kind, _ in blocks):
        return held.add(name, ".msh", lambda path: _write_gmsh(path, points, blocks, groups))
    if blocks:
        kinds = np.repeat([kind for kind, _ in blocks], [len(rows) for _, rows in blocks])
        flat = np.concatenate([np.insert(rows, 0, rows.shape[1], 1).ravel() for _, rows in blocks])
    return held.add(name, ".vtk", lambda path: _write_vtk(path, points, kinds, flat))


def _wrong(place: str, message: str, help: str | None = None) -> SceneError:
    message = f"`{place}` {message}"
    found = {"place": place, "message": message, "remedy": help, "line": None, "column": None}
    return SceneError(f"{message}; {help}" if help else message, [found])


def _list(value: Any, place: str, expected: str) -> list[Any]:
    if not isinstance(value, (list, tuple)):
        raise _wrong(place, f"is {type(value).__name__}; expected a list of {expected}")
    return list(value)


def _array(value: Any, place: str) -> NDArray[Any]:
    try:
        return np.asarray(value)
    except (ValueError, TypeError) as error:
        raise _wrong(place, f"is no array ({error}); expected numbers") from None


def _numbers(place: str, value: Any) -> NDArray[np.float64]:
    """A copy of an array of numbers."""
    array = _array(value, place)
    if array.dtype.kind not in "fiu":
        raise _wrong(place, f"is an array of {array.dtype}; expected numbers")
    return np.array(array, "float64", order="C")


def _integers(value: Any, place: str) -> NDArray[np.int64]:
    array = _array(value, place)
    if array.dtype.kind not in "iu" and array.size:
        raise _wrong(place, f"is an array of {array.dtype}; expected integers")
    # Those that are too large are no numbers of points either.
    most = np.iinfo("int64").max
    return (np.minimum(array, np.uint64(most)) if array.dtype == np.uint64 else array).astype("int64")


def _rows(place: str, value: Any) -> NDArray[np.int64]:
    """Rows of nodes, to the end of which -1 is added."""
    if isinstance(value, (list, tuple)) and value and all(isinstance(row, (list, tuple)) for row in value):
        longest = max(map(len, value))
        value = [[*row, *[-1] * (longest - len(row))] for row in value]
    return _integers(value, place)


def _points(value: Any, place: str) -> NDArray[np.float64]:
    points = _numbers(place, value)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise _wrong(place, f"has the shape {points.shape}; expected one row for each point with 2 or 3 coordinates")
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def _cells(value: Any, count: int, place: str) -> NDArray[np.int64]:
    """Rows of points, all of which are there."""
    rows = _integers(value, place)
    if rows.ndim != 2:
        raise _wrong(place, f"has the shape {rows.shape}; expected one row for each cell")
    wrong = np.argwhere((rows < 0) | (rows >= count))
    if len(wrong):
        row, column = wrong[0].tolist()
        raise _wrong(f"{place}[{row}][{column}]", f"is {rows[row, column]}; expected the number of a point, from 0 to {count - 1}")
    return rows


def _block(block: Any, count: int, place: str) -> tuple[int, NDArray[np.int64]]:
    """Cells of one type of meshio."""
    kind = str(getattr(block, "type", "?"))
    number = VTK.get("polygon" if kind.startswith("polygon") else kind)
    if number is None:
        expected = "triangles, quads, polygons, tetrahedra, pyramids, wedges or hexahedra"
        help = "write the mesh as a .vtu file, and name it in its place"
        raise _wrong(place, f"has cells of the type {kind}; expected {expected}", help)
    return number, _cells(block.data, count, f"{place}.data")


def _padded(value: Any, kinds: Any, count: int, place: str) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The types and cells of pyvista, each after its number of points. Without types they are polygons."""
    name = f"{place}.{'faces' if kinds is None else 'cells'}"
    flat, starts, at = _integers(value, name).ravel(), [], 0
    numbers = flat.tolist()
    while at < len(flat):
        starts.append(at)
        at += 1 + max(numbers[at], 0)
        if at > len(flat) or numbers[starts[-1]] < 0:
            found = f"is {numbers[starts[-1]]}; expected the number of points of a cell, and these behind it"
            raise _wrong(f"{name}[{starts[-1]}]", found)
    wrong = (flat < 0) | (flat >= count)
    wrong[starts] = False
    if wrong.any():
        first = int(wrong.argmax())
        raise _wrong(f"{name}[{first}]", f"is {flat[first]}; expected the number of a point, from 0 to {count - 1}")
    kinds = np.full(len(starts), 7) if kinds is None else _integers(kinds, f"{place}.celltypes").ravel()
    if len(kinds) != len(starts):
        raise _wrong(f"{place}.celltypes", f"has {len(kinds)} entries; expected one for each of {len(starts)} cells")
    if POLYHEDRON in kinds:
        help = "save it as a .vtu file, and name that in its place"
        raise _wrong(f"{place}.celltypes", "has polyhedra; expected tetrahedra, pyramids, wedges or hexahedra", help)
    return kinds, flat


def _groups(mesh: Any, blocks: Any, count: int, place: str) -> dict[str, Any]:
    """The named sets of meshio: the points of each, or its cells in each block."""
    groups: dict[str, Any] = {}
    for key, size in [("point_sets", [count]), ("cell_sets", [len(rows) for _, rows in blocks])]:
        sets_by_name = getattr(mesh, key, None)
        for name, listed in sets_by_name.items() if isinstance(sets_by_name, dict) else []:
            if str(name).startswith("gmsh:"):
                continue
            sets = [listed] if key == "point_sets" else _list(listed, f"{place}.{key}[{name!r}]", "cells of each block")
            chosen = [_integers([] if one is None else one, f"{place}.{key}[{name!r}]").ravel() for one in sets]
            if len(chosen) != len(size) or any(len(one) and not 0 <= one.min() <= one.max() < most for one, most in zip(chosen, size)):
                raise _wrong(f"{place}.{key}[{name!r}]", "has entries that are not there; expected numbers of points or cells")
            groups[f"{key} {name}"] = (str(name).replace('"', "'").replace("\n", " "), key == "point_sets", chosen)
    return groups


def _write_vtk(path: pathlib.Path, points: NDArray[np.float64], kinds: NDArray[Any], flat: NDArray[Any]) -> None:
    """Writes points and cells in VTK's legacy format, bit by bit."""
    with path.open("wb") as file:
        file.write(b"# vtk DataFile Version 3.0\nlocalshape\nBINARY\nDATASET UNSTRUCTURED_GRID\n")
        file.write(b"POINTS %d double\n" % len(points) + points.astype(">f8").tobytes())
        file.write(b"\nCELLS %d %d\n" % (len(kinds), len(flat)) + flat.astype(">i4").tobytes())
        file.write(b"\nCELL_TYPES %d\n" % len(kinds) + kinds.astype(">i4").tobytes() + b"\n")


def _write_gmsh(path: pathlib.Path, points: NDArray[np.float64], blocks: Any, groups: dict[str, Any]) -> None:
    """Writes points, cells and groups in Gmsh's format 2.2. A cell is listed once for each of its groups."""
    names: list[str] = []
    lines: list[str] = []
    left = [np.ones(len(rows), bool) for _, rows in blocks]

    def add(kind: int, rows: Iterable[Any], tag: int) -> None:
        lines.extend(f"{GMSH[kind][0]} 2 {tag} 0 {' '.join(map(str, row))}" for row in (np.asarray(rows) + 1).tolist())

    for tag, (name, is_of_points, chosen) in enumerate(groups.values(), 1):
        of_group = [(1, np.arange(len(points))[:, None])] if is_of_points else blocks
        for (kind, rows), one, of in zip(of_group, chosen, left):
            if len(one):
                names.append(f'{GMSH[kind][1]} {tag} "{name}"')
                add(kind, rows[one], tag)
                if not is_of_points:
                    of[one] = False
    for (kind, rows), of in zip(blocks, left):
        add(kind, rows[of], 0)
    names = list(dict.fromkeys(names))
    with path.open("w", encoding="utf-8") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(names)}\n" + "".join(f"{name}\n" for name in names))
        file.write(f"$EndPhysicalNames\n$Nodes\n{len(points)}\n")
        file.writelines(f"{at} {x!r} {y!r} {z!r}\n" for at, (x, y, z) in enumerate(points.tolist(), 1))
        file.write(f"$EndNodes\n$Elements\n{len(lines)}\n")
        file.writelines(f"{at} {line}\n" for at, line in enumerate(lines, 1))
        file.write("$EndElements\n")
