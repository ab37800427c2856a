"""--help and --version."""

import unittest

from program import ProgramTest

SCATTERER = ["wavelength", "scatterer", "radius", "index", "g", "albedo"]
MEDIUM = ["domain", "width", "depth", "count", "density", "mean_free_path", "optical_depth",
          "placement", "min_gap"]
VIEWS = ["light_angles", "view_angles", "near_sensors"]
REQUEST = ["near_sources", "beam_waist", "beam_positions", "beam_depth", "covariance", "tilts",
           "shifts", "pairs"]
RUN = ["seed", "samples", "seconds", "target_error", "threads", "resume"]
PROGRAM = ["config", "print-config", "out", "help"]
SCENE = SCATTERER + MEDIUM + VIEWS
FIELD = ["field", "index", "radius", "alpha", "centre", "slope", "index_low", "index_high",
         "ramp_width", "ramp_axis", "blobs", "amplitude", "sound_wavenumber", "sound_order",
         "sound_phase", "emitters", "aperture", "focusing", "grid", "ball_spline", "radial_spline"]
SPACE_MEDIUM = ["mu_s", "mu_a", "phase", "g", "density"]
KEYS = {
    "bench": ["quick", "threads"],
    "place": ["width", "depth", "radii", "fractions", "count", "packing_fraction", "placement",
              "min_gap", "seed", "structure", "realizations"],
    "solve": SCENE + ["seed"],
    "covariance": SCENE + REQUEST + ["structure", "method", "gradient", "delays",
                                     "frequency_shifts", "wave_samples"] + RUN,
    "flux": SCATTERER + MEDIUM + ["light_angles", "angle_bins"] + RUN,
    "fit": SCATTERER + ["free", "measurement", "starts", "most_iterations", "method", "model_share",
                        "depth", "density", "mean_free_path", "optical_depth", "seed", "seconds", "threads"],
    "validate": SCENE + REQUEST + ["structure", "frequency_shifts", "wave_samples"] + RUN,
    "field": SCENE + ["structure", "tilts", "method", "fields", "paths_per_field", "target_error", "seed",
                      "threads"],
    "trace": FIELD + ["rays", "light", "ray_count", "origin", "direction", "across", "beam_radius",
                      "half_angle", "stop_plane", "stop_sphere", "stop_box", "max_length",
                      "integrator", "step", "tolerance", "connect", "trials", "path_points",
                      "length_unit", "seed", "threads"],
    "design": ["design", "radius", "nodes", "coefficients", "start_excess", "least_index",
               "most_index", "index", "delta", "goal", "focus", "directions", "rays_per_direction",
               "aperture", "modes", "ray_count", "pictures", "view_directions", "beam_width",
               "beam_waist", "screen_width", "screen_distance", "rays_across", "measured", "method",
               "step", "iterations", "target", "noise", "roughness", "threads", "resume"],
    "render": FIELD + SPACE_MEDIUM + ["body_" + key for key in SPACE_MEDIUM] + RUN + [
        "stage_box", "stage_sphere", "body_box", "body_sphere", "index_around", "ball", "block", "point_light",
        "beam_light", "face_light", "environment", "sensor", "sensor_at", "sensor_direction",
        "sensor_up", "sensor_size", "pixels", "field_of_view", "lens_radius", "focus_distance",
        "acceptance", "half_angle", "path_bins", "length_unit", "method", "max_scatterings", "random_phase", "step", "max_length"],
    "sweep": SCENE + ["structure", "tilts"] + RUN,
}


class Help(ProgramTest):
    def test_every_key_is_listed(self):
        for subcommand, keys in KEYS.items():
            for words in ((subcommand, "--help"), (subcommand, "-h"), ("help", subcommand)):
                done = self.call(*words)
                self.assertEqual(done.stderr, "")
                listed = done.stdout.split()
                for key in keys + PROGRAM:
                    with self.subTest(subcommand=subcommand, key=key):
                        names = {f"--{key}", f"-h,--{key}"}
                        self.assertTrue(names & set(listed))

    def test_help_wins(self):
        """--help wins even if the rest is wrong or missing."""
        self.call("covariance", "--width", -3, "--help")

    def test_program(self):
        for words in ((), ("--help",), ("-h",), ("help",)):
            text = self.call(*words).stdout
            for subcommand in KEYS:
                self.assertIn(subcommand, text)
            for status in ("0 done", "2 bad input", "3 stopped", "4 input or output", "5 a row", "75"):
                self.assertIn(status, text)

    def test_version(self):
        self.assertRegex(self.call("--version").stdout, r"^flatspeckle \d+\.\d+\.\d+ \(.+\)\n$")

    def test_nothing_is_written(self):
        self.call("covariance", "--help", "--out", "x.h5")
        self.assertEqual(self.listing(), {})


if __name__ == "__main__":
    unittest.main()
