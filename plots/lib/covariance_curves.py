"""Draws memory-effect curves of any number of results of `covariance`, `validate` and `sweep` in one panel, over
tilts or over translations."""

from dataclasses import dataclass

from lib import correlation_panel, labels, page, style, sweep_file, theory
from lib.curve_looks import method_look
from lib.sweep_file import METHODS

import matplotlib.pyplot as plt
import numpy as np


@dataclass
class Series:
    """Field correlation [tilt] of one method, from one result file."""

    label: str
    method: str
    number: int  # index of its colour and symbol
    moves: np.ndarray  # tilts, or translations
    correlation: np.ndarray
    error: np.ndarray
    line: tuple = None  # (moves, C_E) of theory

    @property
    def look(self):
        look = style.look(self.number)
        return {"marker": look["marker"], **method_look(self.method, look["color"])}


MOST_CURVES = 8  # in a panel, so that it stays legible


def is_sweep(result):
    return any(result.has(f"{prefix}field_correlation")
               and result.dataset(f"{prefix}field_correlation").ndim > 1 for prefix in ("", "mc/"))


def read_groups(result):
    """Returns (method, prefix of its datasets) for each method of a result: the groups of a `validate` result, or the
    root of other results."""
    if result.has("mc/field_correlation"):
        return [(method, f"{method}/") for method in METHODS
                if result.has(f"{method}/field_correlation")]
    if not result.has("field_correlation"):
        raise style.Unusable(f"{result.path}: has no field_correlation; needs a sweep, or "
                             'covariance = "memory_effect"')
    method = str(result.attribute("plan", "")).split(":")[0]
    if method not in METHODS:
        raise style.Unusable(f"{result.path}: the attribute plan does not name a method")
    return [(method, "")]


def kind_of_moves(results):
    """Returns "tilt" or "shift" (a translation), the variable that all results have in common."""
    kinds = {"tilt" if is_sweep(result) else
             result.scale(f"{read_groups(result)[0][1]}field_correlation", 0)[0]: result.path
             for result in results}
    if len(kinds) > 1:
        raise style.Unusable(f"{kinds['shift']} is over translations, but {kinds['tilt']} over tilts: "
                             "draw them separately")
    return next(iter(kinds))


def sides(result, prefix):
    """Returns (dataset, suffix of the label) for transmitted and reflected detection directions."""
    first, reflected = f"{prefix}field_correlation", f"{prefix}reflected_field_correlation"
    if not result.has(reflected):
        return [(first, "")]
    return [(first, ", transmitted"), (reflected, ", reflected")]


def result_series(result, label, number):
    """Returns the curves of one result: one for each method and side of the medium."""
    series, groups = [], read_groups(result)
    only_reflected = np.all(np.cos(result.values("view_angle")) < 0)
    for side, (_, of_side) in enumerate(sides(result, groups[0][1])):
        line = theory.reflected if side or only_reflected else theory.transmitted
        for method, prefix in groups:
            name = sides(result, prefix)[side][0]
            if result.dataset(name).ndim != 1:
                raise style.Unusable(f"{result.path}: {name} is not a curve over tilts")
            field, error = result.measured(name)
            words = labels.joined(label, METHODS[method]) + of_side
            series.append(Series(words, method, number + side, result.axis(name, 0), np.real(field),
                                 error, line(result) if method == groups[0][0] else None))
    return series


def sweep_series(result, label, number, arguments):
    """Returns a curve for each point of a sweep."""
    sweep, series = sweep_file.read(result, arguments), []
    stored = sweep.optional("diffusion_theory")
    for place, row in enumerate(sweep.rows):
        line = None if stored is None else \
            theory.of_point(sweep, row, stored[row], theory.fine_tilts(result))
        for method in sweep.prefixes:
            words = labels.joined(label, sweep.label(sweep.varying(), row), METHODS.get(method))
            curve = (column[row] for column in sweep.measured(method, "field_correlation"))
            series.append(Series(words, method, number + place, result.values("tilt"), *curve, line))
    return series


def read_series(results, arguments):
    """Returns the curves of all results. They are labelled by the keys in which their scenes differ, or by their
    files if the keys do not distinguish them."""
    for names in (labels.labels(results), labels.stems(results)):
        series = []
        for result, label in zip(results, names):
            number = len({s.look["color"] for s in series})
            series += sweep_series(result, label, number, arguments) if is_sweep(result) else \
                result_series(result, label, number)
        if len({s.label for s in series}) == len(series):
            break
    if len(series) > MOST_CURVES and len(results) > 1 and any(map(is_sweep, results)):
        raise style.Unusable(f"{len(series)} curves, but a panel can show at most {MOST_CURVES}: "
                             "choose some with --select")
    return series


def draw_theory(axis, series):
    """Draws each line of theory once, in grey if it belongs to several curves. Returns whether there is any line."""
    lines = [s for s in series if s.line is not None]
    same = lambda one, other: one.line[0].shape == other.line[0].shape and \
        np.allclose(one.line, other.line, rtol=1e-9, atol=1e-12)
    for number, s in enumerate(lines):
        if any(same(s, other) for other in lines[:number]):
            continue
        alone = sum(same(s, other) for other in lines) == 1 < len(lines)
        axis.plot(1000 * s.line[0], s.line[1]**2, color=s.look["color"] if alone else style.GREY,
                  linewidth=0.9, zorder=1)
    return bool(lines)


def theory_name(results):
    """Returns the name of the theory for transmitted or reflected light (conventions, C20 and C44)."""
    if all(result.has("reflection_theory") for result in results) and \
            all(labels.side(result) for result in results):
        return "lines: diffusion and single scattering"
    return "lines: diffusion theory"


def shared(results, name):
    """Returns an attribute if it is the same in all files, otherwise None."""
    values = {result.attribute(name) for result in results}
    return values.pop() if len(values) == 1 else None


def share_q(results):
    """Whether a tilt corresponds to the same q L in all files."""
    if shared(results, "depth") is None or not all(result.has("tilt_q") for result in results):
        return False
    scales = [(result.axis("tilt_q", 0), result.values("tilt_q")) for result in results]
    return all(np.array_equal(scales[0], other) for other in scales)


def title(results):
    """Returns a title with the values that all results have in common."""
    names = {"optical_depth": "OD", "g": "$g$", "albedo": "albedo"}
    words = [f"{text} = {shared(results, name):.3g}" for name, text in names.items()
             if shared(results, name) is not None]
    views = {tuple(result.values("view_angle")) if result.has("view_angle") else () for result in results}
    view = views.pop() if len(views) == 1 else ()
    return ", ".join(words + [f"view {style.angle(one)}{labels.side(results[0])}" for one in view
                              if len(view) == 1])


def draw(results, arguments):
    tilts = kind_of_moves(results) == "tilt"
    series, unit = read_series(results, arguments), 1000 if tilts else 1
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    correlation_panel.prepare(
        axis, unit * np.concatenate([s.moves for s in series]),
        correlation_panel.lowest([s.correlation for s in series], [s.error for s in series]),
        arguments)
    unseen = correlation_panel.Unseen()
    for s in series:
        correlation_panel.draw_curve(axis, unit * s.moves, s.correlation, s.error, s.look, unseen)
    if not tilts:
        axis.set_xlabel("translation (unit of length of the scene)")
    elif share_q(results):
        correlation_panel.add_q_axis(axis, results[0], unit * series[0].moves)
    entries = [(plt.Line2D([], [], linestyle="none", **s.look), s.label) for s in series]
    if tilts and draw_theory(axis, series):
        entries.append((plt.Line2D([], [], color=style.GREY, linewidth=0.9), theory_name(results)))
    page.legend_outside(figure, entries, [text for text in [title(results)] if text])
    reflected = ["theory of reflected light: diffusion and single scattering"] \
        if any(result.has("reflection_theory") for result in results) else []
    style.caption(figure, [*unseen.notes(arguments), *reflected])
    return figure
