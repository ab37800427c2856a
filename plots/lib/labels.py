"""Labels that distinguish results: the keys in which their scenes differ, or the names of their files."""

import pathlib

from lib import style

import numpy as np

# Keys of accuracy and method, or of the horizontal axis; they do not count as differences of scenes.
NOT_SCENE = {"samples", "wave_samples", "seconds", "target_error", "tolerance", "wave_tolerance", "seed", "threads",
             "method", "tilts", "tilt_count", "q_depths", "shifts", "delays", "frequency_shifts", "linewidths",
             "neglect_k_shift"}
NAMES = {"optical_depth": "OD", "g": "$g$", "view_angles": "view", "light_angles": "light", "mu_s": r"$\mu_s$",
         "mu_a": r"$\mu_a$"}
MOST = 2  # largest number of differences in a label


def of_slab(result, digits=3):
    """Returns optical depth and mean cosine as text with `digits` digits."""
    depth, g = (result.attribute(name) for name in ("optical_depth", "g"))
    return rf"OD {depth:.{digits}g}, $g$ = {g:.{digits}g}"


def joined(*words):
    return ", ".join(filter(None, words))


def with_unit(name, unit):
    return name if unit in (None, "", "1") else f"{name} ({unit})"


def value_text(key, value):
    if isinstance(value, list):
        return ", ".join(value_text(key, one) for one in value) if len(value) <= 3 else f"{len(value)} values"
    if key.endswith("_angles"):
        return style.angle(value)
    return f"{value:.4g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else str(value)


def side(result):
    """Returns ", reflected" if all detection directions are on the illuminated side, otherwise an empty text."""
    if not result.has("view_angle") or np.any(np.cos(result.values("view_angle")) > 0):
        return ""
    return ", reflected"


def stems(results):
    """Returns the names of the files, with their folder if needed to distinguish them."""
    paths = [pathlib.Path(result.path) for result in results]
    short = [path.stem for path in paths]
    return short if len(set(short)) == len(short) else [f"{path.parent.name}/{path.stem}" for path in paths]


def labels(results):
    """Returns a text for each result; an empty one for a single result."""
    if len(results) == 1:
        return [""]
    scenes = [result.scene for result in results]
    keys = [key for key in sorted(set().union(*scenes) - NOT_SCENE)
            if any(scene.get(key) != scenes[0].get(key) for scene in scenes)]
    if not keys and len({result.path for result in results}) > 1:
        return [""] * len(results)  # all results have the same scene; methods distinguish them
    if len(keys) > MOST or any(key not in scene for key in keys for scene in scenes):
        return stems(results)
    sign = lambda key: "" if key.endswith("_angles") else "= "
    return [", ".join(f"{NAMES.get(key, key)} {sign(key)}{value_text(key, scene[key])}" for key in keys)
            + (side(result) if "view_angles" in keys else "") for scene, result in zip(scenes, results)]
