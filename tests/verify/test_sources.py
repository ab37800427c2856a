#!/usr/bin/env python3
"""Checks that every key cited by headers and docs/theory.md, such as [bar2019], is an entry of docs/references.bib,
and that the theory page cites each entry."""

import re
import unittest

from test_modules import CODE, ROOT, sources

CITED = re.compile(r"\[([a-z]+(?:19|20)\d\d)\]")
ENTRY = re.compile(r"^@\w+\{(\w+),", re.MULTILINE)


class Sources(unittest.TestCase):
    def setUp(self):
        self.entries = ENTRY.findall((ROOT / "docs" / "references.bib").read_text())
        self.theory = CITED.findall((ROOT / "docs" / "theory.md").read_text())

    def test_each_entry_is_cited_by_the_theory_page(self):
        self.assertGreater(len(self.entries), 50)
        self.assertEqual(len(self.entries), len(set(self.entries)))
        self.assertEqual(sorted(set(self.theory)), sorted(self.entries))

    def test_headers_cite_entries(self):
        cited = {(str(file), key) for file in sources(ROOT, CODE) for key in CITED.findall((ROOT / file).read_text())}
        self.assertGreater(len({key for _, key in cited}), 40)
        self.assertEqual([pair for pair in sorted(cited) if pair[1] not in self.entries], [])


if __name__ == "__main__":
    unittest.main()
