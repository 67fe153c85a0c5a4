"""Errors and warnings of latvox."""

from __future__ import annotations

import os
import warnings
from typing import Any, List, Optional, Tuple


class Error(Exception):
    """A call that failed. Its text names the field, the value and the limit, as far as they are known."""

    code = "UNKNOWN"  # the protocol's: one for each subclass
    reason: Optional[str] = None  # UPPER_SNAKE_CASE, for programs, such as "BAD_SPEC"
    field: Optional[str] = None  # the wrong field or keyword argument
    value: Optional[str] = None  # its value
    limit: Optional[str] = None  # the allowed limit
    other: Optional[str] = None  # the field that excludes `field`, if the two together are wrong
    retry_after: Optional[float] = None  # seconds after which the same call may succeed

    def __init__(self, message: str, **facts: Any) -> None:
        super().__init__(message)
        self.__dict__.update(facts)


class InvalidArgument(Error, ValueError):
    """The request or the mesh is wrong."""

    code = "INVALID_ARGUMENT"


class NotFound(Error, FileNotFoundError):
    """There is no such file."""

    code = "NOT_FOUND"


class FailedPrecondition(Error, RuntimeError):
    """A file cannot be read or written, or a client is closed or belongs to another process."""

    code = "FAILED_PRECONDITION"


class ResourceExhausted(Error):
    """A limit of the server is exceeded, or the server is full, or memory does not suffice."""

    code = "RESOURCE_EXHAUSTED"


class Unavailable(Error, ConnectionError):
    """No server could be reached, started or kept."""

    code = "UNAVAILABLE"


class DeadlineExceeded(Error, TimeoutError):
    """The timeout has passed."""

    code = "DEADLINE_EXCEEDED"


class Cancelled(Error):
    """The call was cancelled."""

    code = "CANCELLED"


class Unauthenticated(Error, PermissionError):
    """The server requires another token."""

    code = "UNAUTHENTICATED"


class Internal(Error):
    """A defect of latvox."""

    code = "INTERNAL"


class DataLoss(Error):
    """The server broke the protocol."""

    code = "DATA_LOSS"


class VoxelizeWarning(UserWarning):
    """Doubts about a result, although there was no error."""

    def __init__(self, message: str, code: str, element: str) -> None:
        super().__init__(message)
        self.message = message  # a sentence for people
        self.code = code  # UPPER_SNAKE_CASE, for programs
        self.element = element  # where: "line 7", "vertex 5"; "": the whole

    def __reduce__(self) -> tuple:
        return VoxelizeWarning, (self.message, self.code, self.element)


def warn(found: List[Tuple[str, str, str]], depth: int) -> None:
    """Shows warnings of the module _latvox, at the caller of `depth` functions."""
    for message, code, element in found:
        warnings.warn(VoxelizeWarning(message, code, element), stacklevel=depth + 1)


def checked_path(name: str, path: Any) -> bytes:
    """Returns the bytes of a path, as the system has them: they need not be UTF-8.

    Errors: TypeError for what is no path; InvalidArgument for a NUL, where the system would end the name, and for
    characters that no name of a file can have.
    """
    if not isinstance(path, (str, bytes, os.PathLike)):
        raise TypeError(f"{name}: {path!r} is no path: no str, bytes or os.PathLike")
    text = os.fspath(path)

    def bad(what: str, limit: str) -> InvalidArgument:
        return InvalidArgument(f"{name}: {text!r} {what}", reason="BAD_SPEC", field=name, value=repr(text), limit=limit)

    try:
        encoded = os.fsencode(text)
    except UnicodeEncodeError as error:
        limit = f"characters of {error.encoding}"
        raise bad(f"has characters that are not of {error.encoding}", limit) from None
    if b"\0" in encoded:
        raise bad("has a NUL character; a name has no NUL", "no NUL")
    return encoded


def refuse_path(name: str, given: Any) -> None:
    """Throws TypeError if one path is given in place of a list: a text would be a list of letters."""
    if isinstance(given, (str, bytes, os.PathLike)):
        raise TypeError(f"{name}: {given!r} is one path; pass a list")


_BY_CODE = {kind.code: kind for kind in Error.__subclasses__()}


def error_of(code: str, message: str, facts: dict) -> Error:
    """Returns the error of a status. The module _latvox calls it."""
    error = _BY_CODE.get(code, Error)(message, **facts)
    error.code = code
    return error
