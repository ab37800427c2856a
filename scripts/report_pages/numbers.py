"""Numbers of the benchmark report: {key: {"value", "error", "text"}}."""

import re

import numpy as np

from lib import number_text

TARGET = 0.01  # relative error whose time is reported


def slug(name):
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


def number(value, error=0.0, text=None):
    return {"value": value, "error": error,
            "text": text or number_text.with_error(value, error)}


def count(rows):
    return number(len(rows), text=str(len(rows)))


def of_seconds(seconds):
    return number(seconds, text=number_text.seconds(seconds))


def time_to_target(efficiency):
    return 1 / (efficiency * TARGET**2)


def has_slope(curve):
    return curve["samples"][0] > 0


def seconds_to_target(curve):
    """Returns the time to the target error of a deterministic solution, whose points differ in tolerance."""
    return curve["cpu_s"][np.argmax(curve["relative_error"] <= TARGET)]


def of_curves(error):
    for curve in error.curves:
        key = f"{slug(curve['scene'])}.{slug(curve['method'])}"
        if not has_slope(curve):
            yield f"time.{key}", of_seconds(seconds_to_target(curve))
            continue
        yield f"slope.{key}", number(curve["slope"], curve["slope_error"])
        if curve["is_monte_carlo"]:
            yield f"efficiency.{key}", number(curve["efficiency"])
            yield f"time.{key}", of_seconds(time_to_target(curve["efficiency"]))
    yield from of_speeds(error)


def of_speeds(error):
    """Yields the efficiency of our method on each scene, divided by that of every other method."""
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


def worst_slope(error):
    """Returns the curve whose slope is farthest from -1/2."""
    return max(error.monte_carlo(), key=lambda curve: abs(curve["slope"] + 0.5))


def of_slopes(error):
    slopes, worst = [curve["slope"] for curve in error.monte_carlo()], worst_slope(error)
    yield "slopes.count", count(slopes)
    yield "slopes.least", number(min(slopes))
    yield "slopes.most", number(max(slopes))
    yield "slopes.worst", number(worst["slope"], worst["slope_error"])


def of_costs(error):
    for cost in error.costs:
        yield f"exponent.{slug(cost['task'])}", number(
            cost["exponent"], cost["exponent_error"],
            number_text.exponent(cost["exponent"], cost["exponent_error"]))


def of_stability(stability):
    rows = stability.rows
    yield "stability.rows", count(rows)
    yield "stability.failed", count(stability.failed())
    yield "stability.refused", count([row for row in rows if row["refusal"]])
    yield "stability.solved", count([row for row in rows if not row["refusal"]])
    for room in stability.rooms():
        yield f"stability.rows.{slug(room)}", count(stability.of_room(room))


def of_plan(plan):
    yield "plan.rows", count(plan.rows)
    yield "plan.failed", count(plan.failed())
    for row in plan.rows:
        yield (f"plan.{slug(row['room'])}.{slug(row['left_out'])}",
               number(row["ratio"], row["ratio_spread"], number_text.factor(row["ratio"])))


def of_making(bench):
    seconds = {f"{name}.minutes": file.made.wall_s for name, file in bench.files().items()}
    for key, value in {**seconds, "minutes": sum(seconds.values())}.items():
        yield f"made.{key}", number(value / 60, text=number_text.digits(value / 60, 2))
    made = bench.error.made
    for key, text in {"machine": made.machine, "commit": made.short_commit, "date": made.date}.items():
        yield f"made.{key}", {"value": text, "error": 0.0, "text": text}


def numbers_of(bench):
    found = {}
    for part in (of_curves(bench.error), of_slopes(bench.error), of_costs(bench.error),
                 of_stability(bench.stability), of_plan(bench.plan), of_making(bench)):
        found.update(part)
    return found
