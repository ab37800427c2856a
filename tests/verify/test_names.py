"""Checks that no two classes, structs, unions or enums of the product and of bench share a name.

Namespaces are ignored. Only definitions at namespace scope count, whose line begins at the left margin; forward
declarations, specialisations of templates, types within a class or function, aliases and concepts do not.
"""

import collections
import re
import tempfile
import unittest
from pathlib import Path

from test_modules import CODE, ROOT, sources

DEFINED = re.compile(r"^(?:template\s*<.*>\s*)?(?:class|struct|union|enum class|enum)\s+(?:alignas\([^)]*\)\s*|\[\[[^]]*\]\]\s*)?"
                     r"(\w+)(?:\s+final)?\s*(?::(?!:)[^;{]*)?\{", re.MULTILINE)


def places_of_types(root):
    """Returns {name: "file:line" of each definition}."""
    found = collections.defaultdict(list)
    for file in sources(root, CODE):
        text = (root / file).read_text()
        for match in DEFINED.finditer(text):
            found[match.group(1)].append(f"{file}:{text.count(chr(10), 0, match.start()) + 1}")
    return found


def shared_names(root):
    return {name: places for name, places in sorted(places_of_types(root).items()) if len(places) > 1}


class Names(unittest.TestCase):
    def test_no_two_types_share_a_name(self):
        self.assertGreater(len(places_of_types(ROOT)), 500)
        shared = shared_names(ROOT)
        lines = "\n".join(f"{name}: {', '.join(places)}" for name, places in shared.items())
        self.assertEqual(len(shared), 0, f"{len(shared)} names of several types:\n{lines}")


class Planted(unittest.TestCase):
    """Tests which lines count as definitions, in a small tree."""

    def shared(self, header, source):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in (("core/a.h", header), ("bench/b.cpp", source)):
                (root / name).parent.mkdir()
                (root / name).write_text(text)
            return shared_names(root)

    def test_definitions_are_seen(self):
        for text in ("class Block {\n};\n", "struct Block : Base<int> {\n};\n", "enum class Block { one };\n",
                     "class Block final : public Base {\n};\n", "template <typename T>\nclass Block {\n};\n",
                     "template <std::vector<int> v>\n  requires(v)\nstruct Block\n    : Base {\n};\n",
                     "struct alignas(64) Block {\n};\n", "union Block {\n};\n", "enum Block : int {\n};\n",
                     "namespace {\nclass Block {};\n}\n"):
            with self.subTest(text=text):
                places = self.shared("#pragma once\nclass Block {\n};\n", text)
                self.assertEqual(list(places), ["Block"])
                self.assertIn("core/a.h:2", places["Block"])

    def test_others_are_not(self):
        for text in ("class Block;\n", "struct Outer {\n  struct Block {\n  };\n};\n", "using Block = int;\n",
                     "template <>\nstruct Block<int> {\n};\n", "struct Block::Inner {\n};\n", "class Other {\n};\n",
                     "// class Block {\n", "struct Block make() {\n}\n"):
            with self.subTest(text=text):
                self.assertEqual(self.shared("class Block {\n};\n", text), {})


if __name__ == "__main__":
    unittest.main()
