"""docs/format.md shows the tables of the program, and result files agree with them: every dataset and
attribute has a row, and every row occurs in some file. With --update it writes the tables of the
program into the document."""

import itertools
import re
import subprocess
import sys
import unittest

import h5py
import numpy as np

from format_scenes import ResultsTest
from program import DATA, PROGRAM

DOCUMENT = DATA.parent / "docs" / "format.md"
MARKED = re.compile(r"<!-- datasets: (.*?) -->\n.*?<!-- end -->\n", re.DOTALL)
OF_HDF5 = {"CLASS", "NAME", "DIMENSION_LIST", "DIMENSION_LABELS", "REFERENCE_LIST"}
TABLES = subprocess.run([PROGRAM, "datasets"], capture_output=True, text=True, check=True).stdout


def members(file, kind=h5py.Dataset):
    """Returns {name: object} of all groups."""
    found = {}
    file.visititems(lambda name, item: found.update({name: item} if isinstance(item, kind) else {}))
    return found


def is_scale(dataset):
    return dataset.attrs.get("CLASS") == b"DIMENSION_SCALE"


def of_method(name):
    """Returns its name in the tables, which share rows among groups of methods, states and sensors."""
    return re.sub(r"^(mc|wave|state/\w+|sensors/[\w-]+)(/|$)", "", name)


def cells_of_tables():
    """Returns the cells of each row, by the heading of their first column."""
    found = {"word": [], "dataset": [], "attribute": []}
    for line in TABLES.splitlines():
        cells = [cell.replace("\\|", "|").replace("`", "").strip()
                 for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if cells and cells[0] in found:
            heading = cells[0]
        elif cells and not cells[0].startswith("---"):
            found[heading].append(cells)
    return found


CELLS = cells_of_tables()
ROLES = {word: meanings.split(" or ") for word, meanings in CELLS["word"]}


def meanings(words):
    """Yields the possible axes or units: of the axes of a sweep any, in their order."""
    choices = [ROLES.get(word, [word]) for word in words.split()]
    for choice in itertools.product(*choices):
        every = " ".join(choice).split()
        optional = ROLES["GRID"][0].split() if "GRID" in words else []
        for count in range(len(optional) + 1):
            for left_out in itertools.combinations(optional, count):
                yield " ".join(word for word in every if word not in left_out)


def expected_datasets():
    """Returns {(name, type, axes, units, long name): row}."""
    found = {}
    for number, (name, kind, axes, units, long_name) in enumerate(CELLS["dataset"]):
        for both in itertools.product(meanings(axes), meanings(units)):
            found[name.rstrip(" ±≤"), kind, *both, long_name] = number
            if name.endswith(" ≤"):
                found[name[:-2] + "_limit", "float64", *both, "largest allowed: " + long_name] = number
            if name.endswith(" ±"):
                found[name[:-2] + "_error", "float64", *both, "standard error: " + long_name] = number
                found[name[:-2] + "_rare", "uint64", both[0], "1",
                      "1 where a few batches dominate the standard error: " + long_name] = number
    return found


EXPECTED = expected_datasets()
ATTRIBUTES = {(of, name, kind) for name, of, kind, _ in CELLS["attribute"]}


def type_of(item):
    if h5py.check_string_dtype(item.dtype):
        return "text" if item.shape == () else "texts"
    return {"complex128": "complex", "uint8": "bool"}.get(item.dtype.name, item.dtype.name)


SWEPT = {}  # file name -> keys


def swept_keys(file):
    """Returns the keys that are axes: those of a sweep of another subcommand, or of a search."""
    if file.filename in SWEPT:
        return SWEPT[file.filename]
    search = file["search"].attrs["swept"] if "search" in file else []
    return SWEPT.setdefault(file.filename, [key.replace(".", "_") for key in [*file.attrs.get("swept", []), *search]])


def axes_of(dataset):
    if is_scale(dataset):
        numbers = np.array_equal(dataset[()], np.arange(len(dataset)))
        return ("0, 1, ...", "scale") if numbers else ("scale",)
    names = [of_method(axis[0].name[1:]) if len(axis) else "no scale" for axis in dataset.dims]
    own = [name for name in names if name not in [*swept_keys(dataset.file), "swept_point"]]
    swept = ["SWEPT"] if len(own) < len(names) else []
    return tuple({" ".join(own) or "scalar", " ".join(swept + own) or "scalar"})


class Document(unittest.TestCase):
    def test_document(self):
        marked = "".join(found.group() for found in MARKED.finditer(DOCUMENT.read_text()))
        self.assertEqual(marked, TABLES, "put what `flatspeckle datasets` prints there (--update)")


class Format(ResultsTest):
    def check_datasets(self, file):
        for name, dataset in members(file).items():
            if name.split("/")[-1].removesuffix("_word") in swept_keys(file):
                continue
            axes, unit, long_name = axes_of(dataset), dataset.attrs.get("units", ""), dataset.attrs["long_name"]
            found = [(of_method(name), type_of(dataset), each, unit, long_name) for each in axes]
            rows = [EXPECTED[each] for each in found if each in EXPECTED]
            self.assertEqual(len(rows), 1, found)
            self.met.update(rows)
            self.seen.update(axes, [unit])

    def test_datasets(self):
        self.met, self.seen = set(), set()
        self.on_each_file(self.check_datasets)
        met = [CELLS["dataset"][number] for number in self.met]
        for row in CELLS["dataset"]:  # sensors share some rows
            self.assertIn(row, met)
        axes = set(" ".join(self.seen).split())
        for word, choices in ROLES.items():
            for name in " ".join(choices).split():
                self.assertIn(name, axes, word)

    def check_attributes(self, file):
        for name, item in [("", file), *members(file, (h5py.Dataset, h5py.Group)).items()]:
            for key in set(item.attrs) - OF_HDF5 - {"units", "long_name"}:
                kind = item.attrs.get_id(key)
                many = "s" if kind.dtype.name == "float64" and kind.shape else ""
                self.met.add((of_method(name), key, type_of(kind) + many))

    def test_attributes(self):
        self.met = set()
        self.on_each_file(self.check_attributes)
        only_of_undefined = {("", "undefined", "texts")}  # only in results that are not finite
        self.assertEqual(self.met, ATTRIBUTES - only_of_undefined)

    def check_values(self, file):
        for name, dataset in members(file).items():
            if dataset.dtype != object:
                self.assertTrue(np.all(np.isfinite(dataset[()])), name)
            for axis, extent in zip(dataset.dims, dataset.shape):
                if len(axis) > 0:
                    self.assertEqual((len(axis), axis[0].shape), (1, (extent,)), name)
                    self.assertEqual(axis.label, axis[0].name.split("/")[-1])

    def test_finite_and_on_scales(self):
        self.on_each_file(self.check_values)


def update():
    tables = {found.group(1): found.group() for found in MARKED.finditer(TABLES)}
    DOCUMENT.write_text(MARKED.sub(lambda found: tables[found.group(1)], DOCUMENT.read_text()))


if __name__ == "__main__":
    update() if sys.argv[1:] == ["--update"] else unittest.main()
