"""The files of the packages that the list `sources` names."""

import dataclasses
import functools
import json
import pathlib
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
CACHE = HERE.parents[1] / "build/corpus"


@dataclasses.dataclass(frozen=True)
class Source:
    registry: str
    name: str
    version: str
    reason: str


@dataclasses.dataclass(frozen=True)
class MeshFile:
    package: str
    name: str  # below the package's root
    path: pathlib.Path

    def __str__(self):
        return f"{self.package} {self.name}"


def read_sources():
    sources = []
    for line in (HERE / "sources").read_text().splitlines():
        words, _, reason = line.partition("#")
        if words.strip():
            sources.append(Source(*words.split(), reason.strip()))
    return sources


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise SystemExit(f"corpus: {' '.join(map(str, command))} failed:\n{done.stdout}{done.stderr}")
    return done.stdout


def installed_files(source):
    """Lists the files of a package that is installed."""
    version = run("dpkg-query", "-W", "-f=${Version}", source.name)
    if version not in source.version.split("|"):
        raise SystemExit(f"corpus: {source.name} is installed as {version}; tests/corpus/sources names {source.version}")
    return [(line[1:], pathlib.Path(line)) for line in run("dpkg-query", "-L", source.name).splitlines()]


def files_below(root):
    return [(str(path.relative_to(root)), path) for path in root.rglob("*")]


def debian_files(source):
    """Lists the files of a package after unpacking it, without installing it."""
    root = CACHE / "debian" / f"{source.name}_{source.version}"
    if not root.exists():
        download = root.with_name("download")
        shutil.rmtree(download, ignore_errors=True)
        download.mkdir(parents=True)
        run("apt-get", "download", "-q", f"{source.name}={source.version}", cwd=download)
        (package,) = download.glob("*.deb")
        run("dpkg-deb", "--extract", package, download / "root")
        (download / "root").rename(root)
        shutil.rmtree(download)
    return files_below(root)


@functools.cache
def npm_folder():
    """Installs the packages of package-lock.json, which has their hashes."""
    folder = CACHE / "npm"
    folder.mkdir(parents=True, exist_ok=True)
    lock, done = HERE / "package-lock.json", folder / "node_modules/.package-lock.json"
    if not done.exists() or (folder / lock.name).read_bytes() != lock.read_bytes():
        for name in ("package.json", lock.name):
            shutil.copy(HERE / name, folder)
        run("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error", cwd=folder)
    return folder / "node_modules"


def npm_files(source):
    root = npm_folder() / source.name
    version = json.loads((root / "package.json").read_text())["version"]
    if version != source.version:
        raise SystemExit(f"corpus: package-lock.json has {source.name} {version}; tests/corpus/sources names {source.version}")
    return files_below(root)


LISTS = {"test": installed_files, "debian": debian_files, "npm": npm_files}


def extension_of(name):
    """Returns the extension in lower case, without .gz."""
    path = pathlib.PurePath(name.lower())
    return path.with_suffix("").suffix if path.suffix == ".gz" else path.suffix


def mesh_files(source, extensions):
    """Lists the package's files with these extensions, by name."""
    files = LISTS[source.registry](source)
    return sorted(
        (MeshFile(source.name, name, path) for name, path in files if extension_of(name) in extensions and path.is_file() and not path.is_symlink()),
        key=str,
    )
