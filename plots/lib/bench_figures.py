"""Figures of the benchmark report: each function takes a Bench and returns a figure."""

from lib import number_text, page, style

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

HALF = -0.5
SLOPE_BAND = 0.05
LEAST_MARGIN = 1e-9  # smallest deviation / limit on the axis; smaller values are drawn at this edge
OURS = {"color": "black", "marker": "o", "linestyle": "-", "linewidth": 1.3}
LOOKS = {  # a method has the same look in all figures
    "ours": OURS, "bidirectional": OURS, "exact dense": style.look(0), "exact fast": style.look(4),
    "textbook Monte Carlo": style.look(1), "fields": style.look(3), "path tracing": style.look(1),
    "transport": style.look(2),
    "light tracing": style.look(2), "photon map": style.look(3)}
GUIDE = {"color": "0.6", "linewidth": 0.7, "zorder": 0}
TITLES = {"box_points": "31 points in a box, OD 1", "box_cylinders": "67 cylinders in a box, OD 1",
          "box_points_absorbing": "absorbing points in a box", "slab_hg": "slab, OD 5, g 0.8",
          "slab_two_term_hg": "slab, OD 5, two-term phase function",
          "slab_hg, in space": "3D slab, OD 5",
          "luneburg": "Luneburg ball", "waveguide": "ultrasonic waveguide",
          "slab": "slab, straight rays", "glass_ball": "glass ball in fog",
          "luneburg_even": "Luneburg ball, isotropic light",
          "glass_ball_beam": "glass ball under a beam", "balls_even": "balls, isotropic light",
          "ring_even": "ring of triangles, isotropic light", "absorbing_ball": "absorbing ball of triangles",
          "slab_hg, flow": "slab, OD 5, flow"}
BOXES = ("box_points", "box_cylinders")
MODULE_NAMES = {"mc": "Monte Carlo", "wave": "wave solver", "wave_solver": "wave solver"}


def title(scene):
    return TITLES.get(scene, scene.replace("_", " "))


def module_name(module):
    return MODULE_NAMES.get(module, module)


def base_method(method):
    """Returns the name of a method without its qualification, such as "photon map" for "photon map, biased by its
    radius"."""
    return method.split(",")[0]


def method_look(method):
    return LOOKS.get(base_method(method), style.look(5))


def draw_guide(axis, curves):
    """Draws a guide of slope -1/2 above the Monte Carlo curve that is highest at equal times, if there are such
    curves."""
    random = [curve for curve in curves if curve["is_monte_carlo"]]
    if not random:
        return
    level = lambda curve: np.max(curve["relative_error"] * np.sqrt(curve["cpu_s"]))
    highest = max(random, key=level)
    ends = highest["cpu_s"][[0, -1]]
    axis.loglog(ends, 1.6 * level(highest) / np.sqrt(ends), **GUIDE)


def draw_error_curves(axis, curves):
    for curve in curves:
        axis.errorbar(curve["cpu_s"], curve["relative_error"], curve["relative_error_error"],
                      elinewidth=0.7, **method_look(curve["method"]))
    axis.set_xscale("log")
    axis.set_yscale("log", nonpositive="clip")
    draw_guide(axis, curves)
    style.no_minor_numbers(axis)
    low, high = axis.get_ylim()
    if high < 150 * low:  # otherwise the axis would have too few labels
        style.few_decades(axis.yaxis)
    axis.set_title(title(curves[0]["scene"]))


def method_entries(curves):
    methods = dict.fromkeys(base_method(curve["method"]) for curve in curves)
    for method in methods:
        name = "Monte Carlo, ours" if method == "ours" else method
        yield plt.Line2D([], [], **method_look(method)), name
    yield plt.Line2D([], [], **GUIDE), r"slope $-1/2$"


def panels(count, across, head, height, **looks):
    """Returns figure and axes of a page of panels."""
    down = -(-count // across)
    figure, axes = plt.subplots(down, across, squeeze=False, **looks,
                                figsize=(style.PAGE, head + height * down))
    for axis in axes.flat[count:]:
        axis.remove()
    return figure, axes


def error_panels(error, scenes, across):
    figure, axes = panels(len(scenes), across, 0.35, 2.25, sharey=across < 3)
    shown = []
    for axis, scene in zip(axes.flat, scenes):
        curves = [curve for curve in error.of_scene(scene) if len(curve["cpu_s"]) > 0]
        draw_error_curves(axis, curves)
        shown += curves
    for axis in axes[:, 0]:
        axis.set_ylabel("relative error")
    figure.supxlabel("processor time, one thread (s)", fontsize=8)
    entries = list(method_entries(shown))
    page.legend_above(figure, entries, min(len(entries), 6))
    return figure


def scenes_of(error, flat):
    """Returns the scenes of flatland, recognised by the method "ours", or all other scenes."""
    return [scene for scene in error.scenes()
            if flat == any(curve["method"] == "ours" for curve in error.of_scene(scene))]


def draw_flatland(bench):
    scenes = scenes_of(bench.error, True)
    return error_panels(bench.error, [scene for scene in BOXES if scene in scenes] or scenes[:2], 2)


def draw_other_flatland(bench):
    scenes = [scene for scene in scenes_of(bench.error, True) if scene not in BOXES]
    return error_panels(bench.error, scenes, max(len(scenes), 2)) if scenes else None


def draw_render(bench):
    scenes = scenes_of(bench.error, False)
    return error_panels(bench.error, scenes, 3) if scenes else None


def name_rows(axis, names, ends=(-0.6, -0.4), **looks):
    """Labels one row for each name, from top to bottom. ends: margins of the axis beyond the first and the last
    row."""
    axis.set_yticks(range(len(names)), names, **looks)
    axis.set_ylim(len(names) + ends[1], ends[0])
    axis.tick_params(axis="y", length=0)


def draw_slopes(bench):
    curves = bench.error.monte_carlo()
    figure, axis = plt.subplots(figsize=(style.PAGE * 0.8, 0.7 + 0.155 * len(curves)))
    axis.axvspan(HALF - SLOPE_BAND, HALF + SLOPE_BAND, color="0.92", zorder=0)
    axis.axvline(HALF, color=style.GREY, linewidth=0.8, zorder=0.5)
    for row, curve in enumerate(curves):
        look = {**method_look(curve["method"]), "linestyle": "none"}
        axis.errorbar(curve["slope"], row, xerr=curve["slope_error"], elinewidth=0.7, **look)
    name_rows(axis, [f"{title(curve['scene'])}: {curve['method']}" for curve in curves])
    widest = max(abs(curve["slope"] - HALF) + curve["slope_error"] for curve in curves)
    reach = max(1.6 * SLOPE_BAND, 1.1 * widest)
    axis.set(xlim=(HALF - reach, HALF + reach), xlabel="fitted slope (band: $-1/2 \\pm 0.05$)")
    return figure


def draw_cost(axis, cost):
    size, value = cost["size"], cost["cost_value"]
    axis.loglog(size, value, color=style.COLOURS[0], marker="o", linestyle="none")
    large = slice(len(size) // 2, None)  # small sizes need not follow the power law
    scale = np.exp(np.mean((np.log(value) - cost["exponent"] * np.log(size))[large]))
    axis.loglog(size, scale * size**cost["exponent"], color=style.COLOURS[0], zorder=0.5)
    axis.loglog(size, value[-1] * (size / size[-1])**cost["expected_exponent"], color=style.GREY,
                linestyle="--", zorder=0.4)
    axis.set_title(cost["task"].replace(", ", ",\n"), fontsize=7)
    axis.set_xlabel(cost["size_name"], fontsize=7)
    axis.text(0.05, 0.93, number_text.exponent(cost["exponent"], cost["exponent_error"]),
              transform=axis.transAxes, va="top", fontsize=7)
    style.no_minor_numbers(axis)
    if size.max() < 10 * size.min():
        style.few_decades(axis.xaxis)


def draw_costs(bench, across=5):
    costs = [cost for cost in bench.error.costs if len(cost["size"]) > 0]
    if not costs:
        return None
    figure, axes = panels(len(costs), across, 0.4, 1.6)
    for number, (axis, cost) in enumerate(zip(axes.flat, costs)):
        draw_cost(axis, cost)
        if number % across == 0 or cost["cost_name"] != costs[number - 1]["cost_name"]:
            axis.set_ylabel(cost["cost_name"], fontsize=7)
    entries = [(plt.Line2D([], [], color=style.COLOURS[0], marker="o"), "measured, with fitted exponent"),
               (plt.Line2D([], [], color=style.GREY, linestyle="--"), "expected from counting operations")]
    page.legend_above(figure, entries, 2)
    return figure


def draw_margins(axis, stability):
    """Draws deviation / limit of every case, module by module, and at the right the number of rejected cases."""
    modules = stability.modules()
    for place, module in enumerate(modules):
        rows, look = stability.of_module(module), {**style.look(place), "linestyle": "none"}
        solved = [row for row in rows if not row["refusal"]]
        margin = np.array([row["figure"] / (row["limit"] if row["limit"] > 0 else 1) for row in solved])
        order = np.argsort(np.argsort(margin))
        heights = place + 0.62 * ((order * 0.618) % 1 - 0.5)
        seen, failed = margin >= LEAST_MARGIN, np.array([not row["passed"] for row in solved])
        axis.plot(margin[seen], heights[seen], **look, alpha=0.85, markeredgewidth=0)
        axis.plot(0 * margin[~seen] + 1.3 * LEAST_MARGIN, heights[~seen], **{**look, "marker": "<"})
        axis.plot(margin[failed], heights[failed], "o", color="black", markersize=7, fillstyle="none")
        axis.text(1.02, place, str(len(rows) - len(solved)), transform=axis.get_yaxis_transform(),
                  va="center", fontsize=7)
    axis.axvline(1, color="black", linewidth=0.8)
    axis.set(xscale="log", xlim=(LEAST_MARGIN, 5), xlabel="deviation from the invariant / limit")
    axis.xaxis.set_major_locator(LogLocator(numticks=6))
    axis.xaxis.set_minor_locator(NullLocator())
    name_rows(axis, [f"{module_name(module)}\n{len(stability.of_module(module))} cases" for module in modules],
              (-0.5, -0.5))
    for place in range(1, len(modules)):
        axis.axhline(place - 0.5, color="0.9", linewidth=0.5, zorder=0)
    axis.text(1.02, 1.0, "rejected", transform=axis.transAxes, va="bottom", fontsize=7)
    axis.set_title(f"(a) {len(stability.rows)} extreme cases", loc="left")


def draw_ratios(axis, plan):
    """Draws the ratio of times of every comparison; the rows of a module are below its name."""
    place, ticks, names = 0, [], []
    for number, module in enumerate(plan.modules()):
        ticks.append(place)
        names.append(module_name(module))
        look = {**style.look(number), "linestyle": "none"}
        for row in plan.of_module(module):
            place += 1
            axis.errorbar(row["ratio"], place, xerr=row["ratio_spread"], elinewidth=0.7, **look)
            ticks.append(place)
            names.append(row["left_out"])
        place += 1.3
    axis.axvline(1, color=style.GREY, linewidth=0.8, zorder=0)
    axis.set_xscale("log")
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5), numticks=12))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_yticks(ticks, names, fontsize=6)
    modules = {module_name(module) for module in plan.modules()}
    for label in axis.get_yticklabels():
        if label.get_text() in modules:
            label.set(weight="bold", fontsize=6.5)
    axis.set_ylim(place - 0.6, -1)
    axis.tick_params(axis="y", length=0)
    axis.set_xlabel("time with the feature / time without it")
    axis.set_title("(b) features omitted by plans", loc="left")


def draw_limits(bench):
    height = max(3.2, 0.9 + 0.125 * (len(bench.plan.rows) + 2.3 * len(bench.plan.modules())))
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.PAGE, height),
                                         gridspec_kw={"width_ratios": [1, 1.05]})
    draw_margins(left, bench.stability)
    draw_ratios(right, bench.plan)
    return figure


FIGURES = {"error_flatland": draw_flatland, "error_render": draw_render, "limits": draw_limits,
           "error_other": draw_other_flatland, "slopes": draw_slopes, "costs": draw_costs}
