#!/usr/bin/env python3
"""Statistics of transmission matrices (`flatspeckle matrix`): number of transmission eigenvalues with the bimodal law, and
field correlations of tilted light against the tilt."""

from lib import script, style

import matplotlib.pyplot as plt

CURVES = {"tilt_correlation": "all channels", "normal_tilt_correlation": "normal incidence",
          "open_tilt_correlation": "most open channel"}


@script.plot(dpi=150)
def draw(result):
    result.require("eigenvalue_count", "run matrix")
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.PAGE, 2.6), layout="constrained")
    left.errorbar(result.values("eigenvalue"), result.values("eigenvalue_count"), result.values("eigenvalue_count_error"),
                  **style.symbols(0), label="placements")
    left.plot(result.values("eigenvalue"), result.values("bimodal_count"), **style.line(1), label="bimodal law")
    if result.has("filtered_eigenvalue_count"):
        left.errorbar(result.values("eigenvalue"), result.values("filtered_eigenvalue_count"),
                      result.values("filtered_eigenvalue_count_error"), **style.symbols(2), label="within the aperture")
        left.plot(result.values("eigenvalue"), result.values("filtered_law_count"), **style.line(3), label="filtered law")
    counts = result.values("eigenvalue_count")
    left.set(xlabel=r"transmission eigenvalue $\tau$", ylabel="number in each bin", yscale="log",
             ylim=(0.3 * counts[counts > 0].min(), None))
    left.legend()
    for number, (name, label) in enumerate(CURVES.items()):
        right.errorbar(result.values("tilt"), result.values(name), result.values(f"{name}_error"), **style.symbols(number),
                       label=label)
    right.set(xlabel=r"tilt of the light, $\sin\theta$", ylabel="field correlation $C_E$", ylim=(0, None))
    right.legend()
    return figure
