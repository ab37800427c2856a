#!/usr/bin/env python3
"""Speckle on a camera or in the image of a lens (`flatspeckle field --camera_pixels`): intensity of the first
realization under each light, or after each delay or shift of the frequency; and the correlation of the intensity
between the first of these fields and the others."""

from lib import script, style
from lib.result_file import Result

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter

BRIGHTEST = 5  # times the mean: 0.7 % of a Gaussian field's intensities are above
MOST_PICTURES = 4
LABELS = {"tilt": "tilt [rad]", "delay": "delay", "frequency_shift": "frequency shift", "light_angle": "light", "light": "light"}
SIDE, BETWEEN = 3.2, 120  # inches of a frame of a movie, and milliseconds between frames


def axis_of(result):
    """Returns the name of the axis of the fields of a realization, and its values."""
    if result.has("tilt"):
        return "tilt", result.values("tilt")
    return result.scale("field", 1)


def moved_columns(intensity, by):
    """Returns the intensity that moved by a number of columns, and which columns it is known in."""
    pixels = intensity.shape[1]
    place = np.arange(pixels) + by
    low = np.floor(place).astype(int)
    part = place - low
    inside = (low >= 0) & (low + (part > 0) < pixels)
    low = np.clip(low, 0, pixels - 2)
    part = np.clip(place - low, 0, 1)
    return (1 - part) * intensity[:, low] + part * intensity[:, low + 1], inside


def shifted(intensity, columns, rows):
    """Returns the intensity that moved by numbers of columns and rows, and which columns and rows it is known in."""
    across, known_columns = moved_columns(intensity, columns)
    down, known_rows = moved_columns(across.T, rows)
    return down.T, known_columns, known_rows


def correlation(first, other):
    """Returns <I I'> / (<I> <I'>) - 1, relative to that of I with itself."""
    def excess(a, b):
        return (a * b).mean() / (a.mean() * b.mean()) - 1
    return excess(first, other) / np.sqrt(excess(first, first) * excess(other, other))


def correlations(result):
    """Returns {label: correlations over realizations, [realization, field]}: in the same pixels and, for far views under
    tilts, in those to which the pattern moves."""
    field = result.dataset("field")
    fixed, matched = np.zeros((2, *field.shape[:2]))
    moves = result.has("tilt") and result.has("camera_x")
    if moves:
        x = result.values("camera_x")
        azimuth = result.attribute("azimuth", 0, "tilt_q")
        by = result.values("tilt_q") * result.attribute("wavelength") / (2 * np.pi) / (x[1] - x[0])
    for number, realization in enumerate(np.abs(field)**2):
        for member, intensity in enumerate(realization):
            fixed[number, member] = correlation(realization[0], intensity)
            if moves:
                pixels = by[member] - by[0]
                moved, columns, rows = shifted(intensity, pixels * np.cos(azimuth), pixels * np.sin(azimuth))
                known = np.ix_(rows, columns)
                matched[number, member] = correlation(realization[0][known], moved[known])
    return {"matched pixels": matched, "same pixels": fixed} if moves else {"same pixels": fixed}


def theory(result):
    """Returns abscissae and |C_E|^2 of a result of `covariance`, of its first light and view."""
    for name in ("field_correlation", "frequency_correlation"):
        if result.has(name):
            _, at = result.scale(name, 0)
            values = np.abs(result.values(name))**2
            return at, values.reshape(len(values), -1)[:, 0]
    raise style.Unusable(f"{result.path}: has no correlation: take a result of covariance with tilts, delays or "
                         "frequency_shifts")


def draw_picture(axis, result, member):
    intensity = np.abs(result.dataset("field")[0, member])**2
    lens = result.has("image_x")
    x, y = (result.values(f"{'image' if lens else 'camera'}_{name}") for name in "xy")
    half = (x[1] - x[0]) / 2
    mesh = axis.imshow(intensity / intensity.mean(), cmap="inferno", vmin=0, vmax=BRIGHTEST, origin="lower",
                       extent=(x[0] - half, x[-1] + half, y[0] - half, y[-1] + half))
    axis.set(xlabel="x" if lens else "direction cosine $v_x$")
    name, values = axis_of(result)
    if len(values) > 1:
        axis.set_title(f"{LABELS[name].split(' [')[0]} {style.short(values)[member]}", fontsize=7)
    return mesh


def write_movie(result, path):
    """Writes a GIF of all fields of the first realization."""
    figure, axis = plt.subplots(figsize=(SIDE, SIDE))

    def show(member):
        axis.clear()
        draw_picture(axis, result, member)
        axis.set(ylabel="y" if result.has("image_x") else "direction cosine $v_y$")
    show(0)
    figure.canvas.draw()
    figure.set_layout_engine("none")  # frames keep the place of the first
    count = result.dataset("field").shape[1]
    movie = FuncAnimation(figure, show, frames=count, interval=BETWEEN, init_func=lambda: None)
    movie.save(path, writer=PillowWriter(fps=1000 / BETWEEN), dpi=100)
    plt.close(figure)


@script.plot(dpi=150)
@script.option("--theory", metavar="RESULT.h5", help="result of covariance, whose |C_E|^2 is drawn as a line")
@script.option("--movie", metavar="FILE.gif", help="also write a movie of all fields of the first realization")
def draw(result, arguments):
    if not (result.has("camera_x") or result.has("image_x")):
        raise style.Unusable(f"{result.path}: has no camera: take a result of field with camera_pixels")
    name, values = axis_of(result)
    count = len(values)
    shown = np.unique(np.linspace(0, count - 1, min(count, MOST_PICTURES)).round().astype(int))
    several = count > 1 and name != "light_angle"
    figure, axes = plt.subplots(1, len(shown) + several, figsize=(style.PAGE, 2.2), squeeze=False, layout="constrained")
    for axis, member in zip(axes[0], shown):
        mesh = draw_picture(axis, result, member)
        if member > 0:
            axis.set_yticklabels([])
    axes[0, 0].set(ylabel="y" if result.has("image_x") else "direction cosine $v_y$")
    figure.colorbar(mesh, ax=axes[0, len(shown) - 1], label=r"intensity $|u|^2/\langle|u|^2\rangle$", extend="max")
    if several:
        last = axes[0, -1]
        for number, (label, of) in enumerate(correlations(result).items()):
            error = of.std(axis=0, ddof=1) / np.sqrt(len(of))
            last.errorbar(values, of.mean(axis=0), error, **style.symbols(number), markersize=3, label=label)
        if arguments.theory:
            last.plot(*theory(Result(arguments.theory)), color="k", linewidth=0.8, label="$|C_E|^2$")
        last.set(xlabel=LABELS[name], ylabel="correlation of intensity")
        last.legend(fontsize=6)
    if arguments.movie:
        write_movie(result, arguments.movie)
    return figure
