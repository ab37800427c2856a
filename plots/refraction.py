#!/usr/bin/env python3
"""Lateral displacement of the detected light: d arg C / dq of the covariance of matched detection directions at small
tilts. It is the mean distance along x, at z = 0, between the ray that leaves and the ray that enters the medium.
Takes results of `covariance --covariance memory_effect` with far-field detection, for example exact placements first,
then Monte Carlo with and without --index_field mean_field. The lower panel shows the difference from the first
result."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


def name_of(result):
    plan = str(result.attribute("plan", ""))
    if plan.startswith("wave"):
        return f"{result.attribute('samples'):.0f} exact placements"
    refracted = 'index_field = "mean_field"' in str(result.attribute("config", ""))
    return plan.split(":")[0] + (", mean field refracted" if refracted else ", straight")


def displacement(result):
    """Returns detection angles, displacements and their errors. The errors are too large, because they treat the
    tilts as independent."""
    views, q, found = (result.values(name) for name in ("view_angle", "tilt_q", "covariance"))
    if found.shape != (q.size, views.size):
        raise style.Unusable(f"{result.path}: its covariance is not over tilts and detection directions")
    error = result.values("covariance_error") / np.abs(found)
    if found.dtype.names:
        found = found["r"] + 1j * found["i"]
    phase = np.angle(found)
    small = (q != 0) & np.all(np.abs(phase) < 1.3, axis=1)
    if not np.any(small):
        raise style.Unusable(f"{result.path}: no tilt changes all phases by less than 1.3 rad; add smaller tilts")
    q, phase, error = q[small, None], phase[small], error[small]
    return views, np.sum(q * phase, 0) / np.sum(q**2), np.sqrt(np.sum(q**2 * error**2 / 2, 0)) / np.sum(q**2)


NEEDS = "needs far-field detection and --covariance memory_effect"


@script.plot(several=True, needs=dict.fromkeys(("tilt_q", "view_angle", "covariance"), NEEDS))
def draw(results):
    figure, (axis, below) = plt.subplots(2, sharex=True, figsize=(style.COLUMN, 3.6), height_ratios=[3, 2])
    curves = [displacement(result) for result in results]
    views, first, error = curves[0]
    for number, (result, (angles, found, _)) in enumerate(zip(results, curves)):
        look = {**style.look(number), "linewidth": 0.7}
        if not np.array_equal(angles, views):
            raise style.Unusable(f"{result.path}: has other detection directions than {results[0].path}")
        transmitted = np.cos(angles) > 0
        for side, label in ((transmitted, name_of(result)), (~transmitted, None)):
            axis.plot(angles[side], found[side], **look, label=label)
            if number > 0:
                below.plot(angles[side], (found - first)[side], **look)
    below.errorbar(views, 0 * views, error, **style.symbols(0))
    axis.set_ylabel("displacement along $x$")
    below.set_ylabel("minus the first")
    style.angle_axis(below, views, "view")
    axis.legend()
    shift = results[0].attribute("k_shift", 0) * results[0].attribute("wavelength", 1) / (2 * np.pi)
    style.caption(figure, [f"k_shift/k {shift:.3g}; error bars: first result only; "
                           "they treat tilts as independent and are too large"])
    return figure
