"""Files of voxels."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, Iterable, List, Literal, Optional, Sequence, Union

import numpy as np

from . import _latvox
from ._errors import InvalidArgument, checked_path, refuse_path, warn
from ._voxels import Grid

_Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


def _word(name: str, path: _Path) -> bytes:
    """Returns a path that does not look like an option."""
    text = checked_path(name, path)
    return b"./" + text if text.startswith(b"-") else text


def open(path: _Path) -> Grid:
    """Reads the voxels of a .vdb or .nvdb file, with their fields.

    The file may be of another program: a grid of bool, or a band as a grid of float with the name distance.

    Errors: NotFound; InvalidArgument for a file that has no such grid, or is no .vdb or .nvdb.
    """
    return Grid(_latvox.open(checked_path("path", path)))


def convert(
    path: _Path,
    out: Union[_Path, Sequence[_Path]],
    *,
    fields: Union[None, str, Sequence[str]] = None,
    npy: Optional[Literal["coordinates", "dense"]] = None,
    array: Union[None, str, Sequence[str]] = None,
    dims: Union[None, str, Sequence[int], np.ndarray] = None,
    pad: Union[None, int, np.integer[Any]] = None,
) -> None:
    """Writes the voxels of a .vdb or .nvdb file in other formats, as the tool's command convert does.

    out: a path, or a list of them; the formats are those of EXTENSIONS. They appear only if all of them succeed.
    fields: fields of the file to write, or "none"; None: all.
    npy, array, dims, pad: as for voxelize.

    Warnings: latvox.VoxelizeWarning. Errors: InvalidArgument, if the file lacks a field, or if a format cannot hold the
    fields or the lattice.
    """
    options: Dict[str, Any] = {"fields": fields, "npy": npy, "array": array, "dims": dims, "pad": pad}
    warn(_latvox.convert(_word("path", path), {"out": out, **options}), 2)


def merge(parts: Iterable[_Path], out: _Path) -> Dict[str, Any]:
    """Joins the parts of one mesh and request in a .vdb file, as the tool's command merge does.

    parts: .vdb or .nvdb files that were made with `region`, `bounds` or `shard`.

    Returns the object that `latvox merge --json` prints. The process may then open as many files as its hard limit
    allows, because all parts are open at once. Errors: InvalidArgument, if the parts do not belong together.
    """
    refuse_path("parts", parts)
    paths: List[bytes] = [_word("parts", part) for part in parts]
    if not paths:
        raise InvalidArgument("parts names no file; merge needs at least 1", field="parts", value="[]", limit="1")
    return json.loads(_latvox.merge(paths, checked_path("out", out)))
