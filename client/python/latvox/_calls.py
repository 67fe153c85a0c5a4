"""Clients and calls."""

from __future__ import annotations

import collections
import contextlib
import inspect
import operator
import os
import pathlib
import sys
import textwrap
import threading
from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    Optional,
    SupportsIndex,
    TextIO,
    Union,
)

from . import _latvox
from ._errors import InvalidArgument, Unavailable, refuse_path
from ._meshes import source_of
from ._voxels import Bricks, Voxels

if TYPE_CHECKING:  # Python 3.9 has no Unpack, and _options is a stub
    from typing_extensions import Unpack

    from ._options import AllOptions, ClientCallOptions, ClientOptions

KEYWORDS: Dict[str, Dict[str, str]] = _latvox.keywords()
EXTENSIONS: List[str] = _latvox.extensions()
Progress = Union[Callable[[float], Any], bool]


def _refuse_unknown(options: Mapping[str, Any], *scopes: str) -> None:
    """Throws TypeError for a name that is no keyword argument of these scopes."""
    for name in options:
        if KEYWORDS.get(name, {}).get("scope") in scopes:
            continue
        known = ", ".join(key for key, facts in KEYWORDS.items() if facts["scope"] in scopes)
        where = "; it belongs to latvox.Client" if name in KEYWORDS else ""
        raise TypeError(f"unexpected keyword argument '{name}'{where}; known are {known}")


_PROGRAMS = pathlib.Path(__file__).parent / "bin"
_latvox.set_program(os.fsencode(_PROGRAMS / "latvox"))


def _server() -> bytes:
    """Returns the server that is part of this package; empty: the one that $LATVOX_LATVOXD or $PATH names."""
    program = _PROGRAMS / "latvoxd"
    return b"" if os.environ.get("LATVOX_LATVOXD") or not program.exists() else os.fsencode(program)


def _begin(client: Client, mesh: Any, options: Mapping[str, Any], streams: bool = False) -> _latvox.Call:
    _refuse_unknown(options, "request", "call")
    fields = options.get("fields")
    fields = fields.tolist() if hasattr(fields, "tolist") else fields
    names = fields.split(",") if isinstance(fields, str) else list(fields) if isinstance(fields, Iterable) else []
    source = source_of(mesh, with_colors="color" in names)
    return _latvox.Call(client._connection, source, {**client._options, **options}, streams)


def _end(client: Client, call: _latvox.Call, progress: Optional[Progress], depth: int) -> Voxels:
    shown = _Shown(sys.stderr) if progress is True and sys.stderr is not None else None
    try:
        with _forgetting(client):
            voxels = Voxels(call.wait(shown if progress is True else progress or None))
    finally:
        if shown is not None:
            shown.end()
    if progress and progress is not True:
        progress(1.0)
    voxels.warn(depth + 2)
    return voxels


class _Shown:
    """The share of the work in a stream: a line that changes on a terminal, otherwise a line for each tenth."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._terminal = stream.isatty()
        self._last = 0  # percent

    def __call__(self, share: float) -> None:
        percent = int(share * 100)
        if not self._terminal:
            percent -= percent % 10
        if percent <= self._last:
            return
        self._last = percent
        text = f"latvox: {percent:3d} %"
        print(f"\r{text}" if self._terminal else text, end="" if self._terminal else "\n", file=self._stream, flush=True)

    def end(self) -> None:
        """Removes the line from a terminal."""
        if self._terminal and self._last > 0:
            print("\r\x1b[K", end="", file=self._stream, flush=True)


class Stream:
    """The batches of a running call, in order: an iterator of Bricks.

    The server waits while three batches wait. Leaving a `with` block, or dropping the stream, cancels the rest.
    """

    def __init__(self, client: Client, call: _latvox.Call) -> None:
        self._client = client
        self._call = call

    def __iter__(self) -> Stream:
        """Returns the iterator, which is the stream itself."""
        return self

    def __next__(self) -> Bricks:
        """Waits for the next batch."""
        with _forgetting(self._client):
            batch = self._call.next()
        if batch is None:
            raise StopIteration
        return Bricks(batch)

    def finish(self) -> Voxels:
        """Returns the answer with report, certificate and warnings. Call it after the last batch.

        The batches had the voxels. So its arrays, index_box, dense() and save() throw FailedPrecondition.
        Errors: those of the call; FailedPrecondition before the last batch.
        """
        return _end(self._client, self._call, None, 2)

    def cancel(self) -> None:
        """Ends the call soon."""
        self._call.cancel()

    def __enter__(self) -> Stream:
        """Returns the stream."""
        return self

    def __exit__(self, *_: Any) -> None:
        """Cancels the rest."""
        self.cancel()


class Client:
    """Connections to a server, or to several equal ones. Any threads may use a client at once.

    address: "HOST:PORT" or "unix:PATH", several with commas. None: a private server. It ends with the client, and with
        this process, even if that is killed.
    token: bearer token. The option token_file names a file that has one.
    options: of the connection, and defaults of calls. help(latvox.Client.__init__) lists them.

    Errors: Unavailable if no server can be reached or started; InvalidArgument.
    """

    def __init__(
        self, address: Optional[str] = None, *, token: Optional[str] = None, **options: Unpack[ClientOptions]
    ) -> None:
        """Connects, or starts a private server."""
        if address is not None and options.get("server") is not None:
            raise TypeError(f"address: {address!r} and server: {options['server']!r} exclude each other; pass one")
        _refuse_unknown(options, "connection", "call")
        if token is not None and not isinstance(token, str):
            raise TypeError(f"token: is no str, but {type(token).__name__}")  # without its value, which is a secret
        if token is not None and address is None and options.get("server") is None:
            raise InvalidArgument("token requires server", reason="BAD_SPEC", field="token")
        self._options: Dict[str, Any] = {**options} if address is None else {**options, "server": address}
        self._connection = _latvox.Connection(self._options, (token or "").encode("utf-8", "surrogatepass"), _server())

    def voxelize(
        self, mesh: Any, *, progress: Optional[Progress] = None, **options: Unpack[ClientCallOptions]
    ) -> Voxels:
        """Voxelizes a mesh, and waits for all voxels. See latvox.voxelize."""
        return _end(self, _begin(self, mesh, options), progress, 2)

    def stream(self, mesh: Any, **options: Unpack[ClientCallOptions]) -> Stream:
        """Begins to voxelize a mesh. See latvox.stream."""
        return Stream(self, _begin(self, mesh, options, streams=True))

    def voxelize_many(
        self, meshes: Iterable[Any], *, jobs: Optional[SupportsIndex] = None, **options: Unpack[ClientCallOptions]
    ) -> Iterator[Voxels]:
        """Voxelizes meshes, several at once. See latvox.voxelize_many."""
        refuse_path("meshes", meshes)
        return _many(self, meshes, _most(jobs), options)

    def close(self) -> None:
        """Ends the connection as soon as no call uses it. Further calls throw FailedPrecondition."""
        self._connection.close()

    def __enter__(self) -> Client:
        """Returns the client."""
        return self

    def __exit__(self, *_: Any) -> None:
        """Closes the client."""
        self.close()


def _most(jobs: Optional[SupportsIndex]) -> int:
    """Returns the most calls at once that `jobs` means."""
    if jobs is None:
        return len(os.sched_getaffinity(0))
    if isinstance(jobs, bool) or not hasattr(jobs, "__index__"):
        raise TypeError(f"jobs: {jobs!r} is not a whole number")
    most = operator.index(jobs)
    if most < 1:
        raise InvalidArgument(f"jobs: {most} is below 1", field="jobs", value=str(most), limit="1")
    return most


def _many(client: Client, meshes: Iterable[Any], most: int, options: Mapping[str, Any]) -> Iterator[Voxels]:
    calls: collections.deque[_latvox.Call] = collections.deque()
    try:
        for mesh in meshes:
            if len(calls) == most:
                yield _end(client, calls.popleft(), None, 2)
            calls.append(_begin(client, mesh, options))
        while calls:
            yield _end(client, calls.popleft(), None, 2)
    finally:
        for call in calls:
            call.cancel()


# Private servers of this process, by their number of threads.
_private: Dict[Optional[int], Client] = {}
_lock = threading.Lock()


def _after_fork() -> None:
    global _lock
    _lock = threading.Lock()  # another thread may have held it


os.register_at_fork(after_in_child=_after_fork)


def _choose(options: Mapping[str, Any]) -> tuple[Client, Dict[str, Any]]:
    """Returns the client that the options name, and the other options. None chooses nothing."""
    of_client = {name for name in options if KEYWORDS.get(name, {}).get("scope") == "connection"}
    others = {name: value for name, value in options.items() if name not in of_client}
    _refuse_unknown(others, "request", "call")
    chosen = {name: options[name] for name in of_client if options[name] is not None}
    if chosen.keys() - {"threads"}:
        return Client(chosen.pop("server", None), **chosen), others
    threads = chosen.get("threads")
    try:
        hash(threads)
    except TypeError:
        raise TypeError(f"threads: {threads!r} is not a whole number") from None
    with _lock:
        if threads not in _private:
            _private[threads] = Client(threads=threads)
        return _private[threads], others


@contextlib.contextmanager
def _forgetting(client: Client) -> Iterator[None]:
    """Forgets a lost private server, which does not come back: the next call starts another one."""
    try:
        yield
    except Unavailable:
        with _lock:
            for threads in [key for key, value in _private.items() if value is client]:
                del _private[threads]
        raise


def voxelize(mesh: Any, *, progress: Optional[Progress] = None, **options: Unpack[AllOptions]) -> Voxels:
    """Voxelizes a mesh, and waits for all voxels.

    mesh: a path. Or (vertices, faces), arrays of (n, 3) numbers and (m, 3) integers. Or a mesh of trimesh, meshio, VTK,
        PyVista or Open3D. Or a list of paths, or of other meshes: each is a part of one mesh, or several.
    progress: called with the share of the work that is done, from 0 to 1, which is the end. True: shows it on standard
        error, in a line that changes on a terminal, otherwise in a line for each tenth.
    options: those of the tool's command voxelize, with _ in place of -; listed below. Lists are sequences, flags are
        True or False.

    Without `server`, the first call starts a private server for this process, and later calls use it. Python can run
    other threads meanwhile. KeyboardInterrupt cancels the call.

    Errors: TypeError for an unknown keyword argument; a subclass of latvox.Error for anything else. Warnings:
    latvox.VoxelizeWarning.
    """
    client, others = _choose(options)
    return _end(client, _begin(client, mesh, others), progress, 2)


def stream(mesh: Any, **options: Unpack[AllOptions]) -> Stream:
    """Begins to voxelize a mesh, and returns its batches of bricks as they come. The memory is that of a few batches.

    mesh, options: as for voxelize.
    """
    client, others = _choose(options)
    return Stream(client, _begin(client, mesh, others, streams=True))


def voxelize_many(
    meshes: Iterable[Any], *, jobs: Optional[SupportsIndex] = None, **options: Unpack[AllOptions]
) -> Iterator[Voxels]:
    """Voxelizes meshes, several at once, and yields their voxels in the order of the meshes.

    jobs: the most calls at once, 1 or more; None: one for each core that this process may use. At most `jobs` answers
        are in memory. The server needs memory for each call, and fails some if it has too little.
    options: as for voxelize, the same for all.

    The first error ends it, and cancels the calls that run.
    """
    refuse_path("meshes", meshes)
    most = _most(jobs)
    client, others = _choose(options)
    return _many(client, meshes, most, others)


def _line(name: str, facts: Dict[str, str]) -> str:
    """Returns the description of a keyword argument, with the words or numbers that it takes."""
    text = f"{name}: {facts['help']}."
    if "|" in facts["value"] or "," in facts["value"]:
        text += f" Values: {facts['value'].rstrip('.')}."
    if facts["standard"]:
        text += f" Default: {facts['standard']}."
    return textwrap.fill(text, 119, initial_indent="    ", subsequent_indent="        ", break_on_hyphens=False)


def _describe(function: Callable, *scopes: str) -> None:
    """Adds the keyword arguments to a function's signature and documentation, for help() and notebooks."""
    known = {name: facts for name, facts in KEYWORDS.items() if facts["scope"] in scopes}
    signature = inspect.signature(function)
    parameters = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
    parameters += [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in known]
    function.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    lines = [_line(name, facts) for name, facts in known.items()]
    function.__doc__ = inspect.cleandoc(function.__doc__ or "") + "\n\nOptions:\n" + "\n".join(lines) + "\n"


_FUNCTIONS: List[Callable] = [voxelize, stream, voxelize_many]
_METHODS: List[Callable] = [Client.voxelize, Client.stream, Client.voxelize_many]
for _function in _FUNCTIONS:
    _describe(_function, "request", "call", "connection")
for _function in _METHODS:
    _describe(_function, "request", "call")
_describe(Client.__init__, "connection", "call")
