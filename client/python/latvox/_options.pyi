"""Types of keyword arguments, for editors and type checkers. Made by client/python/stubs/options_stub.py."""

import os
from typing import Any, Literal, Optional, Sequence, TypedDict, Union

import numpy as np

_Integer = Union[int, np.integer]
_Number = Union[float, np.integer, np.floating]
_Numbers = Union[Sequence[Union[_Number, Sequence[_Number]]], np.ndarray[Any, Any], str]
_Path = Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]
_Names = Union[str, Sequence[str], np.ndarray[Any, Any]]
_Labels = Union[str, _Integer, Sequence[Union[str, _Integer]], np.ndarray[Any, Any]]

class RequestOptions(TypedDict, total=False):
    """Keywords of a request."""
    out: Optional[Union[_Path, Sequence[_Path]]]
    npy: Optional[Literal["coordinates", "dense"]]
    array: Optional[_Names]
    dims: Optional[_Numbers]
    pad: Optional[_Integer]
    lattice: Optional[Literal["cartesian", "bcc", "fcc", "hexagonal"]]
    basis: Optional[_Numbers]
    voxel_size: Optional[Union[_Number, _Numbers]]
    resolution: Optional[_Integer]
    origin: Optional[_Numbers]
    placement: Optional[Literal["points", "cells"]]
    align: Optional[_Path]
    set: Optional[Literal["surface", "supercover", "solid", "supercover-solid", "interior", "band", "links", "enclosed",
        "enclosed-interior", "region"]]
    rule: Optional[Literal["auto", "parity", "winding", "positive"]]
    force_open: Optional[bool]
    seed: Optional[_Numbers]
    close: Optional[_Number]
    leak_from: Optional[_Numbers]
    allow_outside: Optional[bool]
    band: Optional[Union[_Number, str]]
    side: Optional[Literal["both", "inside", "outside"]]
    fields: Optional[_Names]
    labels: Optional[Literal["part", "material"]]
    priority: Optional[_Labels]
    fraction_labels: Optional[_Labels]
    signed: Optional[bool]
    alpha_cutoff: Optional[_Number]
    separability: Optional[Literal[0, 1, 2, 26, 18, 6]]
    minimal: Optional[bool]
    algorithm: Optional[Literal["exact", "brute-force", "incremental", "optimized-incremental"]]
    verify: Optional[bool]
    upload: Optional[Literal["auto", "raw", "draco"]]
    quantization: Optional[Union[Literal["auto"], _Integer]]
    encoding: Optional[Literal["packed", "packed-zstd", "masks"]]
    region: Optional[_Numbers]
    bounds: Optional[_Numbers]
    shard: Optional[str]
    up_axis: Optional[Literal["z", "x", "y"]]
    scale: Optional[_Number]
    skip_bad: Optional[bool]
    input_format: Optional[Literal["drc", "obj", "ply", "stl", "off", "glb", "gltf", "3mf"]]
    strict: Optional[bool]
    weld_report: Optional[bool]

class CallOptions(TypedDict, total=False):
    """Keywords of a call, besides its request."""
    allow_http: Optional[bool]
    timeout: Optional[_Number]
    retries: Optional[_Integer]
    traceparent: Optional[str]

class ConnectionOptions(TypedDict, total=False):
    """Keywords of a connection."""
    server: Optional[_Names]
    threads: Optional[_Integer]
    tls: Optional[bool]
    tls_ca: Optional[_Path]
    tls_cert: Optional[_Path]
    tls_key: Optional[_Path]
    token_file: Optional[_Path]

class ClientOptions(ConnectionOptions, CallOptions, total=False):
    """Keywords of a client."""

class ClientCallOptions(RequestOptions, CallOptions, total=False):
    """Keywords of the calls of a client."""

class AllOptions(RequestOptions, CallOptions, ConnectionOptions, total=False):
    """Keywords of calls without a client."""
