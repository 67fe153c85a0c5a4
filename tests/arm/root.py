"""Makes a folder with Debian's libraries for 64-bit ARM, as this machine's release has them: those that latvox is built
with. Does nothing if they are there. Usage: root.py FOLDER"""

import os
import pathlib
import re
import shutil
import sys
import tempfile

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "tests/deploy"))

import debian_root  # noqa: E402

LIBRARY = re.compile(r"^build +((?!python|pybind)\S+-dev)\b", re.MULTILINE)
GENERATORS = ("protoc", *(f"grpc_{language}_plugin" for language in ("cpp", "csharp", "node", "objective_c", "php", "python", "ruby")))


def make(folder, packages):
    """Unpacks packages with all that they depend on. Nothing is configured, because that would run programs for ARM."""
    options = ["--architectures=arm64", "--variant=extract", f"--include={','.join(packages)}"]
    # From Debian 13 on, packages assume this link, which a package makes that is not unpacked.
    options += ['--setup-hook=mkdir -p "$1/usr/lib" && ln -s usr/lib "$1/lib"']
    with tempfile.TemporaryDirectory(dir=folder.parent) as part:
        archive = pathlib.Path(part) / "root.tar"
        debian_root.bootstrap(archive, *options, release=debian_root.OWN_RELEASE)
        unpacked = pathlib.Path(part) / "root"
        unpacked.mkdir()
        debian_root.run("tar", "--extract", "--file", archive, "--directory", unpacked, timeout=600)
        stay_inside(unpacked)
        use_generators_of_this_machine(unpacked)
        (unpacked / "packages").write_text("\n".join(packages))
        shutil.rmtree(folder, ignore_errors=True)
        unpacked.rename(folder)


def stay_inside(root):
    """Makes absolute links and CMake's absolute paths lead into the folder."""
    for path in (root / "usr").rglob("*"):
        if path.is_symlink() and (target := os.readlink(path)).startswith("/"):
            path.unlink()
            path.symlink_to(os.path.relpath(root / target[1:], path.parent))
        elif path.suffix == ".cmake":
            path.write_text(re.sub(r'"/usr(?=["/])', '"${CMAKE_SYSROOT}/usr', path.read_text()))


def use_generators_of_this_machine(root):
    """CMake takes the generators of code from the same folder as the libraries."""
    (root / "usr/bin").mkdir(exist_ok=True)
    for name in GENERATORS:
        program = root / "usr/bin" / name
        program.unlink(missing_ok=True)
        program.symlink_to(f"/usr/bin/{name}")


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    packages = LIBRARY.findall((REPOSITORY / "deploy/packages").read_text())
    kept = folder / "packages"
    if not kept.exists() or kept.read_text().split() != packages:
        debian_root.require_programs("arm", "mmdebstrap")
        folder.parent.mkdir(parents=True, exist_ok=True)
        make(folder, packages)


if __name__ == "__main__":
    main()
