"""The numbers of the benchmark report, each under a key: {"value", "error", "text"}."""

import re

import numpy as np

from lib import number_text

TARGET = 0.01  # error to which times are told


def slug(name):
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


def number(value, error=0.0, text=None):
    return {"value": value, "error": error,
            "text": text or number_text.with_error(value, error)}


def time_to_target(efficiency):
    return 1 / (efficiency * TARGET**2)


def has_slope(curve):
    return curve["samples"][0] > 0


def seconds_to_target(curve):
    """Of a solution without chance, whose points are tolerances."""
    return curve["cpu_s"][np.argmax(curve["relative_error"] <= TARGET)]


def of_curves(error):
    for curve in error.curves:
        key = f"{slug(curve['scene'])}.{slug(curve['method'])}"
        if not has_slope(curve):
            seconds = seconds_to_target(curve)
            yield f"time.{key}", number(seconds, text=number_text.seconds(seconds))
            continue
        yield f"slope.{key}", number(curve["slope"], curve["slope_error"])
        if not curve["is_monte_carlo"]:
            continue
        yield f"efficiency.{key}", number(curve["efficiency"],
                                          text=number_text.digits(curve["efficiency"]))
        seconds = time_to_target(curve["efficiency"])
        yield f"time.{key}", number(seconds, text=number_text.seconds(seconds))
    yield from of_speeds(error)


def of_speeds(error):
    """How many times as efficient as each other method a scene's best one of ours is."""
    for scene in error.scenes():
        curves = {curve["method"]: curve for curve in error.of_scene(scene)}
        ours = curves.get("ours") or curves.get("bidirectional")
        if ours is None:
            continue
        for method, curve in curves.items():
            if curve is not ours and curve["is_monte_carlo"]:
                ratio = ours["efficiency"] / curve["efficiency"]
                yield (f"speed.{slug(scene)}.{slug(method)}",
                       number(ratio, text=number_text.factor(ratio)))


def of_slopes(error):
    curves = error.monte_carlo()
    worst = max(curves, key=lambda curve: abs(curve["slope"] + 0.5))
    slopes = np.array([curve["slope"] for curve in curves])
    yield "slopes.count", number(len(curves), text=str(len(curves)))
    yield "slopes.least", number(float(slopes.min()), text=number_text.digits(slopes.min()))
    yield "slopes.most", number(float(slopes.max()), text=number_text.digits(slopes.max()))
    yield "slopes.worst", number(worst["slope"], worst["slope_error"])


def of_costs(error):
    for cost in error.costs:
        yield f"exponent.{slug(cost['task'])}", number(
            cost["exponent"], cost["exponent_error"],
            number_text.exponent(cost["exponent"], cost["exponent_error"]))


def of_stability(stability):
    rows = stability.rows
    refused = sum(1 for row in rows if row["refusal"])
    for key, count in {"rows": len(rows), "failed": len(stability.failed()), "refused": refused,
                       "solved": len(rows) - refused}.items():
        yield f"stability.{key}", number(count, text=str(count))
    for room in stability.rooms():
        count = len(stability.of_room(room))
        yield f"stability.rows.{slug(room)}", number(count, text=str(count))


def of_plan(plan):
    yield "plan.rows", number(len(plan.rows), text=str(len(plan.rows)))
    yield "plan.failed", number(len(plan.failed()), text=str(len(plan.failed())))
    for row in plan.rows:
        yield (f"plan.{slug(row['room'])}.{slug(row['left_out'])}",
               number(row["ratio"], row["ratio_spread"], number_text.factor(row["ratio"])))


def of_making(bench):
    for name, file in bench.files().items():
        yield f"made.{name}.minutes", number(file.made.wall_s / 60,
                                             text=number_text.digits(file.made.wall_s / 60, 2))
    whole = sum(file.made.wall_s for file in bench.files().values()) / 60
    yield "made.minutes", number(whole, text=number_text.digits(whole, 2))
    made = bench.error.made
    for key, text in {"machine": made.machine, "commit": made.short_commit, "date": made.date}.items():
        yield f"made.{key}", {"value": text, "error": 0.0, "text": text}


def numbers_of(bench):
    found = {}
    for part in (of_curves(bench.error), of_slopes(bench.error), of_costs(bench.error),
                 of_stability(bench.stability), of_plan(bench.plan), of_making(bench)):
        found.update(part)
    return found
