"""Result files are what docs/format.md says: every dataset and attribute of every subcommand's
files is in its tables, and every entry of the tables is met by some file."""

import unittest

import h5py
import numpy as np

from format_document import Document, Found
from format_scenes import ResultsTest
from program import DATA

DOCUMENT = Document(DATA.parent / "docs" / "format.md")
OF_HDF5 = {"CLASS", "NAME", "DIMENSION_LIST", "DIMENSION_LABELS", "REFERENCE_LIST"}
TYPES = {np.dtype("float64"): "float64", np.dtype("complex128"): "complex",
         np.dtype("uint64"): "uint64", np.dtype(object): "texts"}
NUMBERED = {"light", "sensor", "pair", "parameter", "checkpoint", "point", "realization", "entry",
            "scatterer", "ray", "curve", "path_point", "curve_point", "cost", "cost_point", "case",
            "comparison"}
SMALL, CHUNK = 4096, 1 << 20  # bytes
ALWAYS_CHUNKED = {"field", "total_field"}


def members(file, kind=h5py.Dataset):
    """name -> object, all groups down."""
    found = {}
    file.visititems(lambda name, item: found.update({name: item} if isinstance(item, kind) else {}))
    return found


def without_method(name):
    return name.removeprefix("mc/").removeprefix("wave/")


def is_scale(dataset):
    return dataset.attrs.get("CLASS") == b"DIMENSION_SCALE"


def describe(dataset):
    """Axes by the full names of their scales, less the group of the dataset's method."""
    axes = tuple(without_method(axis[0].name[1:]) if len(axis) else None for axis in dataset.dims)
    return Found(TYPES.get(dataset.dtype), "scale" if is_scale(dataset) else axes,
                 dataset.attrs.get("units", "none"))


def attribute_type(attribute):
    """In the words of the document."""
    dtype = attribute.dtype
    if h5py.check_string_dtype(dtype):
        return "text" if attribute.shape == () else "texts"
    return "bool" if dtype == np.uint8 else dtype.name


class Format(ResultsTest):
    def row_of(self, run, dataset):
        """The one row of the run's sections that says what this dataset is, or nothing."""
        name = dataset.name[1:]
        of_method = name != without_method(name)
        rows = [row for star in ([of_method] if run.by_method else [False, True])
                for row in DOCUMENT.candidates(run.sections, without_method(name), star)]
        found = describe(dataset)
        matching = [row for row in rows if row.matches(without_method(name), found)]
        self.assertLessEqual(len(matching), 1, f"{name}: two rows say the same")
        if matching:
            matching[0].met.append(found)
            return matching[0]
        self.assertTrue(name.endswith("_error") and not rows,
                        f"{name} is {found}; rows: {[str(row) for row in rows]}")
        return None

    def check_datasets(self, run, file):
        for name, dataset in members(file).items():
            row = self.row_of(run, dataset)
            if row is None:
                self.check_error(run, file, name.removesuffix("_error"))
            else:
                self.assertEqual(name + "_error" in file, row.has_error, name)

    def check_error(self, run, file, name):
        self.assertIn(name, file)
        estimate, error = file[name], file[name + "_error"]
        self.assertTrue(self.row_of(run, estimate).has_error, name)
        expected = describe(estimate)
        self.assertEqual(describe(error), Found("float64", expected.axes, expected.units), name)
        self.assertEqual(error.shape, estimate.shape, name)
        self.assertTrue(np.all(error[()] >= 0), name)
        self.assertTrue(error.attrs["long_name"].startswith("standard error"), name)

    def test_datasets(self):
        """And the document is in the files: each row, in all its units and kinds of axes."""
        self.on_each_file(self.check_datasets)
        for row in DOCUMENT.rows:
            with self.subTest(row=str(row)):
                self.assertEqual(row.unmet(), [])

    def check_values(self, _, file):
        for name, dataset in members(file).items():
            if dataset.dtype != object:
                self.assertTrue(np.all(np.isfinite(dataset[()])), name)
            self.assertTrue(dataset.attrs["long_name"], name)

    def test_finite_and_described(self):
        self.on_each_file(self.check_values)

    def check_axes(self, _, file):
        for name, dataset in members(file).items():
            scales = [axis[0].name for axis in dataset.dims if len(axis) > 0]
            self.assertEqual(len(set(scales)), len(scales), f"{name}: one scale on two axes")
            for axis, extent in zip(dataset.dims, dataset.shape):
                if len(axis) > 0:
                    self.check_scale(axis, extent)

    def check_scale(self, axis, extent):
        scale = axis[0]
        self.assertEqual(len(axis), 1)
        self.assertEqual(axis.label, scale.name.split("/")[-1])
        self.assertTrue(is_scale(scale), scale.name)
        self.assertEqual(scale.dtype, np.float64)
        self.assertEqual(scale.shape, (extent,))
        self.assertTrue(scale.attrs["units"] and scale.attrs["long_name"], scale.name)
        first = axis.label.removesuffix("_2")
        if first in NUMBERED:
            np.testing.assert_array_equal(scale[()], np.arange(extent))
        if first != axis.label:
            np.testing.assert_array_equal(scale[()], scale.file[first][()])

    def test_axes(self):
        """One scale for each, whose name is the label, and none of them twice in a dataset."""
        self.on_each_file(self.check_axes)

    def check_storage(self, _, file):
        self.assertEqual(file.id.get_create_plist().get_version()[0], 0)
        for name, dataset in members(file).items():
            self.check_complex(dataset.id.get_type())
            small = dataset.nbytes <= SMALL and name not in ALWAYS_CHUNKED
            if small or dataset.dtype == object:
                self.assertIsNone(dataset.chunks, name)
                continue
            self.large += 1
            filters = (dataset.shuffle, dataset.compression, dataset.compression_opts,
                       dataset.fletcher32)
            self.assertEqual(filters, (True, "gzip", 1, True), name)
            self.assertLessEqual(np.prod(dataset.chunks) * dataset.dtype.itemsize, CHUNK, name)

    def check_complex(self, stored):
        if isinstance(stored, h5py.h5t.TypeCompoundID):
            parts = [(stored.get_member_name(i), stored.get_member_offset(i),
                      stored.get_member_type(i).get_size()) for i in range(stored.get_nmembers())]
            self.assertEqual(parts, [(b"r", 0, 8), (b"i", 8, 8)])

    def test_storage(self):
        self.large = 0
        self.on_each_file(self.check_storage)
        self.assertGreater(self.large, 5)

    def check_root(self, _, file):
        for name, value in file.attrs.items():
            self.assertIn(name, DOCUMENT.root)
            found = attribute_type(file.attrs.get_id(name))
            self.assertEqual(found, DOCUMENT.root[name].type, name)
            self.assertTrue(found != "float64" or np.isfinite(value), name)
            DOCUMENT.root[name].met = True
        for name, attribute in DOCUMENT.root.items():
            self.assertTrue(attribute.of != "all" or name in file.attrs, name)

    def test_root_attributes(self):
        self.on_each_file(self.check_root)
        for name, attribute in DOCUMENT.root.items():
            self.assertTrue(attribute.met, name)

    def check_attributes(self, _, file):
        for name, item in members(file, (h5py.Dataset, h5py.Group)).items():
            in_document = "state/..." if name.startswith("state/") else without_method(name)
            for key in set(item.attrs) - OF_HDF5:
                found = attribute_type(item.attrs.get_id(key))
                if key in ("units", "long_name"):
                    self.assertEqual(found, "text", name)
                    continue
                self.assertIn((in_document, key), DOCUMENT.attributes)
                attribute = DOCUMENT.attributes[in_document, key]
                self.assertEqual(found, attribute.type, f"{name}: {key}")
                attribute.met = True

    def test_attributes(self):
        self.on_each_file(self.check_attributes)
        for name, attribute in DOCUMENT.attributes.items():
            self.assertTrue(attribute.met, name)


if __name__ == "__main__":
    unittest.main()
