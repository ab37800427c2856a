#!/usr/bin/env python3
"""Result of `flatspeckle image`: a part of the first frame, its autocorrelation with the peaks expected for each pair
of object points, and the recovered object. The last panel compares the object with the points found in all frames, or
with the first frame divided by a reference."""

from lib import object_panel, page, script, style

import numpy as np

SHOWN = 400  # number of pixels of the frame that are drawn


def best_match(truth, found, resolution):
    """Returns the found points, shifted and possibly mirrored so that as many as possible coincide with points of the
    object."""
    best, most = found, -1
    for each in (found, -found):
        for shift in np.subtract.outer(truth, each).ravel():
            off = np.abs(np.subtract.outer(truth, each + shift)).min(axis=1)
            score = np.sum(off <= resolution) - 0.01 * np.minimum(off, resolution).sum() / resolution
            if score > most:
                best, most = each + shift, score
    return best


def draw_frame(axis, result):
    place = result.values("camera_place")
    frame = result.values("frame")[0]
    middle = len(place) // 2
    part = slice(max(0, middle - SHOWN // 2), middle + SHOWN // 2)
    axis.plot(place[part], frame[part], linewidth=0.8)
    axis.set(xlabel="position on the camera", ylabel="intensity / mean intensity", xlim=place[part][[0, -1]])


def draw_autocorrelation(axis, result):
    distance = result.values("distance")
    all_frames = result.values("autocorrelation")
    noise = result.values("noise")[0]
    axis.axhspan(-noise, noise, color="0.85", label="noise")
    axis.plot(distance, all_frames[0], linewidth=0.9, label="one frame")
    if len(all_frames) > 1:
        axis.plot(distance, result.values("mean_autocorrelation"), linewidth=0.9, color="0.35",
                  linestyle="--", label=f"mean of {len(all_frames)} frames")
    if result.has("pair_distance"):
        height = result.values("pair_signal") * noise
        axis.plot(result.values("pair_distance"), height, "v", markersize=5, markerfacecolor="none",
                  color="C3", label="expected for pairs")
    top = 1.15 * max(all_frames[0][distance > 4 * distance[1]].max(),
                     result.values("contrast")[0]**2 / 3)
    axis.set(xlabel="distance on the object", ylabel=r"$\langle\delta I\,\delta I'\rangle/"
             r"\langle I\rangle^2$", ylim=(-4 * noise, top), xlim=(0, distance[-1]))
    axis.legend()


def draw_object(axis, result):
    truth, found = result.values("object_x"), []
    if result.has("found_x"):
        resolution = 3 * result.values("distance")[1]
        found = [(best_match(truth, x, resolution), brightness) for x, brightness in zip(
            result.values("found_x"), result.values("found_brightness"))]
    brightness = object_panel.draw(axis, result, found, "found in each frame")
    axis.set_ylim(0, 1.35 * brightness.max())
    axis.legend(loc="lower left")


def draw_pictures(axis, result):
    x, truth, pictures = (result.values(name) for name in ("picture_x", "true_picture", "picture"))
    axis.plot(x, truth / truth.max(), color="0.3", linewidth=2.2, alpha=0.5, label="object")
    scale = pictures @ truth / np.sum(pictures**2, axis=1) / truth.max()
    axis.plot(x, scale[0] * pictures[0], linewidth=0.8, color="C3",
              label=f"one frame, {result.values('psnr')[0]:.1f} dB")
    axis.set(xlabel="$x$ on the object", ylabel="frame / reference", xlim=x[[0, -1]])
    axis.legend()


@script.plot(one_run=True, needs={"object_x": "needs a result of image",
                               "frame": "no frames because repeats = 0; needs image with --repeats 1 or more"})
def draw(result):
    last = draw_pictures if result.has("picture") else draw_object
    return page.side_by_side(result, (draw_frame, draw_autocorrelation, last), 1.4 * style.PAGE, 2.9)
