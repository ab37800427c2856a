"""Memory-effect curves of any number of results of `covariance` and `validate` in one panel: over
tilts, or over translations."""

import pathlib
import tomllib
from dataclasses import dataclass

from lib import correlation_panel, page, style, theory
from lib.curve_looks import method_look
from lib.sweep_file import METHODS

import matplotlib.pyplot as plt
import numpy as np


@dataclass
class Series:
    """One method's field correlation [tilt], of one result file."""

    label: str
    moves: np.ndarray  # tilts in mrad, or translations
    correlation: np.ndarray
    error: np.ndarray
    look: dict


def read_groups(result):
    """(method, prefix of its datasets): the groups of a `validate` result, the root of others."""
    if result.has("mc/field_correlation"):
        return [(method, f"{method}/") for method in METHODS
                if result.has(f"{method}/field_correlation")]
    if not result.has("field_correlation"):
        raise style.Unusable(f"{result.path}: has no field_correlation; needs a sweep, or "
                             'covariance = "memory_effect"')
    method = str(result.attribute("plan", "")).split(":")[0]
    if method not in METHODS:
        raise style.Unusable(f"{result.path}: attribute plan names no method")
    return [(method, "")]


def kind_of_moves(results):
    """tilt or shift (a translation), whichever all results stand on."""
    kinds = {result.dataset(f"{prefix}field_correlation").dims[0][0].name.strip("/"): result.path
             for result in results for _, prefix in read_groups(result)}
    if len(kinds) > 1:
        raise style.Unusable(f"{kinds['shift']} is of translations, {kinds['tilt']} of tilts: "
                             "draw them one by one")
    return next(iter(kinds))


def file_look(method, number):
    """A colour and symbol per file."""
    look = style.look(number)
    return {"marker": look["marker"], **method_look(method, look["color"])}


def sides(result, prefix):
    """(dataset, what to add to its label): of transmitted and of reflected views."""
    first, reflected = f"{prefix}field_correlation", f"{prefix}reflected_field_correlation"
    if not result.has(reflected):
        return [(first, "")]
    return [(first, ", transmitted"), (reflected, ", reflected")]


def read_series(results, unit):
    """unit: what a move of 1 is drawn as."""
    series = []
    for number, result in enumerate(results):
        groups = read_groups(result)
        for side, (_, of_side) in enumerate(sides(result, groups[0][1])):
            for method, prefix in groups:
                name = sides(result, prefix)[side][0]
                if result.dataset(name).ndim != 1:
                    raise style.Unusable(f"{result.path}: {name} is not a curve over tilts")
                series.append(Series(f"{pathlib.Path(result.path).stem}, {METHODS[method]}{of_side}",
                                     unit * result.axis(name, 0), np.real(result.values(name)),
                                     result.values(f"{name}_error"),
                                     file_look(method, number + side * len(results))))
    return series


def diffusion_line(result, steps=200):
    """(tilts in mrad, C_E) of light through a slab in diffusion theory; None of other scenes."""
    scene = tomllib.loads(result.attribute("config", ""))
    if scene.get("domain") != "slab" or np.all(np.cos(result.values("view_angle")) < 0):
        return None
    order = np.argsort(result.values("tilt"))
    known, q = result.values("tilt")[order], result.values("tilt_q")[order]
    tilt = np.linspace(known[0], known[-1], steps)
    medium = (result.attribute(name) for name in ("depth", "optical_depth", "g", "albedo"))
    return 1000 * tilt, theory.slab_diffusion(*medium, np.interp(tilt, known, q),
                                              theory.dimension(result))


def draw_theory(axis, results):
    """Whether there is any."""
    lines = [diffusion_line(result) for result in results]
    for number, line in enumerate(lines):
        if line is not None:
            look = style.look(number)
            axis.plot(line[0], line[1]**2, color=look["color"], linestyle=look["linestyle"],
                      linewidth=0.7, zorder=1)
    return any(line is not None for line in lines)


def shared(results, name):
    """An attribute that all files agree on, else None."""
    values = {result.attribute(name) for result in results}
    return values.pop() if len(values) == 1 else None


def share_q(results):
    """Whether a tilt is the same q L in all files."""
    if shared(results, "depth") is None or not all(result.has("tilt_q") for result in results):
        return False
    scales = [(result.axis("tilt_q", 0), result.values("tilt_q")) for result in results]
    return all(np.array_equal(scales[0], other) for other in scales)


def title(results):
    names = {"optical_depth": "OD", "g": "$g$", "albedo": "albedo"}
    values = {name: shared(results, name) for name in names}
    return "\n".join(f"{names[name]} = {value:.3g}" for name, value in values.items()
                     if value is not None)


def draw(results, arguments):
    tilts = kind_of_moves(results) == "tilt"
    series = read_series(results, 1000 if tilts else 1)
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    correlation_panel.prepare(
        axis, np.concatenate([s.moves for s in series]),
        correlation_panel.lowest([s.correlation for s in series], [s.error for s in series]),
        arguments)
    unseen = correlation_panel.Unseen()
    for s in series:
        correlation_panel.draw_curve(axis, s.moves, s.correlation, s.error, s.look, unseen)
    correlation_panel.write_title(axis, title(results), [s.correlation for s in series])
    if not tilts:
        axis.set_xlabel("translation (unit of length)")
    elif share_q(results):
        correlation_panel.add_q_axis(axis, results[0], series[0].moves)
    entries = [(plt.Line2D([], [], linestyle="none", **s.look), s.label) for s in series]
    if tilts and draw_theory(axis, results):
        entries.append((plt.Line2D([], [], color="black", linewidth=0.7),
                        "lines: diffusion theory"))
    page.legend_outside(figure, entries)
    style.caption(figure, unseen.notes(arguments))
    return figure
