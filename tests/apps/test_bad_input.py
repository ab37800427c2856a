"""Bad input: status 2, one line that names the key or file and what is accepted, no file."""

import unittest

from program import BOX, CYLINDERS, SLAB, TILTS, WHOLE, flags, toml
from refusing import COMMANDS, SWEEP, RefusingTest

POSITIVE = "must be positive"
NO_USE = "is not used here"
DISKS = {**CYLINDERS, "index": "1.5"}
HG_BOX = {"width": 20, "depth": 10, "scatterer": "hg", "optical_depth": 1}
PAIRS = {"covariance": "pairs", "pairs": [0, 0.1, 0.04, 0.14]}

# subcommand, scene, changed keys, words of the message
BOX_CASES = [
    ("covariance", BOX, {"widht": 3}, ["widht", "unknown", "did you mean width?"]),
    ("covariance", BOX, {"wave_sample": 3}, ["wave_sample", "unknown"]),
    ("covariance", BOX, {"view_angle": 3}, ["view_angle: unknown", "did you mean view_angles?"]),
    ("covariance", BOX, {"quark": 3}, ["quark: unknown key (--help"]),
    ("render", {}, {"fov": 3}, ["fov: unknown key; see field_of_view of render"]),
    ("render", {"stage_box": [-1, -1, -1, 1, 1, 1]}, {"path_bins": [0, 5, 10, 0, 5, 10]}, ["first last count; given twice (6 numbers)"]),
    ("covariance", BOX, {"density": 1.0}, ["count, density", "exactly one"]),
    ("covariance", BOX, {"density": 1.0, "mean_free_path": 3, "optical_depth": 1},
     ["count, density, mean_free_path, optical_depth", "exactly one"]),
    ("covariance", BOX, {**TILTS, "tilt_count": 9}, ["tilts, tilt_count", "exactly one"]),
    ("covariance", BOX, {**TILTS, "tilts": None, "tilt_count": 2}, ["tilt_count = 2", "from 3"]),
    ("covariance", BOX, {"tilt_count": 9}, ["tilt_count = 9", "memory_effect"]),
    ("covariance", BOX, {**TILTS, "tilts": None, "tilt_count": 9, "view_angles": 1.5},
     ["tilt_count", "horizon"]),
    ("covariance", BOX, {"count": None}, ["no density", "exactly one"]),
    ("covariance", BOX, {"count": -1}, ["count = -1", "must not be negative"]),
    ("covariance", BOX, {"count": 1.5}, ["count = 1.5", "whole number"]),
    ("covariance", BOX, {"count": "many"}, ["count = many", "whole number"]),
    ("covariance", BOX, {"width": None}, ["width", "not given", "a box requires it"]),
    ("covariance", BOX, {"depth": None}, ["depth", "not given", POSITIVE]),
    ("covariance", BOX, {"domain": "sphere"}, ["domain = sphere", "box slab"]),
    ("covariance", BOX, {"scatterer": "cube"}, ["scatterer = cube", "point soft hard tm te hg"]),
    ("covariance", BOX, {"covariance": "all"}, ["covariance = all", "intensity pairs"]),
    ("covariance", BOX, {"method": "foo"}, ["method = foo", "mc wave"]),
    ("covariance", BOX, {"reversed_paths": "maybe"}, ["reversed_paths = maybe", "auto yes no"]),
    ("covariance", BOX, {"placement": "hard_disk"}, ["placement = hard_disk", "poisson"]),
    ("covariance", BOX, {"placement": "grid"}, ["placement = grid", "poisson hard_disk"]),
    ("covariance", BOX, {"min_gap": 0.1}, ["min_gap = 0.1", "disks"]),
    ("covariance", BOX, {"radius": 0.1}, ["radius = 0.1", "soft, hard, tm, te and mie"]),
    ("covariance", BOX, {"index": "1.5"}, ["index = 1.5", "tm, te and mie"]),
    ("covariance", BOX, {"g": 0.5}, ["g = 0.5", "hg"]),
    ("covariance", BOX, {"albedo": 0}, ["albedo = 0", "(0, 1]"]),
    ("covariance", BOX, {"albedo": 1.5}, ["albedo = 1.5", "from 0 to 1"]),
    ("covariance", BOX, {"albedo": -0.1}, ["albedo = -0.1", "from 0 to 1"]),
    ("covariance", BOX, {"albedo": "nan"}, ["albedo = nan", "from 0 to 1"]),
    ("covariance", BOX, {"albedo": 0.9, "phase_shift": 1}, ["phase_shift = 1", "absorbing"]),
    ("covariance", BOX, {"phase_shift": "inf"}, ["phase_shift = inf", "must be finite"]),
    *((subcommand, BOX, {"count": None, "optical_depth": 1, "phase_shift": 1e-6},
       ["neglect_k_shift", "shift the wavenumber by 7957", "method = wave"])
      for subcommand in ("covariance", "validate", "field")),
    ("sweep", BOX, {"count": None, "optical_depth": 1, "phase_shift": 1e-6, "tilts": [0, 0.1],
                     "width": None, "scatterer": "point"},
     ["neglect_k_shift", "shift the wavenumber by 7957", "method = wave"]),
    ("covariance", BOX, {"count": None, "optical_depth": 1, "phase_shift": 0},
     ["point", "does not scatter"]),
    ("covariance", BOX, {"light_angles": ["nan"]}, ["light_angles = nan", "radians"]),
    ("covariance", BOX, {"view_angles": [0.1, "inf"]}, ["view_angles = inf", "radians"]),
    ("covariance", BOX, {"view_angles": [0.1, "x"]}, ["view_angles", "x", "must be a number"]),
    ("covariance", BOX, {"seed": -1}, ["seed = -1", "must not be negative"]),
    ("covariance", BOX, {"seed": 1.5}, ["seed = 1.5", "whole number"]),
    ("covariance", BOX, {"seed": "x"}, ["seed = x", "whole number"]),
    ("covariance", BOX, {"seed": "99999999999999999999"}, ["seed = 99999999999999999999", "whole"]),
    ("covariance", BOX, {"samples": 0}, ["samples = 0", POSITIVE]),
    ("covariance", BOX, {"samples": -5}, ["samples = -5", POSITIVE]),
    ("covariance", BOX, {"samples": 2.5}, ["samples = 2.5", "whole number"]),
    ("covariance", BOX, {"threads": -1}, ["threads = -1", "from 0 to 1024"]),
    ("covariance", BOX, {"threads": "four"}, ["threads = four", "whole number"]),
    ("covariance", BOX, {"threads": 1000000}, ["threads = 1000000", "from 0 to 1024"]),
    ("covariance", BOX, {"tilts": [0.1]}, ["tilts = 0.1", "memory_effect"]),
    ("covariance", BOX, {"pairs": [0, 0, 0, 0]}, ["pairs = 0", "covariance = pairs"]),
    ("covariance", BOX, {"method": "transport"}, ["method = transport", "slab"]),
    ("flux", BOX, {"method": "transport"}, ["method = transport", "slab"]),
    ("covariance", BOX, {"dimension": 3}, ["height is not given"]),
    ("covariance", BOX, {"height": 3}, ["height = 3", "dimension = 3"]),
    ("covariance", BOX, {"light_azimuths": 1}, ["light_azimuths", "dimension = 3"]),
    ("covariance", BOX, {"dimension": 3, "height": 5, "view_azimuths": [1, 2, 3]}, ["view_azimuths = 3", "one for"]),
    ("covariance", BOX, {"dimension": 3, "height": 5, "camera_pixels": 8}, ["camera_aperture is not given"]),
    ("covariance", BOX, {"dimension": 3, "height": 5, "camera_pixels": 8, "camera_aperture": 0.9},
     ["camera_aperture = 0.9", "horizon"]),
    ("field", BOX, {"camera_focus": 3, "samples": None}, ["camera_focus", "camera_pixels"]),
    ("field", BOX, {"delays": [0, 1], "tilts": [0, 0.1], "samples": None}, ["tilts, delays, frequency_shifts", "only one"]),
    ("field", BOX, {"delays": [0, 1], "method": "covariance", "samples": None}, ["method = covariance", "method = paths"]),
    ("field", BOX, {"frequency_shifts": 0.2, "samples": None}, ["frequency_shifts = 0.2", "between -0.1 and 0.1"]),
    ("covariance", BOX, {"dimension": 3, "height": 5, "scatterer": "tm", "radius": 0.3},
     ["scatterer = tm", "penetrable"]),
    ("covariance", BOX, {"scatterer": "penetrable", "radius": 0.3}, ["scatterer = penetrable", "dimension = 3"]),
    ("covariance", SLAB, {"dimension": 3, "tilt_azimuth": 1}, ["tilt_azimuth", "tilts"]),
    ("covariance", SLAB, {"medium_index": 1.33, "outside_index": 1.5, "light_angles": 1.4},
     ["light_angles = 1.4", "totally reflected", "1.09"]),
    ("covariance", SLAB, {"medium_index": 1.33, "outside_index": 1.5, "view_angles": 1.4},
     ["view_angles = 1.4", "totally reflected"]),
    ("covariance", HG_BOX, {"method": "wave", "dimension": 3, "height": 5}, ["scatterer = hg", "penetrable"]),
    ("covariance", BOX, {"method": "wave", "dimension": 3, "height": 5, "medium_index": 1.3},
     ["dimension = 3", "without layers"]),
    ("covariance", BOX, {"method": "wave", "dimension": 3, "height": 5, "scatterer": "soft", "radius": 0.9,
                         "placement": "equilibrium", "count": 3}, ["height = 5", "three times"]),
    ("covariance", BOX, {"method": "wave", "dimension": 3, "height": 0.5, "scatterer": "soft", "radius": 0.7},
     ["packing fraction", "0.33"]),
    ("solve", BOX, {"dimension": 3, "height": 5, "solver": "fast"}, ["solver = fast", "dense or krylov"]),
    ("solve", BOX, {"near_sources": "x.csv"}, ["near_sources", "dimension = 3"]),
    ("place", {"width": 5, "depth": 5, "count": 3}, {"height": 2}, ["height", "dimension = 3"]),
    ("place", {"width": 5, "depth": 5, "count": 3}, {"dimension": 3}, ["height"]),
    ("covariance", SLAB, {"scatterer": "mie", "g": None, "radius": 1},
     ["scatterer = mie", "dimension = 3"]),
    ("flux", SLAB, {"scatterer": "mie", "g": None, "radius": 1}, ["scatterer = mie", "dimension = 3"]),
    ("covariance", SLAB, {"scatterer": "mie", "g": None, "dimension": 3}, ["radius is not given"]),
    ("covariance", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "radius": 100},
     ["radius = 100", "from 1e-6 to 500"]),
    ("covariance", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "radius": 1, "index": "1"},
     ["index = 1", "do not scatter"]),
    ("covariance", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "radius": 1, "index": "1-1i"},
     ["index = 1-1i", "amplify"]),
    ("covariance", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "radius": 1, "albedo": 0.5},
     ["albedo = 0.5", "is a key of"]),
    ("flux", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "radius": 1, "diameter": 2},
     ["diameter = 2", "radius"]),
    ("flux", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "diameter": 2,
                    "volume_fraction": 0.1}, ["optical_depth, volume_fraction", "exactly one"]),
    ("flux", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "diameter": 2,
                    "optical_depth": None, "volume_fraction": 1.5}, ["volume_fraction = 1.5", "(0, 1)"]),
    ("flux", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "diameter": 2,
                    "optical_depth": None, "mass_fraction": 0.1}, ["particle_density", "not given"]),
    ("flux", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "diameter": 2, "medium_density": 1},
     ["medium_density = 1", "mass_fraction"]),
    ("flux", SLAB, {"scatterer": "mie", "g": None, "dimension": 3, "diameter": 2,
                    "structure": "hard_spheres"}, ["optical_depth = 2", "structure"]),
    ("covariance", SLAB, {"optical_depth": None, "mass_fraction": 0.1, "particle_density": 1,
                          "medium_density": 1}, ["mass_fraction = 0.1", "soft, hard, tm, te and mie"]),
    ("covariance", SLAB, {"structure": "hard_spheres"}, ["structure = hard_spheres", "cylinders and spheres"]),
    ("covariance", DISKS, {"structure": "hard_spheres"}, ["structure = hard_spheres", "dimension = 3"]),
    ("covariance", BOX, {"diameter": 0.1}, ["diameter = 0.1", "soft, hard, tm, te and mie"]),
    ("covariance", SLAB, {"method": "transport", "dimension": 4}, ["dimension = 4", "from 2 to 3"]),
    ("covariance", SLAB, {"method": "transport", "dimension": 3, "scatterer": "te", "radius": 0.3, "g": None},
     ["scatterer = te", "penetrable"]),
    ("covariance", SLAB, {"method": "transport", "dimension": 3, "frequency_shifts": [0.2]},
     ["frequency_shifts = 0.2", "-0.1 to 0.1"]),
    ("covariance", BOX, {"wave_tolerance": 1e-3}, ["wave_tolerance = 0.001", "exact solver only"]),
    ("covariance", DISKS, {"placement": "equilibrium"}, ["placement = equilibrium", NO_USE]),
    ("covariance", DISKS, {"min_gap": 0.01}, ["min_gap = 0.01", NO_USE]),
    ("covariance", DISKS, {"method": "wave", "structure": "hard_disks"},
     ["structure = hard_disks", NO_USE]),
    ("covariance", DISKS, {"method": "wave", "reversed_paths": "yes"},
     ["reversed_paths = yes", NO_USE]),
    ("field", BOX, {"method": "paths", "target_error": 0.1}, ["target_error = 0.1", NO_USE]),
    ("field", BOX, {"method": "covariance", "paths_per_field": 9}, ["paths_per_field = 9", NO_USE]),
    ("covariance", BOX, {"method": "wave", "wave_tolerance": 0}, ["wave_tolerance = 0", "(0, 1)"]),
    ("covariance", BOX, {"method": "wave", "wave_tolerance": "nan"},
     ["wave_tolerance = nan", "(0, 1)"]),
    ("covariance", BOX, {"wave_samples": -1}, ["wave_samples = -1", POSITIVE]),
    ("validate", BOX, {"wave_samples": 0}, ["wave_samples = 0", POSITIVE]),
    ("validate", BOX, {"wave_samples": -1}, ["wave_samples = -1", POSITIVE]),
    ("validate", BOX, {"count": 0}, ["point", "does not scatter"]),
    ("validate", BOX, {"phase_shift": 0}, ["point", "does not scatter"]),
    ("validate", BOX, {"method": "mc"}, ["method", "unknown"]),
]
DISK_CASES = [
    ("covariance", CYLINDERS, {"radius": None}, ["radius", "not given", "give radius or diameter"]),
    ("covariance", CYLINDERS, {"scatterer": "soft", "index": "1.5"}, ["index = 1.5", "tm, te and mie"]),
    ("covariance", CYLINDERS, {"index": "0"}, ["index = 0", "must not be 0"]),
    ("covariance", CYLINDERS, {"index": "1.5-0.1i"}, ["index = 1.5-0.1i", "amplify"]),
    ("covariance", CYLINDERS, {"index": "-1.5+0.1i"}, ["index = -1.5+0.1i", "negative"]),
    ("covariance", CYLINDERS, {"index": "abc"}, ["index", "abc", "1.5+0.1i"]),
    ("covariance", CYLINDERS, {"index": "nan"}, ["index", "nan", "1.5+0.1i"]),
    ("covariance", CYLINDERS, {"index": "1e999"}, ["index = 1e999", "must be finite"]),
    ("covariance", CYLINDERS, {"g": 0.3}, ["g = 0.3", "hg"]),
    ("covariance", CYLINDERS, {"albedo": 0.3}, ["albedo = 0.3", "points and phase functions"]),
    ("covariance", CYLINDERS, {"phase_shift": 0.3}, ["phase_shift = 0.3", "point"]),
    ("covariance", CYLINDERS, {"placement": "poisson"}, ["placement = poisson", "hard_disk"]),
    ("covariance", CYLINDERS, {"min_gap": -0.1}, ["min_gap = -0.1", "must not be negative"]),
    ("covariance", CYLINDERS, {"min_gap": "nan"}, ["min_gap = nan", "must not be negative"]),
    ("covariance", CYLINDERS, {"min_gap": "inf"}, ["min_gap = inf", "must not be negative"]),
    ("covariance", CYLINDERS, {"count": 2000}, ["packing fraction", "0.8", "0.5"]),
    ("covariance", CYLINDERS, {"count": 900, "min_gap": 0.2},
     ["packing fraction", "min_gap", "0.5"]),
    ("covariance", CYLINDERS, {"count": None, "optical_depth": 1, "index": "1"},
     ["tm", "does not scatter"]),
    ("solve", CYLINDERS, {"count": 2000}, ["packing fraction", "0.5"]),
    ("solve", BOX, {"count": 1000000000000000}, ["count = 1e+15", "too many"]),
    ("solve", CYLINDERS, {"tolerance": 0}, ["tolerance = 0", "(0, 1)"]),
    ("solve", CYLINDERS, {"tolerance": "nan"}, ["tolerance = nan", "(0, 1)"]),
    ("solve", CYLINDERS, {"seed": -1}, ["seed = -1", "must not be negative"]),
    ("solve", CYLINDERS, {"samples": 10}, ["samples", "unknown"]),
    ("solve", CYLINDERS, {"placement": "no.csv"}, ["placement", "no.csv"]),
    ("solve", {"placement": "disks.csv", "scatterer": "tm", "index": "1.5", "radius": 0.5}, {},
     ["radius = 0.5", NO_USE]),
    ("solve", {"placement": "disks.csv", "scatterer": "tm", "index": "1.5", "seed": 4}, {},
     ["seed = 4", NO_USE]),
]
BULK_CASES = [
    ("covariance", SLAB, {"g": 1}, ["g = 1", "(-1, 1)"]),
    ("covariance", SLAB, {"g": -1}, ["g = -1", "(-1, 1)"]),
    ("covariance", SLAB, {"g": "nan"}, ["g = nan", "(-1, 1)"]),
    ("covariance", SLAB, {"albedo": 1.5}, ["albedo = 1.5", "from 0 to 1"]),
    ("covariance", SLAB, {"albedo": -0.1}, ["albedo = -0.1", "from 0 to 1"]),
    ("covariance", SLAB, {"width": 20}, ["width = 20", "a box"]),
    ("covariance", SLAB, {"optical_depth": None, "count": 10},
     ["hg", "mean_free_path, optical_depth or mu_s"]),
    ("covariance", SLAB, {"optical_depth": None, "density": 1},
     ["hg", "mean_free_path, optical_depth or mu_s"]),
    ("covariance", SLAB, {"radius": 0.1}, ["radius = 0.1", "soft, hard, tm, te and mie"]),
    ("covariance", SLAB, {"placement": "hard_disk"}, ["placement = hard_disk", "poisson"]),
    ("covariance", SLAB, {"light_angles": [2]}, ["light_angles = 2", "pi/2"]),
    ("covariance", SLAB, {"covariance": "full", "view_angles": [0, 0.1]},
     ["covariance", "slab", "intensity or memory_effect"]),
    ("covariance", SLAB, {"method": "wave"}, ["domain = slab", "box"]),
    ("covariance", HG_BOX, {"method": "wave"}, ["scatterer = hg", "point, soft, hard, tm or te"]),
    ("validate", HG_BOX, {}, ["scatterer = hg", "point, soft, hard, tm or te"]),
    ("solve", SLAB, {}, ["domain = slab", "box"]),
    ("solve", HG_BOX, {}, ["scatterer = hg", "point, soft, hard, tm or te"]),
    ("sweep", SWEEP, {"g": [0, 1]}, ["g = 1", "(-1, 1)"]),
    ("sweep", SWEEP, {"albedo": [1, 0]}, ["albedo", "does not scatter"]),
    ("sweep", SWEEP, {"optical_depth": [1, -2]}, ["optical_depth = -2", POSITIVE]),
    ("sweep", SWEEP, {"optical_depth": None}, ["no density", "exactly one"]),
    ("sweep", SWEEP, {"tilts": None}, ["tilts", "at least one"]),
    ("sweep", SWEEP, {"covariance": "full"}, ["covariance", "unknown"]),
]
REQUEST_CASES = [
    ("covariance", {**BOX, **TILTS}, {"tilts": None}, ["tilts", "at least one"]),
    ("covariance", {**BOX, **TILTS}, {"tilts": ["nan"]}, ["tilts = nan", "radians"]),
    ("covariance", {**BOX, **TILTS}, {"tilts": [0, 1.6]}, ["tilts = 1.6", "past the horizon"]),
    ("covariance", {**BOX, **TILTS}, {"tilts": [0.5], "view_angles": [1.5]},
     ["tilts = 0.5", "view angle 1.5", "past the horizon"]),
    ("covariance", {**BOX, **TILTS}, {"light_angles": [0, 0.1]}, ["light_angles", "one angle"]),
    ("covariance", {**BOX, **TILTS}, {"view_angles": [0.1, 0.1]}, ["view_angles = 0.1", "twice"]),
    ("covariance", {**BOX, **TILTS}, {"covariance": None}, ["tilts = 0", "memory_effect"]),
    ("covariance", {**BOX, **TILTS}, {"near_sensors": "out.csv"}, ["near_sensors", "far views"]),
    ("covariance", {**BOX, **PAIRS}, {"pairs": [0, 1, 2]}, ["pairs = 0 1 2", "4 numbers", "light 1, view 1"]),
    ("covariance", {**BOX, **PAIRS}, {"pairs": [0, 1, 2, 3, 4]}, ["pairs = 0 1 2 3 4", "4 numbers", "light 1"]),
    ("covariance", {**BOX, **PAIRS}, {"pairs": [0, 1, 2, "nan"]}, ["pairs = nan", "radians"]),
    ("covariance", {**BOX, **PAIRS}, {"pairs": None}, ["pairs", "at least one"]),
    ("covariance", {**BOX, **PAIRS}, {"near_sensors": "out.csv"}, ["near_sensors", "pairs"]),
    ("covariance", {**BOX, **PAIRS}, {"view_angles": [0.1]}, ["view_angles", "pairs"]),
    ("covariance", {**SLAB, **PAIRS}, {"pairs": [0, 0.1, 0.04, 0.2]}, ["covariance", "slab"]),
    ("covariance", BOX, {"near_sensors": "out.csv", "view_angles": [0.1]},
     ["near_sensors", "either near_sensors or view_angles"]),
    ("covariance", BOX, {"near_sensors": "no.csv"}, ["no.csv"]),
    ("covariance", BOX, {"near_sensors": "empty.csv"}, ["empty.csv"]),
    ("covariance", BOX, {"near_sensors": "header.csv"}, ["header.csv", "at least one"]),
    ("covariance", SLAB, {"near_sensors": "out.csv"}, ["near_sensors", "outside of the slab"]),
    ("covariance", SLAB, {"near_sensors": "out.csv", "beam_waist": 9}, ["requires far views"]),
    ("sweep", SWEEP, {"near_sensors": "out.csv"}, ["near_sensors", "far views"]),
]
MAP = {"covariance": "tilt_shift", "tilts": [0, 0.01], "shifts": [0, 0.1]}
MOVE = {"covariance": "translation", "shifts": [0, 0.5]}
LIGHT_CASES = [
    ("covariance", BOX, {"near_sources": "out.csv", "light_angles": [0.1]},
     ["light_angles = 0.1", "near_sources"]),
    ("covariance", BOX, {"near_sources": "out.csv", "beam_waist": 2}, ["beam_waist = 2", "either"]),
    ("covariance", BOX, {"near_sources": "no.csv"}, ["no.csv"]),
    ("covariance", BOX, {"near_sources": "header.csv"}, ["header.csv", "at least one"]),
    ("covariance", BOX, {"beam_waist": 0}, ["beam_waist = 0", POSITIVE]),
    ("covariance", BOX, {"beam_waist": 0.5}, ["beam_waist = 0.5", "wavelength"]),
    ("covariance", BOX, {"beam_positions": [1]}, ["beam_positions = 1", "beam_waist"]),
    ("covariance", BOX, {"beam_depth": 1}, ["beam_depth = 1", "beam_waist"]),
    ("covariance", BOX, {"beam_waist": 2, "beam_positions": ["nan"]}, ["beam_positions = nan"]),
    ("covariance", BOX, {"beam_waist": 2, "beam_positions": [40]}, ["40", "misses the medium"]),
    ("covariance", SLAB, {"near_sources": "out.csv"}, ["near_sources", "must be below 0"]),
    ("covariance", SLAB, {"beam_waist": 2, "samples": 400}, ["beams", "require method = transport"]),
    ("covariance", {**BOX, **TILTS}, {"beam_waist": 2}, ["memory_effect", "tilt_shift"]),
    ("covariance", {**BOX, **PAIRS}, {"beam_waist": 2}, ["beam_waist", "pairs"]),
    ("covariance", {**BOX, **PAIRS}, {"near_sources": "out.csv"}, ["near_sources", "pairs"]),
    ("covariance", BOX, {"shifts": [0.1]}, ["shifts = 0.1", "tilt_shift and translation"]),
    ("covariance", {**BOX, **MAP}, {"shifts": None}, ["shifts", "at least one"]),
    ("covariance", {**BOX, **MAP}, {"tilts": [0.1]}, ["tilts = 0.1", "contain 0"]),
    ("covariance", {**BOX, **MAP}, {"shifts": [0, 0]}, ["shifts = 0", "twice"]),
    ("covariance", {**BOX, **MAP}, {"shifts": [0, 7]}, ["shifts = 7", "past the horizon"]),
    ("covariance", {**BOX, **MAP}, {"light_angles": [0, 0.1]}, ["tilt_shift", "one light, not 2"]),
    ("covariance", {**BOX, **MAP}, {"near_sources": "out.csv"}, ["one light, not 2"]),
    ("covariance", {**BOX, **MAP}, {"near_sources": "one.csv"}, ["one.csv", "translation"]),
    ("covariance", {**SLAB, **MAP}, {"depth": 10}, ["tilt_shift", "memory_effect"]),
    ("covariance", {**BOX, **MAP}, {"gradient": True}, ["gradient", "other than tilt_shift"]),
    ("covariance", BOX, {"gradient": True, "beam_waist": 2}, ["gradient", "plane waves"]),
    ("covariance", BOX, {"delays": [0], "near_sources": "out.csv"}, ["delays", "plane waves"]),
    ("covariance", {**BOX, **MOVE}, {"wavelength": 1}, ["translation", "use tilt_shift"]),
    ("covariance", {**BOX, **MOVE}, {"near_sources": "one.csv", "tilts": [0]},
     ["tilts = 0", "memory_effect and tilt_shift"]),
]
WAVE = {**CYLINDERS, "method": "wave"}
COVERED_CASES = [
    (subcommand, scene, {key: name}, [f"{key} = (", "may cover", "radius"])
    for subcommand, scene in (("validate", CYLINDERS), ("covariance", WAVE))
    for key in ("near_sensors", "near_sources") for name in ("rim.csv", "inside.csv")
]
SENSORS = {"rim.csv": "x,z\n0,-30\n0,-0.0001\n", "inside.csv": "x,z\n0,1\n",
           "out.csv": "x,z\n0,15\n1,15\n", "header.csv": "x,z\n", "one.csv": "x,z\n0,-3\n",
           "empty.csv": ""}
REAL_KEYS = [
    ("covariance", BOX, ["width", "depth", "wavelength", "seconds"]),
    ("covariance", {**BOX, "count": None}, ["density", "mean_free_path", "optical_depth"]),
    ("covariance", {**SLAB, "optical_depth": None}, ["optical_depth", "mean_free_path"]),
    ("covariance", CYLINDERS, ["radius"]),
    ("solve", CYLINDERS, ["radius", "wavelength", "width"]),
    ("sweep", SWEEP, ["depth", "wavelength"]),
]


class Keys(RefusingTest):
    def check_cases(self, cases):
        """Checks all cases, by day every other one."""
        for case in cases if WHOLE else cases[::2]:
            self.assert_refused_both_ways(*case)

    def test_box(self):
        self.check_cases(BOX_CASES)

    def test_disks(self):
        self.write("disks.csv", "x,z,radius\n0,0,0.3\n1,2,0.2\n")
        self.check_cases(DISK_CASES)

    def test_bulk(self):
        self.check_cases(BULK_CASES)

    def test_request(self):
        for name, text in SENSORS.items():
            self.write(name, text)
        self.check_cases(REQUEST_CASES)
        self.check_cases(LIGHT_CASES)
        self.check_cases(COVERED_CASES)

    def test_real_numbers(self):
        for subcommand, scene, keys in REAL_KEYS:
            for number, key in enumerate(keys):
                for value in ("-1", "nan") if WHOLE else ("nan" if number % 2 else "-1",):
                    self.assert_refused_both_ways(subcommand, scene, {key: value},
                                                  [f"{key} = {value}", POSITIVE])
        for value in ("0", "inf", "-inf", "1e999"):
            for key, accepted in (("width", POSITIVE), ("seconds", POSITIVE),
                                  ("target_error", "in (0, 1)")):
                with self.subTest(key=key, value=value):
                    shown = value.replace("1e999", "inf")
                    self.assert_refused([f"{key} = {shown}", accepted], "covariance",
                                        *flags({**BOX, key: value}))
        for value in ("x", "1x", "1,5", "0.5.5", "--", "1 2"):
            with self.subTest(value=value):
                self.assert_refused(["width", value, "must"], "covariance",
                                    *flags({**BOX, "width": value}))

    def test_empty_values(self):
        for number, key in enumerate(("width", "count", "seed", "samples", "view_angles", "light_angles",
                                      "covariance", "index", "near_sensors", "method", "reversed_paths")):
            texts = (f"{key} =\n", f'{key} = ""\n', f"{key} = []\n")
            for text in texts if WHOLE else (texts[number % 3],):
                with self.subTest(text=text):
                    scene = {**BOX, key: None}
                    self.write("scene.toml", toml(scene) + text)
                    self.assert_refused([key], "covariance", config="scene.toml")
            with self.subTest(flag=key):
                self.assert_refused([key], "covariance", f"--{key}", *flags({**BOX, key: None}))
                self.assert_refused([key], "covariance", *flags({**BOX, key: None}), f"--{key}=")

    def test_a_scalar_given_twice(self):
        scene = {**BOX, "scatterer": "point", "seed": 1, "tilts": [0]}
        for line in ("width = 3", 'scatterer = "tm"', "seed = 1", "tilts = [0]"):
            with self.subTest(line=line):
                self.write("scene.toml", toml(scene) + line)
                self.assert_refused(["scene.toml", "line 7", line, "redefine"],
                                    "covariance", config="scene.toml")
        self.write("scene.toml", toml({**BOX, "width": [3, 4]}))
        self.assert_refused(["width"], "covariance", config="scene.toml")
        self.assert_refused(["width"], "covariance", *flags(BOX), "--width", 3)


class Words(RefusingTest):
    def test_subcommand(self):
        self.assert_refused(["subcommand = foo", "solve", "covariance", "validate", "sweep"], "foo")
        self.assert_refused(["subcommand", "--config"], "--config", "x.toml")

    def test_unknown_flags_and_stray_words(self):
        for subcommand, scene in COMMANDS.items():
            self.assert_refused(["widht", "unknown"], subcommand, *flags(scene), "--widht", 3)
            self.assert_refused(["-x"], subcommand, *flags(scene), "-x")
            self.assert_refused(["stray"], subcommand, "stray", *flags(scene))

    def test_abbreviations_are_not_guessed(self):
        self.assert_refused(["wid", "unknown"], "covariance", *flags(BOX), "--wid", 3)


if __name__ == "__main__":
    unittest.main()
