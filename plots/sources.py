#!/usr/bin/env python3
"""Sources separated from frames of blinking points (`flatspeckle image --blinking ...`, or `recover --recovery
sources`): singular values of the frames, parts of some speckle patterns, and the positions of the sources."""

from lib import object_panel, page, script, style

import numpy as np

SHOWN = 60  # number of pixels of a pattern that are drawn
PATTERNS = 3


def draw_singular_values(axis, result):
    values = np.atleast_2d(result.values("singular_value"))
    levels = np.atleast_1d(result.values("noise_level"))
    number = np.arange(1, values.shape[1] + 1)
    for each in values:
        axis.plot(number, each, ".", color="C0", alpha=0.6)
    axis.axhline(levels[0], color="0.35", linestyle="--", label="noise only")
    low = max(values[values > 0].min(), 1e-3 * levels[0])
    axis.set(xlabel="index of the singular value", ylabel="singular value of the frames", yscale="log",
             ylim=(0.7 * low, 1.5 * values.max()))
    axis.legend()


def draw_patterns(axis, result):
    patterns = result.values("source_pattern")
    start = patterns.shape[1] // 2
    for number, pattern in enumerate(patterns[:PATTERNS]):
        part = pattern[start:start + SHOWN]
        axis.plot(start + np.arange(len(part)), part + 5 * number, linewidth=0.9)
    axis.set(xlabel="pixel", ylabel="intensity of patterns, offset by 5 each")


def best_shift(truth, found):
    """Returns the shift with which as many found points as possible are close to true ones."""
    shifts = np.subtract.outer(truth, found).ravel()
    off = np.abs(truth[:, None, None] - (found[None, :, None] + shifts)).min(axis=0)
    return shifts[np.median(off, axis=0).argmin()]


def draw_object(axis, result):
    truth, found = result.values("object_x"), []
    for x, brightness in zip(result.values("source_x"), result.values("source_brightness")):
        lit = brightness > 0
        found.append((x[lit] + best_shift(truth, x[lit]), brightness[lit]))
    object_panel.draw(axis, result, found, "sources in each medium")
    axis.set_ylim(0, None)
    axis.legend(loc="lower center")


def draw_places(axis, result):
    x, group = result.values("source_x"), result.values("source_group").astype(int)
    bright = result.values("source_brightness").mean(axis=0)
    for number in np.unique(group):
        own = group == number
        axis.stem(x[own], bright[own] / bright.mean(), linefmt=f"C{number % 10}-", basefmt=" ", label=f"group {number}")
    axis.set(xlabel="position (pixels)", ylabel="brightness / mean brightness", ylim=(0, None))
    if len(np.unique(group)) > 1:
        axis.legend()


@script.plot(one_run=True, needs={"source_x": "needs frames of blinking points"})
def draw(result):
    last = draw_object if result.has("object_x") else draw_places
    return page.side_by_side(result, (draw_singular_values, draw_patterns, last), 1.4 * style.PAGE, 2.9)
