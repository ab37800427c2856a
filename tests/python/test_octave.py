"""The reader for Octave agrees with h5py: every number at its place, complex or not, texts, axes, units, errors."""

import shutil
import subprocess
import sys
import unittest

import h5py
import numpy as np

from package import BOX, CURVE, FEW, ROOT, PackageTest, fs

TELL = """
function tell(name, item)
  if isfield(item, "values") && isfield(item, "axes")
    told(name, item.values, item.axes, item.units);
    if isfield(item, "error")
      told([name "_error"], item.error, item.axes, item.units);
    end
    return
  end
  for field = fieldnames(item)'
    if ! any(strcmp(field{1}, {"attributes", "axes"}))
      tell([name "/" field{1}], item.(field{1}));
    end
  end
end
function told(name, values, axes, units)
  if iscell(values)
    printf("%s|%s|%s|%s\\n", name, strjoin(values, ","), strjoin(axes, ","), units);
  else
    place = (1:numel(values)).';
    sums = [sum(real(values(:)) .* place), sum(imag(values(:)) .* place)];
    printf("%s|%.17g %.17g|%s|%s\\n", name, sums, strjoin(axes, ","), units);
  end
end
"""


def text_of(dataset):
    """Returns the text printed by Octave, by h5py: a sum in which every number has its own weight."""
    if h5py.check_string_dtype(dataset.dtype):
        return ",".join(np.ravel(dataset.asstr()[()]))
    values = np.ravel(dataset[()], order="F")
    place = np.arange(1, values.size + 1)
    return [float(np.sum(part(values) * place)) for part in (np.real, np.imag)]


class Octave(PackageTest):
    def told(self, path):
        (self.folder / "tell.m").write_text(
            f'1;\n{TELL}\naddpath("{ROOT}/octave");\nr = flatspeckle_read("{path}");\ntell("", r);\n'
            'for field = fieldnames(r.axes)\'\n  told(["/" field{1}], r.axes.(field{1}), {}, "");\nend\n'
            'printf("@converged|%d\\n@seed|%.17g\\n@config|%s\\n", r.attributes.converged, r.attributes.seed, '
            'strrep(r.attributes.config, "\\n", ";"));\n')
        done = subprocess.run(["octave-cli", "--quiet", "--norc", self.folder / "tell.m"], capture_output=True,
                              text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return dict(line.split("|", 1) for line in done.stdout.splitlines())

    def check(self, path):
        told, checked = self.told(path), 0
        with h5py.File(path) as file:
            for name in self.names(file):
                values, axes, units = told[f"/{name}"].split("|")
                expected = text_of(file[name])
                if isinstance(expected, str):
                    self.assertEqual(values, expected, name)
                else:
                    np.testing.assert_allclose(np.array(values.split(), float), expected, rtol=1e-12, err_msg=name)
                if not h5py.h5ds.is_scale(file[name].id):
                    self.assertEqual(axes, ",".join(axis.label for axis in file[name].dims), name)
                    self.assertEqual(units, file[name].attrs.get("units", ""), name)
                checked += 1
            self.assertEqual(int(told["@converged"]), file.attrs["converged"])
            self.assertEqual(float(told["@seed"]), file.attrs["seed"])
            self.assertEqual(told["@config"].strip(";"), file.attrs["config"].strip().replace("\n", ";"))
        self.assertGreater(checked, 5)

    @staticmethod
    def names(file):
        found = []
        file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset)
                        and "state" not in name.split("/") else None)
        return found

    def test_curves_maps_and_texts(self):
        moved = fs.covariance(BOX, covariance="memory_effect", tilts=[0, 0.04, 0.16], view_angles=[0.1, 0.5], **FEW)
        both = fs.validate(BOX, wave_samples=4, view_angles=[0.1, 0.5], **FEW)
        fitted = fs.fit(plan=True, free=["g=0:0.8"], g=0.5, depth=100, optical_depth=2, tilts=[0.002])
        for result in (moved, both, fitted):
            self.check(result.encoding["source"])

    def test_shipped_results(self):
        for path in sorted((ROOT / "data").glob("*.h5")):
            with self.subTest(file=path.name):
                self.check(path)


if __name__ == "__main__":
    if not (shutil.which("octave-cli") and shutil.which("h5dump")):
        print("skipped: no octave-cli or no h5dump (Debian: octave hdf5-tools)")
        sys.exit(77)
    unittest.main()
