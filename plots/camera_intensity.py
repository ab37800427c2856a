#!/usr/bin/env python3
"""Intensities on a camera (`flatspeckle covariance --camera_pixels`), such as the cone of coherent backscattering: a
picture, and the mean over rings around the middle of the camera. Further results, with views at listed
angles and the same light, are drawn as lines, for example one by transport."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

RINGS = 24


def cosines(result):
    """Returns the direction cosines v_x and v_y of the listed views."""
    angle = result.values("view_angle")
    azimuth = result.values("view_azimuth") if result.has("view_azimuth") else np.zeros_like(angle)
    return np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth)


def rings(radius, intensity, error):
    """Returns mean radius, mean intensity and its error in rings; the innermost ring is the middle pixel, if any."""
    edges = np.concatenate([[0], np.linspace(radius.min() + 1e-12, radius.max() / np.sqrt(2), RINGS)])
    found = []
    for low, high in zip(edges, edges[1:]):
        inside = (radius >= low) & (radius < high)
        if inside.any():
            # errors of neighbouring pixels are not independent: all pixels have the same paths
            found.append((radius[inside].mean(), intensity[inside].mean(), error[inside].mean()))
    return np.array(found).T


@script.plot(several=True, dpi=150)
def draw(results):
    result, others = results[0], results[1:]
    if not result.has("camera_x") or not result.has("intensity"):
        raise style.Unusable(f"{result.path}: has no intensities on a camera: take a result of covariance with "
                             "camera_pixels")
    intensity, error = result.values("intensity")[0], result.values("intensity_error")[0]
    x, y = result.values("camera_x"), result.values("camera_y")
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.PAGE, 2.6), layout="constrained")
    half = (x[1] - x[0]) / 2
    mesh = left.imshow(intensity, cmap="inferno", origin="lower",
                       extent=(x[0] - half, x[-1] + half, y[0] - half, y[-1] + half))
    left.set(xlabel="direction cosine $v_x$", ylabel="direction cosine $v_y$")
    figure.colorbar(mesh, ax=left, label="intensity")
    middle = (x[0] + x[-1]) / 2, (y[0] + y[-1]) / 2
    radius = np.hypot(x[None, :] - middle[0], y[:, None] - middle[1])
    at, mean, uncertain = rings(radius, intensity, error)
    right.errorbar(at, mean, uncertain, **style.symbols(0), markersize=3, label="mean over rings")
    for number, other in enumerate(others):
        v_x, v_y = cosines(other)
        distance = np.hypot(v_x - middle[0], v_y - middle[1])
        order = np.argsort(distance)
        right.plot(distance[order], other.values("intensity")[0][order], **style.line(number + 1),
                   label=other.attribute("plan").split(":")[0])
    right.set(xlabel="distance from the middle (direction cosines)", ylabel="intensity")
    right.legend()
    return figure
