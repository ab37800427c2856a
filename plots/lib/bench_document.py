"""What the benchmark report says."""

from lib import bench_figures, number_text
from lib.bench_numbers import TARGET, has_slope, seconds_to_target, time_to_target
from lib.document import Figure, Heading, Paragraph, Table

TITLE = "What accuracy costs, where it breaks, what was left out"


def making(bench):
    made = bench.error.made
    yield Heading(1, TITLE)
    same = {(file.made.commit, file.made.machine) for file in bench.files().values()}
    if len(same) > 1:
        yield Paragraph("**The result files are of different commits or machines.**")
    if any(file.made.quick for file in bench.files().values()):
        yield Paragraph("**Made with `--quick`: the figures are only a look.**")
    yield Table(["made by", "seconds", "CPU seconds", "threads"],
                [[f"`flatspeckle bench {name}`", f"{file.made.wall_s:.0f}",
                  f"{file.made.cpu_s:.0f}", str(file.made.threads)]
                 for name, file in bench.files().items()], "lrrr",
                f"flatspeckle {made.version}, commit {made.short_commit}, {made.date}, {made.machine}")
    yield Paragraph("All of it is of that commit, not of later ones. Times are processor seconds of one thread. On another machine they are "
                    "others; ratios, slopes and exponents travel.")


def figure(name, pictures):
    if name in pictures:
        caption = bench_figures.FIGURES[name][1]
        yield Figure(name, caption, caption.split(".")[0])


def reference_rows(error):
    for scene in error.scenes():
        curves = error.of_scene(scene)
        for reference in dict.fromkeys(curve["reference"] for curve in curves):
            of_it = [curve for curve in curves if curve["reference"] == reference]
            uncertainty = max(curve["reference_uncertainty"] for curve in of_it)
            yield [scene, reference, number_text.power(uncertainty) if uncertainty else "exact"]


def curve_rows(error, scene):
    curves = error.of_scene(scene)
    ours = next((curve for curve in curves if curve["method"] in ("ours", "bidirectional")),
                curves[0])
    for curve in curves:
        if not has_slope(curve):
            seconds = seconds_to_target(curve)
            yield [curve["method"], "", "", number_text.seconds(seconds),
                   number_text.factor(seconds / time_to_target(ours["efficiency"])) if ours["efficiency"] else ""]
            continue
        row = [curve["method"], number_text.with_error(curve["slope"], curve["slope_error"])]
        if not curve["is_monte_carlo"]:  # no law to go by
            yield [*row, "", "", ""]
            continue
        relative = ours["efficiency"] / curve["efficiency"]
        yield [*row, number_text.digits(curve["efficiency"]),
               number_text.seconds(time_to_target(curve["efficiency"])),
               "" if curve is ours else number_text.factor(relative)]


def accuracy(bench, pictures):
    error = bench.error
    yield Heading(2, "What accuracy costs")
    yield Paragraph(
        "Every standard scene by every method: the deviation from a reference that is known in "
        "another way, against processor time. Independent samples bring a slope of "
        "\u22121/2. Efficiency is 1/(error\u00b2 \u00d7 CPU seconds); the last "
        "column says how many times as long a method takes as ours to the same error. What is biased "
        "or has no finite variance has neither. Transport draws nothing: its points are tolerances, "
        "its time is that of the first within the target.")
    for name in ("error_flatland", "error_other", "error_render"):
        yield from figure(name, pictures)
    for scene in error.scenes():
        yield Table(["method", "slope", "efficiency (1/s)", f"time to {100 * TARGET:g} %", "\u00d7 ours"],
                    list(curve_rows(error, scene)), "lrrrr",
                    f"{scene}: {bench_figures.title(scene)}")
    yield Heading(3, "How the references are known")
    yield Table(["scene", "reference", "its error"], list(reference_rows(error)), "llr")
    yield Heading(3, "Slopes")
    curves = error.monte_carlo()
    worst = max(curves, key=lambda curve: abs(curve["slope"] + 0.5))
    yield Paragraph(
        f"{len(curves)} Monte Carlo curves; the farthest from \u22121/2 is {worst['method']} "
        f"on {worst['scene']}, {number_text.with_error(worst['slope'], worst['slope_error'])}.")
    yield from figure("slopes", pictures)


def coverage(rows):
    """rows: what tests/apps/coverage.py wrote, {scene: row}."""
    yield Heading(2, "Whether error bars hold")
    seeds = min(row["seeds"] for row in rows.values())
    yield Paragraph(
        f"The program itself, run by {seeds} seeds on each scene. Ratio: the scatter between seeds "
        "over the error that they claim, median over all values of all estimates. Marked: values "
        "whose error a few batches carry, by rare strong paths, which the file says beside them. "
        "Beyond: of all others, those further than 2 claimed errors from the mean of the seeds; 5 % "
        "of real and 2 % of complex numbers should be.")
    percent = lambda share: f"{100 * share:.1f} %"
    yield Table(["scene", "values", "ratio", "marked", "beyond"],
                [[name, str(row["values"]), f"{row['ratio']:.2f}", percent(row["marked"]),
                  percent(row["beyond"])] for name, row in rows.items()], "lrrrr")


def costs(bench, pictures):
    if not bench.error.costs:
        return
    yield Heading(2, "Cost against size")
    yield from figure("costs", pictures)
    yield Table(["task", "size", "from", "to", "exponent", "expected"],
                [[cost["task"], cost["size_name"], number_text.digits(cost["size"][0]),
                  number_text.digits(cost["size"][-1]),
                  number_text.exponent(cost["exponent"], cost["exponent_error"]),
                  number_text.digits(cost["expected_exponent"])]
                 for cost in bench.error.costs], "llrrrr")


def verdict(row):
    word = "passed" if row["passed"] else "**FAILED**"
    if row["refusal"]:
        word = "refused" if row["passed"] else "**FAILED**, refused"
        return f"{word}: {row['refusal']}"
    return word


def case_row(row):
    solved = not row["refusal"]
    return [row["name"], row["invariant"], number_text.power(row["figure"]) if solved else "",
            number_text.power(row["limit"], 1) if solved else "", verdict(row)]


def stability(bench, pictures):
    rows, failed = bench.stability.rows, bench.stability.failed()
    refused = sum(1 for row in rows if row["refusal"])
    yield Heading(2, "Where it breaks")
    yield Paragraph(
        f"{len(rows)} stiff and extreme cases: {len(rows) - refused} are solved, each held to an "
        f"invariant, {refused} are refused, each with the message that it must have. "
        f"{len(failed) or 'None'} failed.")
    yield from figure("limits", pictures)
    for room in bench.stability.rooms():
        yield Table(["case", "invariant", "figure", "limit", ""],
                    [case_row(row) for row in bench.stability.of_room(room)], "llrrl",
                    bench_figures.room_name(room))


def difference(row):
    if row["difference_in"] == "standard errors":
        text = f"{row['difference']:.1f} standard errors"
    else:
        text = number_text.power(row["difference"]) if row["difference"] else "none"
    return text if row["passed"] else f"**{text}**"


def plan(bench):
    yield Heading(2, "What is left out")
    yield Paragraph(
        "Before the first batch a plan is derived from the scene; it picks a kernel without code "
        "for what the scene has no need of. Here the general kernel runs against the specialised "
        "one, in turn on one thread: medians and half the distance of the quartiles. Where both "
        "draw the same random numbers the results agree to rounding; where they cannot, within 4 "
        "standard errors.")
    for room in bench.plan.rooms():
        yield Table(["left out", "scene", "general", "specialised", "per", "ratio", "difference"],
                    [[row["left_out"], row["scene"], number_text.seconds(row["general_s"]),
                      number_text.seconds(row["special_s"]), row["per"],
                      number_text.plus_minus(row["ratio"], row["ratio_spread"]), difference(row)]
                     for row in bench.plan.of_room(room)], "llrrlrr",
                    bench_figures.room_name(room))


def blocks_of(bench, pictures, coverage_rows=None):
    """pictures: names of the figures that there are."""
    return [*making(bench), *accuracy(bench, pictures),
            *(coverage(coverage_rows) if coverage_rows else []), *costs(bench, pictures),
            *stability(bench, pictures), *plan(bench)]
