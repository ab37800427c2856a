"""What tells results apart, in words: of their scenes what differs, or the names of their files."""

import pathlib

from lib import style

import numpy as np

# How a result was found, or over what it is drawn: no difference of scenes.
NOT_SCENE = {"samples", "wave_samples", "seconds", "target_error", "tolerance", "wave_tolerance", "seed", "threads",
             "method", "tilts", "tilt_count", "q_depths", "shifts", "delays", "frequency_shifts", "neglect_k_shift"}
NAMES = {"optical_depth": "OD", "g": "$g$", "view_angles": "view", "light_angles": "light", "mu_s": r"$\mu_s$",
         "mu_a": r"$\mu_a$"}
MOST = 2  # differences that a label names


def of_slab(result, digits=3):
    """Optical depth and mean cosine, to so many digits."""
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
    """", reflected" of views on the light's side alone; nothing of others."""
    if not result.has("view_angle") or np.any(np.cos(result.values("view_angle")) > 0):
        return ""
    return ", reflected"


def stems(results):
    """Names of their files, with as much of the folder as tells them apart."""
    paths = [pathlib.Path(result.path) for result in results]
    short = [path.stem for path in paths]
    return short if len(set(short)) == len(short) else [f"{path.parent.name}/{path.stem}" for path in paths]


def labels(results):
    """A text for each result; nothing for one alone."""
    if len(results) == 1:
        return [""]
    scenes = [result.scene for result in results]
    keys = [key for key in sorted(set().union(*scenes) - NOT_SCENE)
            if any(scene.get(key) != scenes[0].get(key) for scene in scenes)]
    if not keys and len({result.path for result in results}) > 1:
        return [""] * len(results)  # one scene: methods tell them apart
    if len(keys) > MOST or any(key not in scene for key in keys for scene in scenes):
        return stems(results)
    sign = lambda key: "" if key.endswith("_angles") else "= "
    return [", ".join(f"{NAMES.get(key, key)} {sign(key)}{value_text(key, scene[key])}" for key in keys)
            + (side(result) if "view_angles" in keys else "") for scene, result in zip(scenes, results)]
