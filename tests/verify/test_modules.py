"""Checks includes against the libraries: dependencies have no cycles, and each folder name is used once.

A module is a library, declared with flatspeckle_module(name ... LINK ...) in a CMakeLists.txt; a part is a folder in it.
With --update, writes the picture of the modules into CONTRIBUTING.md.
"""

import collections
import re
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "CONTRIBUTING.md"
LIBRARIES = ["core", "flatland", "wave_solver", "grin", "mc"]
PRODUCT = LIBRARIES + ["apps"]
CODE = PRODUCT + ["bench"]
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
PICTURE = re.compile(r"(?<=```mermaid\n).*?(?=```)", re.DOTALL)
MODULE = re.compile(r"^flatspeckle_module\((\w+)([^)]*)\)", re.MULTILINE)


def sources(root, folders):
    """Returns the paths of C++ files below the folders, relative to the root."""
    files = (file for folder in folders for file in (root / folder).rglob("*"))
    return sorted(file.relative_to(root) for file in files if file.suffix in (".h", ".cpp"))


def includes(root, file):
    """Returns the files of the project that a file includes."""
    return [Path(name) for name in INCLUDE.findall((root / file).read_text())]


def modules(root):
    """Returns {folder: folders of the modules that it links}, from CMake's declarations."""
    folders, links = {}, {}
    for file in root.glob("**/CMakeLists.txt"):
        for name, words in MODULE.findall(file.read_text()):
            folders[name] = str(file.parent.relative_to(root))
            links[name] = re.findall(r"flatspeckle::(\w+)", words)
    return {folders[name]: [folders[link] for link in links[name]] for name in folders}


def reachable(graph):
    """Returns {node: all nodes reachable from it, including itself}."""
    def reach(node, seen):
        for target in graph.get(node, ()):
            if target not in seen:
                seen.add(target)
                reach(target, seen)
        return seen
    return {node: reach(node, {node}) for node in graph}


def circles(graph):
    """Returns pairs of different nodes that are reachable from each other."""
    reach = reachable(graph)
    return [(a, b) for a in graph for b in reach[a] if a < b and a in reach.get(b, ())]


def module_of(file, folders):
    """Returns the innermost module that contains a file; None for programs."""
    inside = [folder for folder in folders if file.is_relative_to(folder)]
    return max(inside, key=len, default=None)


def arrows_up(root):
    """Returns includes of modules that the including module does not link: (file, included file)."""
    links = modules(root)
    allowed = reachable(links)
    found = []
    for file in sources(root, PRODUCT):
        here = module_of(file, links)
        for target in includes(root, file):
            there = module_of(target, links)
            outside = there is None and target.parts[0] in ("apps", "bench", "tests") and here is not None
            if outside or (here and there and there not in allowed[here]):
                found.append((str(file), str(target)))
            if target.parts[0] in ("bench", "tests") and file.parts[0] != "bench":
                found.append((str(file), str(target)))
    return found


def picture(root):
    """Returns a Mermaid diagram of the modules that include each other, without arrows that others imply."""
    graph = collections.defaultdict(set)
    folders = modules(root)
    for file in sources(root, PRODUCT):
        here = module_of(file, folders) or file.parts[0]
        graph[here] |= {module_of(target, folders) or target.parts[0] for target in includes(root, file)} - {here}
    reach = reachable(graph)
    arrows = [f"  {here} --> {there}\n" for here in sorted(graph) for there in sorted(graph[here])
              if not any(there in reach[other] for other in graph[here] - {there})]
    return "flowchart TD\n" + "".join(arrows)


def part_graph(root, folders):
    """Returns {folder: folders that its files include}."""
    graph = collections.defaultdict(set)
    for file in sources(root, folders):
        graph[str(file.parent)] |= {str(target.parent) for target in includes(root, file)
                                    if target.parts[0] in CODE} - {str(file.parent)}
    return graph


def repeated_folders(root):
    """Returns {name: folders} of parts that share a name."""
    places = collections.defaultdict(set)
    for file in sources(root, LIBRARIES):
        places[file.parent.name].add(str(file.parent))
    return {name: sorted(folders) for name, folders in places.items() if len(folders) > 1}


class Modules(unittest.TestCase):
    def test_libraries_have_no_circle(self):
        self.assertEqual(circles(modules(ROOT)), [])

    def test_includes_go_down(self):
        self.assertEqual(arrows_up(ROOT), [])

    def test_picture_in_the_guide(self):
        """Failed? test_modules.py --update"""
        self.assertEqual(PICTURE.findall(GUIDE.read_text()), [picture(ROOT)])

    def test_parts_have_no_circle(self):
        self.assertEqual(circles(part_graph(ROOT, CODE)), [])

    def test_a_part_has_a_name_of_its_own(self):
        self.assertEqual(repeated_folders(ROOT), {})


class Planted(unittest.TestCase):
    """Tests the checks above in a small tree with one fault each."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)
        self.write("core/CMakeLists.txt", "flatspeckle_module(core SOURCES run/a.cpp)\n")
        self.write("mc/slab/CMakeLists.txt", "flatspeckle_module(mc_slab SOURCES layer.cpp LINK flatspeckle::core)\n")
        self.write("core/run/a.h", "struct A {\n};\n")
        self.write("core/keys/b.h", '#include "core/run/a.h"\nstruct B {\n};\n')
        self.write("mc/slab/layer.h", '#include "core/keys/b.h"\nclass Layer {\n};\n')

    def write(self, name, text):
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def test_nothing(self):
        self.assertEqual(arrows_up(self.root), [])
        self.assertEqual(circles(part_graph(self.root, CODE)), [])
        self.assertEqual(repeated_folders(self.root), {})

    def test_upward_include(self):
        self.write("core/run/a.cpp", '#include "mc/slab/layer.h"\n')
        self.assertEqual(arrows_up(self.root), [("core/run/a.cpp", "mc/slab/layer.h")])

    def test_picture(self):
        self.assertEqual(picture(self.root), "flowchart TD\n  mc/slab --> core\n")

    def test_circle_of_parts(self):
        self.write("core/run/a.cpp", '#include "core/keys/b.h"\n')
        self.assertEqual(circles(part_graph(self.root, CODE)), [("core/keys", "core/run")])

    def test_circle_of_libraries(self):
        self.write("core/CMakeLists.txt", "flatspeckle_module(core SOURCES run/a.cpp LINK flatspeckle::mc_slab)\n")
        self.assertEqual(circles(modules(self.root)), [("core", "mc/slab")])

    def test_repeated_folder(self):
        self.write("mc/run/other.h", "struct C {\n};\n")
        self.assertEqual(repeated_folders(self.root), {"run": ["core/run", "mc/run"]})


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        GUIDE.write_text(PICTURE.sub(picture(ROOT), GUIDE.read_text()))
        sys.exit()
    sys.exit(unittest.main())
