"""xarray reads result files through h5netcdf: labelled axes, coordinates, complex numbers, and the
values that h5py reads. Exits with 77 if they are not installed."""

import importlib.util
import sys
import unittest

import h5py
import numpy as np

from format_scenes import ResultsTest
from test_format import is_scale, members

MISSING = [name for name in ("xarray", "h5netcdf") if importlib.util.find_spec(name) is None]


def groups_with_datasets(file):
    return sorted({dataset.parent.name for dataset in members(file).values()})


def own_datasets(group):
    return {name: item for name, item in group.items() if isinstance(item, h5py.Dataset)}


class Xarray(ResultsTest):
    def open(self, path, group="/"):
        """Opens by the recipe of docs/format.md: coordinates that a group lacks come from the root."""
        import xarray
        keys = {"phony_dims": "sort"} if group.startswith("/state") else {}
        dataset = xarray.open_dataset(path, engine="h5netcdf", group=group, **keys)
        self.addCleanup(dataset.close)
        if group == "/":
            return dataset
        return dataset.assign_coords({name: values for name, values in
                                      self.open(path).coords.items()
                                      if name in dataset.dims and name not in dataset.coords})

    def check_file(self, file):
        for group in groups_with_datasets(file):
            stored = own_datasets(file[group])
            opened = self.open(file.filename, group)
            self.assertEqual(set(opened.variables) - set(opened.dims),
                             {name for name, dataset in stored.items() if not is_scale(dataset)})
            for name, dataset in stored.items():
                self.check_variable(opened[name], dataset)

    def check_variable(self, variable, dataset):
        self.assertEqual(variable.dtype, dataset.dtype, dataset.name)
        stored = dataset.asstr() if h5py.check_string_dtype(dataset.dtype) else dataset
        np.testing.assert_array_equal(variable.values, stored[()], dataset.name)
        for key in ("units", "long_name"):
            self.assertEqual(variable.attrs.get(key), dataset.attrs.get(key), dataset.name)
        if is_scale(dataset):
            self.assertEqual(variable.dims, (dataset.name.split("/")[-1],))
            return
        for dim, axis in zip(variable.dims, dataset.dims, strict=True):
            if len(axis) == 0:
                self.assertTrue(dim.startswith("phony_dim"), dataset.name)
                continue
            self.assertEqual(dim, axis.label, dataset.name)
            np.testing.assert_array_equal(variable.coords[dim], axis[0][()], dataset.name)

    def test_same_as_h5py(self):
        self.on_each_file(self.check_file)

    def test_selection_by_coordinate(self):
        path = self.folder / "full.h5"
        covariance = self.open(path).covariance
        one = covariance.sel(light_angle=0.3, view_angle=0.5, light_angle_2=0, view_angle_2=3.0)
        with h5py.File(path) as file:
            self.assertEqual(complex(one), file["covariance"][1, 1, 0, 2])
            self.assertNotEqual(complex(one).imag, 0)
        mc = self.open(self.folder / "validate.h5", "mc")
        with h5py.File(self.folder / "validate.h5") as file:
            self.assertEqual(float(mc.intensity.sel(light_angle=0.3).sel(view_angle=0.5)),
                             file["mc/intensity"][1, 1])

    def test_selection_from_a_sweep(self):
        curve = self.open(self.folder / "sweep.h5").field_correlation.sel(optical_depth=2, g=0.5,
                                                                          albedo=1)
        with h5py.File(self.folder / "sweep.h5") as file:
            np.testing.assert_array_equal(curve, file["field_correlation"][1, 1, 0])
        self.assertEqual(curve.dims, ("tilt",))

    def test_stored_again(self):
        """A copy keeps the complex numbers."""
        full = self.open(self.folder / "full.h5")
        again = self.folder / "again.nc"
        with self.assertWarns(UserWarning):
            full.to_netcdf(again, engine="h5netcdf", invalid_netcdf=True)
        self.assertTrue(self.open(again).identical(full))


if __name__ == "__main__":
    if MISSING:
        print("skipped: not installed:", *MISSING)
        sys.exit(77)
    unittest.main()
