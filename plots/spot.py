#!/usr/bin/env python3
"""Image formed by the rays of `flatspeckle trace` (with image_plane): the spot in the image plane; a ray fan, the
deviation from the mean against the position in the pupil for rays near its axes; the optical path differences
relative to the point where these are smallest; and the spot radius against the position of the plane. With
--wavelength, path differences are in wavelengths, and the Strehl ratio is given (Marechal's approximation, for small
differences)."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

NEAR_AXIS = 0.1  # distance from an axis, in units of the pupil's radius


def pupil(result):
    """Returns pupil coordinates of the rays, from -1 to 1 along two axes perpendicular to their mean direction. They
    are from the starting points or, for rays from a single point, from the directions."""
    numbers = result.values("image/ray").astype(int)
    place, direction = (np.stack([result.values(f"start/{letter}{axis}")[numbers] for axis in "xyz"], axis=-1)
                        for letter in ("", "d"))
    along = direction.mean(axis=0) / np.linalg.norm(direction.mean(axis=0))
    guide = np.array([1, 0, 0] if abs(along[0]) < 0.9 else [0, 1, 0])
    first = guide - along * (guide @ along)
    first /= np.linalg.norm(first)
    axes = np.stack([first, np.cross(along, first)], axis=-1)
    spread = place if np.ptp(place, axis=0).max() > 0 else direction
    across = (spread - spread.mean(axis=0)) @ axes
    return across / max(np.hypot(*across.T).max(), 1e-300)


def scale_of(values):
    """Returns a power of ten by which values are divided for drawing, and the text that gives it."""
    most = np.abs(values).max()
    decade = int(np.floor(np.log10(most))) if most > 0 else 0
    decade = 0 if -2 < decade < 3 else decade
    return 10.0**decade, (f" ($10^{{{decade}}}$)" if decade else "")


def draw_spot(axis, at, radius):
    size, power = scale_of(at)
    axis.plot(*(at / size).T, "o", markersize=1.5, color=style.COLOURS[0])
    axis.plot(*(radius / size * style.circle(100)), color=style.COLOURS[1], label="RMS radius")
    axis.set(xlabel="$x$ from the mean" + power, ylabel="$y$ from the mean" + power, aspect="equal", title="spot")
    axis.margins(0.15)
    axis.legend(loc="upper right", handlelength=1)


def draw_fans(axis, start, values):
    """Draws values, [ray] or [ray, axis], for the rays near each axis of the pupil; for rays along a line, for all.
    Returns the text that gives the power of ten of the values."""
    size, power = scale_of(values)
    for number in (0, 1):
        near = np.flatnonzero(np.abs(start[:, 1 - number]) < NEAR_AXIS)
        near = near[np.argsort(start[near, number])]
        if np.ptp(start[near, number]) > NEAR_AXIS:
            shown = values[near, number] if values.ndim > 1 else values[near]
            axis.plot(start[near, number], shown / size, label="$" + "xy"[number] + "$",
                      **style.look(number) | {"linestyle": "", "markersize": 2})
    return power


def draw_paths(axis, start, difference, wavelength):
    difference = difference / (wavelength or 1)
    spread = f"Strehl {np.exp(-(2 * np.pi * difference.std())**2):.2f}" if wavelength else \
        f"RMS {difference.std():.2g}"
    power = draw_fans(axis, start, difference)
    axis.set(xlabel="pupil coordinate", ylabel=("wavelengths" if wavelength else "length") + power,
             title=f"path difference, {spread}")


def draw_focus(axis, result, at, slope):
    """Draws the RMS radius along the normal, a hyperbola."""
    here, focus = result.values("image/distance"), result.values("image/focus")
    width = max(2 * abs(here - focus), 3 * np.std(at - at.mean(axis=0)) / max(np.std(slope - slope.mean(axis=0)), 1e-300))
    where = np.linspace(focus - width, focus + width, 101)
    spots = at + (where - here)[:, None, None] * slope
    spots -= spots.mean(axis=1, keepdims=True)
    radius = np.sqrt((spots**2).sum(axis=2).mean(axis=1))
    size, power = scale_of(radius)
    axis.plot(where, radius / size, color=style.COLOURS[0])
    axis.axvline(here, color="black", linestyle=":", label="image plane")
    axis.set(xlabel="position along the normal", ylabel="RMS radius" + power, ylim=(0, None), title="through focus")
    axis.legend(handlelength=1.2)


@script.plot(needs={"image/x": "requires trace with --image_plane"})
@script.option("--wavelength", type=float, metavar="LENGTH", help="wavelength, in the unit of lengths of the scene")
def draw(result, arguments):
    at, slope = (np.stack([result.values(f"image/{name}{axis}") for axis in "xy"], axis=-1)
                 for name in ("", "slope_"))
    figure, axes = plt.subplots(2, 2, figsize=(style.PAGE * 0.75, 4.4))
    start, off = pupil(result), at - at.mean(axis=0)
    draw_spot(axes[0, 0], off, result.values("image/spot_radius"))
    power = draw_fans(axes[0, 1], start, off)
    axes[0, 1].set(xlabel="pupil coordinate", ylabel="deviation from the mean" + power, title="ray fan")
    axes[0, 1].legend(handlelength=1)
    draw_paths(axes[1, 0], start, result.values("image/least_path_difference"), arguments.wavelength)
    if result.has("image/focus"):
        draw_focus(axes[1, 1], result, at, slope)
    else:
        axes[1, 1].set_axis_off()
    return figure
