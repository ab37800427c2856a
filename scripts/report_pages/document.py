"""Fills tables, numbers and pictures into the template report.md of the benchmark report."""

import pathlib
import re

from lib import bench_figures, number_text

from report_pages.markdown import table
from report_pages.numbers import TARGET, has_slope, seconds_to_target, time_to_target, worst_slope

TEXT = pathlib.Path(__file__).parent / "report.md"


def warnings(bench):
    if len({(file.made.commit, file.made.machine) for file in bench.files().values()}) > 1:
        yield "**The result files are from different commits or machines.**"
    if any(file.made.quick for file in bench.files().values()):
        yield "**Made with `--quick`: the numbers are only approximate.**"


def made(bench):
    made = bench.error.made
    rows = [[f"`flatspeckle bench {name}`", f"{file.made.wall_s:.0f}", f"{file.made.cpu_s:.0f}",
             str(file.made.threads)] for name, file in bench.files().items()]
    return table(["command", "seconds", "CPU seconds", "threads"], rows, "lrrr",
                 f"flatspeckle {made.version}, commit {made.short_commit}, {made.date}, {made.machine}")


def reference_rows(error):
    for scene in error.scenes():
        curves = error.of_scene(scene)
        for reference in dict.fromkeys(curve["reference"] for curve in curves):
            uncertainty = max(curve["reference_uncertainty"] for curve in curves
                              if curve["reference"] == reference)
            yield [scene, reference, number_text.power(uncertainty) if uncertainty else "exact"]


def curve_row(curve, ours):
    if not has_slope(curve):
        seconds, best = seconds_to_target(curve), ours["efficiency"]
        return [curve["method"], "", "", number_text.seconds(seconds),
                number_text.factor(seconds / time_to_target(best)) if best else ""]
    row = [curve["method"], number_text.with_error(curve["slope"], curve["slope_error"])]
    if not curve["is_monte_carlo"]:  # no expected slope
        return [*row, "", "", ""]
    efficiency = curve["efficiency"]
    return [*row, number_text.digits(efficiency), number_text.seconds(time_to_target(efficiency)),
            "" if curve is ours else number_text.factor(ours["efficiency"] / efficiency)]


def accuracy(error):
    header = ["method", "slope", "efficiency (1/s)", f"time to {100 * TARGET:g} %", "\u00d7 ours"]
    for scene in error.scenes():
        curves = error.of_scene(scene)
        ours = next((curve for curve in curves if curve["method"] in ("ours", "bidirectional")),
                    curves[0])
        yield table(header, [curve_row(curve, ours) for curve in curves], "lrrrr",
                    f"{scene}: {bench_figures.title(scene)}")


def coverage(rows):
    """Returns the table of the coverage of error bars. rows: {scene: row}, written by tests/apps/coverage.py."""
    percent = lambda share: f"{100 * share:.1f} %"
    return table(["scene", "values", "ratio", "undersampled", "beyond"],
                 [[name, str(row["values"]), f"{row['ratio']:.2f}", percent(row["marked"]),
                   percent(row["beyond"])] for name, row in rows.items()], "lrrrr")


def cost_row(cost):
    return [cost["task"], cost["size_name"], number_text.digits(cost["size"][0]),
            number_text.digits(cost["size"][-1]),
            number_text.exponent(cost["exponent"], cost["exponent_error"]),
            number_text.digits(cost["expected_exponent"])]


def case_row(row):
    word = "passed" if row["passed"] else "**FAILED**"
    if row["refusal"]:
        word = "refused" if row["passed"] else "**FAILED**, refused"
        return [row["name"], row["invariant"], "", "", f"{word}: {row['refusal']}"]
    return [row["name"], row["invariant"], number_text.power(row["figure"]),
            number_text.power(row["limit"], 1), word]


def plan_row(row):
    if row["difference_in"] == "standard errors":
        text = f"{row['difference']:.1f} standard errors"
    else:
        text = number_text.power(row["difference"]) if row["difference"] else "none"
    return [row["left_out"], row["scene"], number_text.seconds(row["general_s"]),
            number_text.seconds(row["special_s"]), row["per"],
            number_text.plus_minus(row["ratio"], row["ratio_spread"]),
            text if row["passed"] else f"**{text}**"]


def by_module(file, header, row_of, align):
    return [table(header, list(map(row_of, file.of_module(module))), align, bench_figures.module_name(module))
            for module in file.modules()]


def parts_of(bench, numbers, coverage_rows):
    """Returns {name: text} for the names in braces in the template."""
    worst = worst_slope(bench.error)
    tables = {
        "warnings": warnings(bench), "made": [made(bench)], "accuracy": accuracy(bench.error),
        "references": [table(["scene", "reference", "its error"],
                             list(reference_rows(bench.error)), "llr")],
        "coverage": [coverage(coverage_rows)] if coverage_rows else [],
        "costs": [table(["task", "size", "from", "to", "exponent", "expected"],
                        list(map(cost_row, bench.error.costs)), "llrrrr")] if bench.error.costs else [],
        "stability": by_module(bench.stability, ["case", "invariant", "figure", "limit", ""], case_row,
                             "llrrl"),
        "plan": by_module(bench.plan, ["left out", "scene", "general", "specialised", "per", "ratio",
                                     "difference"], plan_row, "llrrlrr")}
    return {**{key: number["text"] for key, number in numbers.items()},
            **{key: "\n\n".join(blocks) for key, blocks in tables.items()},
            "worst": f"{worst['method']} on {worst['scene']}",
            "failed": str(len(bench.stability.failed()) or "None"),
            "seeds": str(min((row["seeds"] for row in (coverage_rows or {}).values()), default=0))}


def filled(section, parts, pictures):
    """Returns the blocks of a section of the template; none if its table is empty."""
    blocks = section.strip().split("\n\n")
    if any(block == f"{{{name}}}" and not parts[name] for block in blocks
           for name in ("coverage", "costs")):
        return []
    shown, captions = [], blocks[1:] + [""]
    for block, caption in zip(blocks, captions):
        if block.startswith("![]"):
            block = block.replace("![]", f"![{caption.strip('*').split('.')[0]}]")
        shown.append(re.sub(r"\{([\w.]+)\}", lambda name: parts[name[1]], block))
    absent = [number for number, block in enumerate(blocks) if block.startswith("![]")
              and block.removeprefix("![](").removesuffix(".png)") not in pictures]
    return [block for number, block in enumerate(shown)
            if block and number not in absent and number - 1 not in absent]


def as_markdown(bench, numbers, pictures, coverage_rows=None):
    """Returns the report. pictures: names of the available figures. coverage_rows: output of
    tests/apps/coverage.py."""
    parts = parts_of(bench, numbers, coverage_rows)
    sections = re.split(r"\n(?=#)", TEXT.read_text())
    return "\n\n".join(block for section in sections
                       for block in filled(section, parts, pictures)) + "\n"
