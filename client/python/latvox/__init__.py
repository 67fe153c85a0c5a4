"""Exact voxelization on any 3D lattice.

    import latvox
    v = latvox.voxelize("bunny.stl", lattice="bcc", resolution=256)
    v.ijk, v.points, v.dense(), v.certificate
    v.save("bunny.vdb")

The page client/docs/python.md has more examples.
"""

from . import _latvox
from ._calls import EXTENSIONS, KEYWORDS, Client, Stream, stream, voxelize, voxelize_many
from ._errors import (
    Cancelled,
    DataLoss,
    DeadlineExceeded,
    Error,
    FailedPrecondition,
    Internal,
    InvalidArgument,
    NotFound,
    ResourceExhausted,
    Unauthenticated,
    Unavailable,
    VoxelizeWarning,
)
from ._files import convert, merge, open as open  # noqa: A004
from ._voxels import Bricks, Dense, Grid, Voxels

__version__ = _latvox.version

# Without open: `from latvox import *` must leave Python's own.
__all__ = [
    "EXTENSIONS",
    "KEYWORDS",
    "Bricks",
    "Cancelled",
    "Client",
    "DataLoss",
    "DeadlineExceeded",
    "Dense",
    "Error",
    "FailedPrecondition",
    "Grid",
    "Internal",
    "InvalidArgument",
    "NotFound",
    "ResourceExhausted",
    "Stream",
    "Unauthenticated",
    "Unavailable",
    "VoxelizeWarning",
    "Voxels",
    "convert",
    "merge",
    "stream",
    "voxelize",
    "voxelize_many",
]
