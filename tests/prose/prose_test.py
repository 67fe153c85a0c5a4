"""The English of pages, comments and messages keeps the limits of prose.py, which finds what is beyond them."""

import unittest

import prose


def messages(path, text):
    return [message for _, message in prose.read(path, text).findings]


class TheTree(unittest.TestCase):
    def test_pages_and_comments_keep_the_limits(self):
        files = prose.read_tree()
        for kind, least in ("page", 60), ("comment", 700):
            self.assertGreater(sum(file.kind == kind for file in files), least, kind)
        self.assertEqual("\n".join(prose.judge(files)), "")


class TheRules(unittest.TestCase):
    """Each rule finds an example of its own, and lets a plain sentence pass."""

    def test_every_habit_is_found(self):
        for habit, bad, plain in (
            ("'of which'", "It has three parts, of which the last is empty.", "It has three parts. The last is empty."),
            ("'but for'", "All tests pass but for the slow ones.", "All tests pass except the slow ones."),
            ("'for' in place of 'because'", "It waits, for it has no room.", "It waits, because it has no room."),
            ("opens with 'Of'", "Of several values, the least is taken.", "Of course the smallest value is taken."),
            ("a what-clause in place of a noun", "It costs more than what thinning takes.", "It shows what is missing."),
            ("'who has X, does Y'", "Who has a token, may call the server.", "Who may call the server?"),
        ):
            with self.subTest(habit):
                self.assertEqual([each.split(": ")[1] for each in messages("a.md", bad)], [habit])
                self.assertEqual(messages("a.md", plain), [])

    def test_habits_are_found_in_messages_of_programs(self):
        text = '// "quoted\nFail("All tests pass "\n     "but for the slow ones.");\n'
        self.assertEqual(
            prose.read("a.cc", text).findings, [(2, "habit: 'but for': All tests pass but for the slow ones.")]
        )

    def test_british_words_are_found_with_their_line(self):
        text = "One line.\n\nThe colours of neighbouring cells.\n"
        self.assertEqual(
            prose.read("a.md", text).findings,
            [(3, "spelling: colour is color in American English"), (3, "spelling: neighbour is neighbor in American English")],
        )

    def test_lines_of_pages_are_bounded_except_in_tables_and_code(self):
        line = "word " * 25
        self.assertEqual(messages("a.md", f"| {line} |\n\n```\n{line}\n```\n"), [])
        self.assertEqual(messages("a.md", f"{line}.\n"), ["126 characters in a line, 120 are allowed"])
        self.assertIn("characters in a line", messages("README.md", f"| {line} |\n")[0])

    def test_long_sentences_are_found(self):
        self.assertEqual(messages("a.md", "\n".join(["nine more short words stand in each of these"] * 5)), [])
        found = messages("a.md", "\n".join(["nine more short words stand in each of these"] * 6) + ".")
        self.assertEqual(found[0][:46], "54 words in a sentence, 45 are allowed: nine m")

    def test_means_and_shares_are_judged_by_page_and_room(self):
        def tree(length, long):
            words = [length] * (100 - long) + [40] * long
            text = "".join(f"// The{' word' * (n - 1)}.\n" for n in words)
            return prose.judge([prose.read("core/a/a.cc", text), prose.read("core/b/b.cc", "// One short sentence.\n")])

        self.assertEqual(tree(15, 10), [])
        self.assertEqual(tree(17, 11), ["core/a: 19.5 words a sentence (comments), 18 are allowed",
                                        "core/a: 11 % of sentences (comments) have more than 30 words, 10 % are allowed"])  # fmt: skip

    def test_a_few_habits_are_allowed_in_many_words(self):
        good, bad = "The tree holds all the words that it needs.\n" * 1000, "It has parts, of which one is empty.\n\n"
        for count in 3, 4:
            judged = prose.judge([prose.read("a.md", bad * count + good)])
            self.assertEqual(sum("habit" in each for each in judged), 0 if count == 3 else 4)


class WhatIsRead(unittest.TestCase):
    def sentences(self, path, text):
        return [(each.line, each.text) for each in prose.read(path, text).sentences]

    def test_pages_without_code_headings_and_links(self):
        text = "# A long heading of a page\n\nSee [this page](a.md) and\n`f(x)`. Next one is here.\n\n```\nof which what is code\n```\n- An item of a list\n- Another item is here\n\n| a cell of words | x |\n|---|---|\n"
        self.assertEqual(
            self.sentences("a.md", text),
            [(3, "See this page and Code."), (3, "Next one is here."), (9, "An item of a list"), (10, "Another item is here"),
             (12, "a cell of words")])  # fmt: skip

    def test_comments_of_each_language(self):
        for path, text in (
            ("a.cc", 'auto s = "// not a comment at all";\n// The first line and\n// the second one.\nint a;  // behind some code\n'),
            ("a.py", 's = "# not a comment at all"\n# The first line and\n# the second one.\na = 1  # behind some code\n'),
            ("a.sh", 's="# not a comment at all"\n# The first line and\n# the second one.\na=1 # behind some code\n'),
            ("a.proto", 's = "// not a comment at all"\n// The first line and\n// the second one.\nint a = 1;  // behind some code\n'),
        ):
            with self.subTest(path):
                self.assertEqual(self.sentences(path, text), [(2, "The first line and the second one."), (4, "behind some code")])

    def test_docstrings_and_indented_lists(self):
        text = 'def f():\n    """Says what it does.\n\n    And a second paragraph.\n    """\n'
        self.assertEqual([each for _, each in self.sentences("a.py", text)], ["Says what it does.", "And a second paragraph."])
        text = "// Two parameters:\n//   first   the one of them\n//   second  the other one here\n"
        self.assertEqual([each for _, each in self.sentences("a.cc", text)][-2:], ["the one of them", "the other one here"])

    def test_formulas_are_no_prose(self):
        self.assertEqual(self.sentences("a.cc", "//   E(a, b) = dx * (b*U - y) - dy * (a*U - x) + tie\n"), [])


if __name__ == "__main__":
    unittest.main()
