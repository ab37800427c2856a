#!/usr/bin/env python3
"""Transmission matrix between foci (`flatspeckle field` with beams along a line and near sensors along a line): modulus in
the first realization, and mean intensity against the distance between focus and sensor. A second file, a result of
`covariance` with the same lights and views, is drawn as a line."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


def by_distance(result, intensity):
    """Returns distances along x between foci and sensors, and the mean intensities [item, distance] of items [.., light,
    sensor]."""
    away = np.abs(result.values("light_x")[:, None] - result.values("sensor_x")).round(9)
    distances = np.unique(away)
    return distances, np.stack([intensity[..., away == one].mean(axis=-1) for one in distances], axis=-1)


@script.plot(several=True, dpi=150)
def draw(results):
    result, others = results[0], results[1:]
    for name in ("field", "light_x", "sensor_x"):
        result.require(name, "run field with beams and near sensors")
    matrix = result.values("field")
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.PAGE, 2.6), layout="constrained")
    light, sensor = result.values("light_x"), result.values("sensor_x")
    mesh = left.imshow(np.abs(matrix[0]), cmap="inferno", origin="lower",
                       extent=(sensor[0], sensor[-1], light[0], light[-1]), aspect="auto")
    left.set(xlabel="x of the sensor", ylabel="x of the focus")
    figure.colorbar(mesh, ax=left, label="$|u|$")
    distances, means = by_distance(result, np.abs(matrix)**2)
    error = means.std(axis=0, ddof=1) / np.sqrt(len(means))
    right.errorbar(distances, means.mean(axis=0), error, **style.symbols(0), label=f"{len(matrix)} realizations")
    for number, other in enumerate(others):
        distances, means = by_distance(other, other.values("intensity"))
        right.plot(distances, means, **style.line(number + 1), label="covariance")
    right.set(xlabel="distance between focus and sensor along x", ylabel=r"$\langle|u|^2\rangle$", ylim=(0, None))
    right.legend()
    return figure
