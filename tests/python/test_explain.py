"""`flatspeckle explain FILE` prints the meaning of every dataset, the medium, how the run ended, and scripts that
draw the file."""

import re
import subprocess
import unittest

import h5py
import matplotlib

matplotlib.use("Agg")

from package import BOX, CURVE, FEW, ROOT, WHOLE, PackageTest, fs

STAGE = {"stage_box": [-1, -1, -1, 1, 1, 1], "mu_s": 1, "point_light": [0, 0, -0.5, 1], "sensor": "area",
         "sensor_at": [0, 0, 1], "sensor_size": [2, 2], "pixels": [4, 4], "samples": 500}
RINGS = {**STAGE, "sensor": ["radial", "polar"], "sensor_size": None, "pixels": None, "sensor_radius": 0.9,
         "sensor_direction": [0, 0, 1], "rings": [4, 3]}
MIXED = {**STAGE, "sensor": ["radial", "area"], "sensor_radius": 0.9, "sensor_direction": [0, 0, 1], "rings": 4}
FRAMES = [[1 + i * i % 7 for i in range(80)], [1 + i * i % 11 for i in range(80)]]
SLAB = {"domain": "slab", "depth": 100, "scatterer": "hg", "optical_depth": 2, "method": "mc", **FEW}


def explained(*words):
    return subprocess.run([fs.program.path(), "explain", *map(str, words)], capture_output=True, text=True)


class Explain(PackageTest):
    def setUp(self):
        super().setUp()
        self.leave_figures_undrawn()

    def check(self, path):
        text = explained(path).stdout
        with h5py.File(path) as file:
            for name, item in self.told_of(file):
                sizes = " x ".join(map(str, item.shape)) or "one number"
                self.assertIn(f"  {name} ({sizes}): {item.attrs['long_name']}", text)
            if "optical_depth" in file.attrs:
                self.assertIn(f"\n  optical_depth = {float(file.attrs['optical_depth']):g}"[:12], text)
        drawn = re.findall(r"plots/(\w+)\.py", text)
        self.assertTrue(drawn, text)
        for script in drawn:
            self.assertTrue(getattr(fs.plots, script)(path).axes)

    @staticmethod
    def told_of(file):
        found = []
        file.visititems(lambda name, item: found.append((name, item)) if isinstance(item, h5py.Dataset) else None)
        return [(name, item) for name, item in found
                if "state" not in name.split("/") and not name.endswith(("_error", "_rare", "_limit"))]

    def display(self):
        picture = self.folder / "picture.csv"
        picture.write_text("\n".join("1,1,1,1" for _ in range(4)) + "\n")
        return fs.design(design="box", nodes=[7], goal="irradiance", pictures=str(picture), rays_across=4, iterations=2)

    def test_results_of_all_kinds(self):
        runs = [fs.covariance(CURVE), fs.validate(BOX, wave_samples=4, view_angles=[0.1, 0.5], **FEW),
                fs.validate(width=20, depth=10, placement=[[0, 1], [3, 4]], view_angles=[0.2, 0.5, 1], **FEW),
                fs.covariance(SLAB, delays=[0, 0.1, 1]), fs.covariance(SLAB, frequency_shifts=[0, 1e-4]),
                fs.covariance(BOX, view_angles=0.1, covariance="tilt_shift", tilts=[0, 0.1], shifts=[0, 0.1], **FEW),
                fs.sweep(SLAB, method="both", tilts=[0, 0.004]), fs.recover(frames=FRAMES, recovery="sources"),
                fs.fit(plan=True, free=["g=0:0.8"], g=0.5, depth=100, optical_depth=2, tilts=[0.002]),
                fs.field(BOX, view_angles=[0.1, 0.2, 0.3], tilts=[0, 0.01], fields=4),
                fs.render(STAGE), fs.render(RINGS), fs.render(MIXED), fs.trace(ROOT / "data/scenes/trace_singlet.toml"),
                fs.design(design="radial", directions=1, rays_per_direction=9, iterations=1),
                fs.trace(field="luneburg", origin=[0, 0, -2], beam_radius=0.5, ray_count=3, path_points=5, max_length=5),
                fs.field(BOX, view_angles=[0.1, 0.2, 0.3], light_angles=[0, 0.01], fields=4),
                fs.solve(BOX, map=[-5, 5, 0, 4], map_pixels=[8, 6]), *([self.display()] if WHOLE else []),
                fs.sweep(of="render", vary="mu_s=0.5,1", **STAGE)]
        for result in runs:
            with self.subTest(made_by=result.attrs["command_line"]):
                self.check(result.encoding["source"])

    def test_results_without_a_plot_list_no_script(self):
        self.assertNotIn("plots/", explained(fs.recover(frames=FRAMES, points=2).encoding["source"]).stdout)

    def test_a_missed_target(self):
        with self.assertWarns(fs.TargetMissed):
            result = fs.covariance(BOX, target_error=1e-9, **FEW)
        self.assertIn("stopped before the target error", explained(result.encoding["source"]).stdout)

    def test_what_is_refused(self):
        other = self.folder / "other.h5"
        with h5py.File(other, "w") as file:
            file["x"] = 1
        for words in ([], ["/nowhere"], [ROOT / "README.md"], [other], ["a", "b"]):
            done = explained(*words)
            self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (2, 1, ""), words)


if __name__ == "__main__":
    unittest.main()
