"""The programs' own descriptions: help, introduction and its examples, man pages, Markdown reference, completions."""

import functools
import os
import pathlib
import pty
import re
import select
import subprocess
import tempfile
import time
import unittest

from harness import BIN, PATIENCE, Case, latvox

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = {"latvox": ("latvox.1", ["man"]), "latvoxd": ("latvoxd.8", ["--man"])}


def run(*words, **options):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=PATIENCE, **options)
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


@functools.cache
def help_of(*words):
    return run(BIN / "latvox", *words, "--help")


def commands():
    """Returns the commands of latvox that its help lists."""
    listed = help_of().partition("\nCommands:\n")[2].partition("\n\n")[0]
    return re.findall(r"^  (\w+)", listed, re.M)


def described(text):
    """Returns the entries of a help text: pairs of an option's names with its value, and its description."""
    text = re.sub(r"\|\n {6}(?=\S)", "|", text)
    found = re.findall(r"^  (-\S.*?)(?:  +|\n {26})(.*(?:\n {26}.*)*)", text, re.M)
    return [(head, re.sub(r"\s+", " ", description)) for head, description in found]


def options(text):
    """Returns the long options that a help text defines."""
    return {name for head, _ in described(text) for name in re.findall(r"--[\w-]+", head)}


def helps():
    """Yields the name and the help text of each program and command."""
    yield "latvox", help_of()
    for name in commands():
        yield f"latvox {name}", help_of(name)
    yield "latvoxd", run(BIN / "latvoxd", "--help")


def entries(shown):
    """Returns the long options that a section of a page has entries for."""
    heads = re.findall(r"^       (-.*)", shown, re.M)
    return {name for head in heads for name in re.findall(r"--[\w-]+", head.partition("  ")[0])}


def examples(text):
    return [line[2:] for line in text.splitlines() if re.match(r"  (latvox|cp|echo|for|source) ", line)]


class Help(Case):
    def test_every_example_of_introduction_and_help_runs(self):
        self.assertEqual(latvox().returncode, 0)
        self.assertLess(len(latvox().stdout.splitlines()), 24, "longer than a terminal")
        lines = examples(latvox().stdout)
        self.assertGreater(len(lines), 3)
        for name in commands():
            found = examples(help_of(name))
            self.assertTrue(found or name in ("health", "limits"), name)
            lines += found
        environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}"}
        for line in lines:
            with self.subTest(line):
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", line], cwd=self.dir, env=environment,
                                      capture_output=True, text=True, timeout=PATIENCE)
                self.assertEqual(done.returncode, 0, done.stderr)
        made = {path.name for path in self.dir.iterdir()}
        wanted = {"bunny.vdb", "bunny.png", "bunny.csv", "bunny.glb", "bunny.drc", "voxels", "star.png", "whole.vdb"}
        self.assertLessEqual(wanted, made)

    def test_help_is_a_command_too(self):
        self.assertEqual(latvox("help").stdout, help_of())
        self.assertEqual(latvox("help", "slice").stdout, help_of("slice"))

    def test_options_are_in_groups(self):
        text = help_of("voxelize")
        for group in ("Mesh", "Lattice", "Voxels", "Part of the whole", "Output", "Transfer", "Server"):
            self.assertIn(f"\n{group}:\n", text)
        for option, group in (("--band", "Voxels"), ("--encoding", "Transfer"), ("--bounds", "Part of the whole")):
            self.assertRegex(text, rf"\n{group}:\n(?:.+\n)*? +{option}\b")

    def test_help_fits_a_terminal_and_shows_nothing_of_the_parser(self):
        for name, text in helps():
            with self.subTest(name):
                self.assertEqual([line for line in text.splitlines() if len(line) > 100], [])
                entries = text.partition("\nExamples:\n")[0]
                seams = r"\{|Excludes|Needs:|\[b, kb|:of |REQUIRED|\b(TEXT|INT|UINT|FLOAT)\b"
                self.assertIsNone(re.search(seams, entries))

    def test_help_describes_every_option_once(self):
        for name, text in helps():
            with self.subTest(name):
                found = described(text)
                names = [one for head, _ in found for one in re.findall(r"--?[a-z][\w-]*", head)]
                self.assertEqual(sorted(set(names)), sorted(names))
                self.assertIn("--help", names)
                self.assertEqual([head for head, description in found if not re.match(r"[A-Z].* ", description)], [])

    def test_help_shows_values_and_defaults(self):
        voxelize = dict(described(help_of("voxelize")))
        self.assertEqual(voxelize["--lattice cartesian|bcc|fcc|hexagonal"], "Named lattice (default: cartesian)")
        self.assertIn("--minimal, --no-minimal", voxelize)
        self.assertRegex(voxelize["-o, --out OUT"], r"\.vdb .*may be repeated; - is standard output\.")
        self.assertIn("(required)", dict(described(help_of("merge")))["-o, --out OUT"])
        self.assertIn("(2 to 65536; default: 256, ", voxelize["--resolution N"])
        latvoxd = dict(described(run(BIN / "latvoxd", "--help")))
        self.assertIn("(at least 1; default: 1GiB)", latvoxd["--max-mesh-bytes SIZE"])
        self.assertIn("(0 to 1024; default: 0)", latvoxd["--threads N"])
        self.assertIn("(default: 127.0.0.1:50151)", latvoxd["--listen ADDRESS"])

    def test_the_pages_know_the_options_and_no_others(self):
        pages = [ROOT / "README.md", *ROOT.glob("client/docs/*.md"), *ROOT.glob("server/docs/*.md")]
        written = [page for page in pages if page.name != "command-line.md"]  # that one is generated
        text = "\n".join(page.read_text() for page in written)
        of_latvox = options("\n".join(help_of(name) for name in commands()))
        of_latvoxd = options(run(BIN / "latvoxd", "--help"))
        self.assertGreater(len(of_latvox), 30)
        missing = {name for name in of_latvox if not re.search(rf"{name}\b(?!-)", text)}
        self.assertLessEqual(missing, {"--help"})
        tables = "\n".join(line for line in text.splitlines() if line.startswith("| `-"))
        named = set(re.findall(r"`(--[\w-]+)", tables))
        self.assertGreater(len(named), 20)
        self.assertLessEqual(named, of_latvox | of_latvoxd)


class ManPages(Case):
    def setUp(self):
        super().setUp()
        for program, (page, words) in PROGRAMS.items():
            (self.dir / page).write_text(run(BIN / program, *words))

    def shown(self, page):
        """Returns the text that a reader sees, without the extra strokes of bold and underlined letters."""
        return re.sub(r".\x08", "", run("mandoc", "-Tascii", "-O", "width=200", self.dir / page))

    def test_neither_man_nor_mandoc_complains(self):
        for page, _ in PROGRAMS.values():
            with self.subTest(page):
                path = self.dir / page
                self.assertEqual(run("mandoc", "-Tlint", "-W", "warning", path), "")
                command = ["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", path]
                environment = os.environ | {"LC_ALL": "C.UTF-8"}
                done = subprocess.run(command, capture_output=True, timeout=PATIENCE, env=environment)
                self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_every_option_of_the_help_is_in_the_page_of_its_command(self):
        text = self.shown("latvox.1")
        sections = dict(re.findall(r"^   latvox (\w+)\n(.*?)(?=^ {0,3}\w|\Z)", text, re.M | re.S))
        self.assertEqual(set(sections), set(commands()))
        for name, section in sections.items():
            with self.subTest(name):
                wanted = options(help_of(name))
                self.assertEqual(entries(section), wanted)
        self.assertIn("cartesian|bcc|fcc|hexagonal", sections["voxelize"])
        text = self.shown("latvoxd.8")
        section = text.partition("\nOPTIONS\n")[2].partition("\nEXIT")[0]
        self.assertEqual(entries(section), options(run(BIN / "latvoxd", "--help")))
        self.assertIn("LATVOX_MAX_JOBS", text)

    def test_pages_and_completions_are_installed_where_they_are_looked_for(self):
        """Also if they were not built. So is it after deploy/quickstart, which builds the programs alone."""
        prefix, build = self.dir / "prefix", pathlib.Path(os.environ["LATVOX_BUILD_DIR"])
        (build / "deploy/manual/share/man/man1/latvox.1").unlink(missing_ok=True)
        run("cmake", "--install", build, "--prefix", prefix)
        share = prefix / "share"
        for program, (page, _) in PROGRAMS.items():
            found = run("man", "-M", share / "man", "-w", program).strip()
            self.assertEqual(pathlib.Path(found).read_text(), (self.dir / page).read_text())
        for shell, path in (("bash", "bash-completion/completions/latvox"), ("zsh", "zsh/site-functions/_latvox"),
                            ("fish", "fish/vendor_completions.d/latvox.fish")):
            self.assertEqual((share / path).read_text(), latvox("completions", shell).stdout)


class Reference(Case):
    def test_the_kept_page_is_what_the_tool_prints(self):
        kept = (ROOT / "client/docs/command-line.md").read_text()
        self.assertEqual(kept, latvox("man", "markdown").stdout, "run: latvox man markdown > client/docs/command-line.md")

    def test_every_option_of_the_help_is_in_the_section_of_its_command(self):
        text = latvox("man", "markdown").stdout
        sections = dict(re.findall(r"^## latvox (\w+)\n(.*?)(?=^## |\Z)", text, re.M | re.S))
        self.assertEqual(set(sections), set(commands()))
        for name, section in sections.items():
            with self.subTest(name):
                heads = re.findall(r"^- `(-[^`]*)`:", section, re.M)
                self.assertEqual({one for head in heads for one in re.findall(r"--[\w-]+", head)},
                                 options(help_of(name)) - {"--help"})
        self.assertIn("Not with `--basis`, `--align`.", sections["voxelize"])

    def test_lines_of_text_are_short(self):
        text = re.sub(r"^```.*?^```$", "", latvox("man", "markdown").stdout, flags=re.M | re.S)
        breakable = [line for line in text.splitlines() if not re.fullmatch(r"- `[^`]*`:", line)]
        self.assertEqual([line for line in breakable if len(line) > 120], [])


LATTICES = {"cartesian", "bcc", "fcc", "hexagonal"}


class Completions(Case):
    def setUp(self):
        super().setUp()
        self.scripts = self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-"))
        for shell in ("bash", "fish"):
            pathlib.Path(self.scripts, shell).write_text(latvox("completions", shell).stdout)
        (self.dir / "a mesh.obj").write_text("")
        (self.dir / "folder").mkdir()

    def bash(self, *words):
        """Returns bash's completions of the last word."""
        script = ('source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1));'
                  '_latvox 2>/dev/null; printf "%s\\n" "${COMPREPLY[@]}"')
        done = run("bash", "-uc", script, f"{self.scripts}/bash", *words, cwd=self.dir)
        return set(done.splitlines()) - {""}

    def test_bash(self):
        self.assertEqual(self.bash("latvox", ""), set(commands()))
        self.assertEqual(self.bash("latvox", "vox"), {"voxelize"})
        self.assertEqual(self.bash("latvox", "--v"), {"--version"})
        self.assertEqual(self.bash("latvox", "voxelize", "--lat"), {"--lattice"})
        self.assertEqual(self.bash("latvox", "voxelize", "--lattice", ""), LATTICES)
        self.assertEqual(self.bash("latvox", "voxelize", "--lattice", "=", "h"), {"hexagonal"})
        self.assertEqual(self.bash("latvox", "voxelize", "--lattice", "="), LATTICES)
        self.assertEqual(self.bash("latvox", "voxelize", "a"), {"a mesh.obj"})
        self.assertEqual(self.bash("latvox", "voxelize", "--tls-ca", ""), {"a mesh.obj", "folder"})
        self.assertEqual(self.bash("latvox", "voxelize", "--resolution", ""), set())
        self.assertEqual(self.bash("latvox", "batch", "--out", ""), {"folder"})
        self.assertEqual(self.bash("latvox", "completions", ""), {"bash", "zsh", "fish"})
        for name in commands():
            self.assertEqual(self.bash("latvox", name, "--"), options(help_of(name)))

    def fish_lines(self, line):
        script = f"source {self.scripts}/fish; complete -C '{line}'"
        environment = os.environ | {"HOME": str(self.dir), "XDG_CONFIG_HOME": str(self.dir)}
        return run("fish", "-c", script, cwd=self.dir, env=environment).splitlines()

    def fish(self, line):
        return {found.split("\t")[0] for found in self.fish_lines(line)}

    def test_fish_tells_what_each_value_means(self):
        self.assertIn("bcc\tbody-centered cubic", self.fish_lines("latvox voxelize --lattice "))
        values = 0
        for name in commands():
            for head, _ in described(help_of(name)):
                for option in re.findall(r"(--[\w-]+) [\w-]+\|", head):
                    for line in self.fish_lines(f"latvox {name} {option} "):
                        self.assertRegex(line, r"^[\w.-]+\t.+", f"{name} {option}")
                        values += 1
        self.assertGreater(values, 50)

    def test_fish(self):
        self.assertLessEqual(set(commands()), self.fish("latvox "))
        self.assertEqual(self.fish("latvox voxelize --lattice "), LATTICES)
        self.assertEqual(self.fish("latvox voxelize --lattice=h"), {"--lattice=hexagonal"})
        self.assertEqual(self.fish("latvox completions "), {"bash", "zsh", "fish"})
        self.assertEqual(self.fish("latvox voxelize --resolution "), set())
        for name in commands():
            self.assertEqual(self.fish(f"latvox {name} --"), options(help_of(name)))

    def zsh(self, line):
        """Returns the line as interactive zsh completes it after a tab, without the space or slash that the next key
        removes."""
        master, slave = pty.openpty()
        path = f"{BIN}:{os.environ['PATH']}"
        environment = os.environ | {"PATH": path, "TERM": "dumb", "PS1": "> ", "ZDOTDIR": str(self.dir)}
        shell = subprocess.Popen(["zsh", "-f", "-i"], stdin=slave, stdout=slave, stderr=slave, cwd=self.dir,
                                 env=environment, start_new_session=True)
        os.close(slave)
        try:
            os.write(master, b"autoload -U compinit; compinit -u -D; source <(latvox completions zsh); echo rea''dy\n")
            self.read(master, "ready")
            os.write(master, line.encode() + b"\t")
            time.sleep(0.2)
            os.write(master, b"\x01print -r -- 'line:\x05:end'\n")
            return re.findall(r"^line:(.*):end", self.read(master, "\nline:[^\n]*:end"), re.M)[-1]
        finally:
            shell.kill()
            shell.wait()
            os.close(master)

    def read(self, master, until):
        text, deadline = "", time.monotonic() + PATIENCE
        while not re.search(until, text):
            self.assertGreater(deadline, time.monotonic(), text)
            if select.select([master], [], [], 0.1)[0]:
                text += os.read(master, 65536).decode(errors="replace").replace("\r", "\n")
        return text

    def test_zsh(self):
        for line, whole in (("latvox vox", "latvox voxelize"), ("latvox voxelize --lat", "latvox voxelize --lattice"),
                            ("latvox voxelize --lattice hex", "latvox voxelize --lattice hexagonal"),
                            ("latvox batch --out fol", "latvox batch --out folder")):
            with self.subTest(line):
                self.assertEqual(self.zsh(line), whole)


if __name__ == "__main__":
    unittest.main()
