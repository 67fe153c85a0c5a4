"""Voxels as arrays of numpy."""

from __future__ import annotations

import functools
import json
import operator
import os
import pathlib
import tempfile
import warnings as python_warnings
from typing import (
    TYPE_CHECKING,
    Any,
    Dict,
    Iterable,
    List,
    NamedTuple,
    NoReturn,
    Optional,
    Sequence,
    SupportsIndex,
    Tuple,
    Union,
)

import numpy as np

from . import _latvox
from ._errors import InvalidArgument, VoxelizeWarning, checked_path, warn

_NOTES = ("EMPTY_SHARD",)  # warnings of a shard that is as it should be

_Point = Union[Sequence[SupportsIndex], np.ndarray]

_ARRAYS = "take ijk, points, dense() or the values of a field, such as v['distance']"


def _name(field: Any) -> str:
    """Returns the name of a field. No field has a name that is not UTF-8."""
    if not isinstance(field, str):
        raise TypeError(f"{field!r} is no name of a field; {_ARRAYS}")
    return field.encode("utf-8", "backslashreplace").decode()


def _names(argument: str, fields: Any) -> str:
    """Returns names of fields, or one, with commas."""
    names = [fields] if isinstance(fields, str) else list(fields) if isinstance(fields, Iterable) else None
    if names is None or not all(isinstance(name, str) for name in names):
        raise TypeError(f"{argument}: {fields!r} is neither the name of a field nor a sequence of names")
    return ",".join(map(_name, names))


def _corners(box: Any) -> Tuple[Tuple[int, ...], Tuple[int, ...]]:
    """Returns the corners of a box, (low, high)."""
    try:
        low, high = (tuple(operator.index(x) for x in corner) for corner in box)
        if len(low) == len(high) == 3 and all(-(2**31) <= x < 2**31 for x in (*low, *high)):
            return low, high
    except (TypeError, ValueError):
        pass
    limit = "(low, high), two lattice points of three whole numbers of 32 bits"
    raise InvalidArgument(f"box: {box!r} is not {limit}", reason="BAD_BOX", field="box", value=repr(box), limit=limit)


class Dense(NamedTuple):
    """An array with an element for each lattice point of a box."""

    data: np.ndarray  # (ni, nj, nk) bool, or (ni, nj, nk) or (ni, nj, nk, components) of a field
    index_min: Tuple[int, int, int]  # the lattice point of data[0, 0, 0]
    affine: np.ndarray  # (4, 4) float64: affine @ (a, b, c, 1) is the world position of data[a, b, c], a voxel's center


class Bricks:
    """Voxels, in bricks of 8 x 8 x 8.

    n voxels have the same order in all arrays: brick after brick, and in each brick ascending by i, j, k. Positions and
    lengths have the mesh's unit.
    """

    def __init__(self, voxels: _latvox.Voxels) -> None:
        self._voxels = voxels

    def __len__(self) -> int:
        """Returns n, the number of voxels."""
        return len(self._voxels)

    @functools.cached_property
    def ijk(self) -> np.ndarray:
        """(n, 3) int32: lattice coordinates."""
        return self._voxels.ijk()

    @functools.cached_property
    def points(self) -> np.ndarray:
        """(n, 3) float64: world positions of the voxels' centers, origin + i*a + j*b + k*c."""
        return self._voxels.points()

    @property
    def brick_ijk(self) -> np.ndarray:
        """(b, 3) int32: lattice coordinates of the bricks, ijk >> 3. A view of the answer's memory."""
        return self._voxels.brick_ijk()

    @property
    def masks(self) -> np.ndarray:
        """(b, 8) uint64: voxel (x, y, z) of a brick is bit (y << 3 | z) of word x. A view of the answer's memory."""
        return self._voxels.brick_masks()

    @property
    def fields(self) -> List[str]:
        """Names of the fields that the voxels carry."""
        return self._voxels.fields()

    def __getitem__(self, field: str) -> np.ndarray:
        """Returns the values of a field, (n,) or (n, components), in the order of ijk. A view of the answer's memory.

        part, material, triangle: int32. color: (n, 3) uint8. distance: float32. point: (n, 2) float32. normal: (n, 3)
        float32. fraction: uint16; label_fractions: (n, len(fraction_labels)) uint16. links: (n, len(neighbors))
        float32; link_triangles, link_crossings: (n, len(neighbors)) int32. Links that the mesh does not cross have NaN,
        -1 and 0.

        Errors: KeyError for a field that the voxels do not carry.
        """
        return self._voxels.field(_name(field))

    def __contains__(self, field: object) -> bool:
        """Returns whether the voxels carry a field."""
        return field in self.fields

    if not TYPE_CHECKING:  # type checkers refuse what these two refuse

        def __iter__(self) -> NoReturn:
            raise TypeError(f"voxels are no sequence; {_ARRAYS}")

        def __array__(self, *args: Any, **options: Any) -> NoReturn:
            raise TypeError(f"voxels are several arrays; {_ARRAYS}")

    def names(self, field: str) -> List[str]:
        """Returns the mesh file's names of the numbers of "part" or "material"; [] if it has none."""
        return self._voxels.names(_name(field))

    @property
    def basis(self) -> np.ndarray:
        """(3, 3) float64: row n is the world vector of one step along index n."""
        return np.array(self._voxels.basis())

    @property
    def origin(self) -> np.ndarray:
        """(3,) float64: world position of lattice point (0, 0, 0)."""
        return np.array(self._voxels.origin())

    @property
    def affine(self) -> np.ndarray:
        """(4, 4) float64: affine @ (i, j, k, 1) is the world position of a lattice point."""
        affine = np.eye(4)
        affine[:3, :3], affine[:3, 3] = self.basis.T, self.origin
        return affine

    @property
    def voxel_size(self) -> float:
        """Edge of a cube with a voxel's volume."""
        return self._voxels.voxel_size()

    @property
    def neighbors(self) -> np.ndarray:
        """(m, 3) int32: the lattice vectors to which the columns of fields of links belong; (0, 3) without such fields."""
        return np.array(self._voxels.neighbors(), np.int32).reshape(-1, 3)

    @property
    def fraction_labels(self) -> List[int]:
        """The labels to which the columns of label_fractions belong; [] without that field."""
        return list(self._voxels.fraction_labels())

    @property
    def progress(self) -> float:
        """The share of the call's work that was done when these voxels came, 0 to 1."""
        return self._voxels.progress


class Grid(Bricks):
    """The voxels of a file, in its order of bricks."""

    @functools.cached_property
    def report(self) -> Dict[str, Any]:
        """All facts about the voxels: the object that `latvox info --json` prints."""
        return json.loads(self._voxels.report)

    @property
    def lattice(self) -> str:
        """ "cartesian", "bcc", "fcc", "hexagonal", "stretched-" and one of these, or "basis". "" means unknown."""
        return self.report["metadata"].get("latvox_lattice", "")

    @property
    def digest(self) -> str:
        """Identifies the set of voxels: equal sets have equal digests. "" if the file does not tell."""
        return self.report["metadata"].get("latvox_digest", "")

    @property
    def index_box(self) -> Optional[Tuple[np.ndarray, np.ndarray]]:
        """Low and high corner of the smallest box of the voxels, low <= ijk < high; None: there is no voxel."""
        box = self._voxels.index_box()
        return None if box is None else (np.array(box[0], np.int32), np.array(box[1], np.int32))

    def dense(
        self, field: Optional[str] = None, box: Optional[Tuple[_Point, _Point]] = None
    ) -> Dense:
        """Returns an array with an element for each lattice point.

        field: the field whose values it has. Where there is no voxel, they are those of a .npz: float32 is NaN, int32
            is -1, and others are 0. None: True for voxels.
        box: (low, high), two lattice points: low <= ijk < high. None: index_box, with the call's dims and pad.

        Errors: KeyError for a field that the voxels do not carry; InvalidArgument for a box that is none, or if the
        voxels do not fit into dims; ResourceExhausted for more than 2**30 points.
        Memory: a byte for each point, and the bytes of the field.
        """
        data, low = self._voxels.dense(None if box is None else _corners(box), _name(field or ""))
        affine = self.affine
        affine[:3, 3] += self.basis.T @ np.array(low)
        return Dense(data, low, affine)

    def save(
        self,
        path: Union[str, bytes, os.PathLike],
        npy: str = "coordinates",
        *,
        array: Union[None, str, Sequence[str]] = None,
        allow_http: bool = False,
    ) -> None:
        """Writes a file in the format of its extension, as `latvox voxelize -o` does; see EXTENSIONS.

        An existing file is replaced, once the new one is complete.
        path: also "s3://BUCKET/KEY", or the URL of a web server that takes files.
        npy: content of a .npy, "coordinates" or "dense".
        allow_http: whether an http: URL may be of another machine. Everybody in between can read and change the file.
        array: fields of a file that cannot hold all, such as .nii; or "none". None: the call's array, else all fields.

        Warnings: latvox.VoxelizeWarning, if the file lacks something although its format holds the fields.
        """
        if npy not in ("coordinates", "dense"):
            limit = "coordinates, dense"
            text = f'npy: "{npy}" is not one of {limit}'
            raise InvalidArgument(text, reason="BAD_SPEC", field="npy", value=str(npy), limit=limit)
        if not isinstance(allow_http, (bool, np.bool_)):
            raise TypeError(f"allow_http: {allow_http!r} is not True or False")
        fields = ""
        if array is not None:
            fields = _names("array", array)
            if not fields:
                raise InvalidArgument('array: is empty; "none" selects no field', reason="BAD_SPEC", field="array")
        warn(self._voxels.save(checked_path("path", path), npy == "dense", fields, allow_http), 2)

    def _repr_png_(self) -> Optional[bytes]:
        """Returns a picture, for notebooks. The answer of a stream has none: its batches had the voxels. Errors: as
        save."""
        if self._voxels.is_streamed:
            return None
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "voxels.png"
            self.save(path)
            return path.read_bytes()

    def __repr__(self) -> str:
        """Returns a line about the voxels."""
        fields = f", fields {self.fields}" if self.fields else ""
        name = type(self).__name__
        return f"<latvox.{name}: {len(self)} voxels, {self.lattice}, voxel size {self.voxel_size:g}{fields}>"


class Voxels(Grid):
    """The answer of a call."""

    @functools.cached_property
    def report(self) -> Dict[str, Any]:
        """All facts about the call: the object that `latvox voxelize --json` prints."""
        return json.loads(self._voxels.report)

    @property
    def certificate(self) -> Dict[str, Any]:
        """What is proved or checked about the voxels: report["certificate"]."""
        return self.report["certificate"]

    @property
    def lattice(self) -> str:
        """ "cartesian", "bcc", "fcc", "hexagonal", "stretched-" and one of these, or "basis"."""
        return self.report["lattice"]

    @property
    def digest(self) -> str:
        """Identifies the set of voxels: equal sets have equal digests."""
        return self.report["digest"]

    @functools.cached_property
    def warnings(self) -> List[VoxelizeWarning]:
        """What is probably not meant, in the order of its discovery. Python's warnings have shown them."""
        return [VoxelizeWarning(each["message"], each["code"], each["element"]) for each in self.report["warnings"]]

    def warn(self, depth: int) -> None:
        """Shows the warnings, at the caller of `depth` functions."""
        for warning in self.warnings:
            if warning.code not in _NOTES:
                python_warnings.warn(warning, stacklevel=depth)
