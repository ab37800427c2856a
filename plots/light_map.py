#!/usr/bin/env python3
"""Map of `flatspeckle render` with map_cylinder or map_box: the fluence rate in a plane, and the fluence rate with
standard errors along a line. For a cylinder, the map is over radius and depth and the line follows the axis in the
innermost rings. For a box, the plane and the line contain the brightest cell."""

from lib import pictures, script, style

import matplotlib.pyplot as plt
import numpy as np

NAMES = {"fluence": "fluence rate", "absorbed": "absorbed power density"}
PLANES = {"x": ("z", "y"), "y": ("z", "x"), "z": ("x", "y")}


def slice_of(result, name, normal):
    """Returns the names of the two axes of a plane, its values [up, right], the values and errors along the line, and
    a text that gives the position of the line."""
    values, errors = result.measured(f"map/{name}")
    if values.ndim == 2:
        return "depth", "radius", values, values[0], errors[0], "on the axis"
    right, up = PLANES[normal]
    place = dict(zip("xyz", np.unravel_index(np.argmax(values), values.shape)))
    axes = ["xyz".index(up), "xyz".index(right), "xyz".index(normal)]
    values, errors = (np.transpose(each, axes)[:, :, place[normal]] for each in (values, errors))
    at = ", ".join(f"{axis} = {result.values(f'map/{axis}')[place[axis]]:.3g}" for axis in (up, normal))
    return right, up, values, values[place[up]], errors[place[up]], f"at {at}"


@script.plot(one_run=True)
@script.option("--quantity", choices=NAMES, default="fluence")
@script.option("--normal", choices=PLANES, default="y", help="normal of the plane through a box (default: y)")
@pictures.tone_options("log")
def draw(result, arguments):
    length = pictures.length_name(result)
    label = f"{NAMES[arguments.quantity]} ({pictures.unit_name(result, f'map/{arguments.quantity}')})"
    right, up, values, row, errors, where = slice_of(result, arguments.quantity, arguments.normal)
    across, upwards = (result.values(f"map/{name}") for name in (right, up))
    figure, (plane, line) = plt.subplots(1, 2, figsize=(style.PAGE, 2.6))
    norm = pictures.tone([values], arguments)
    image = plane.imshow(values, origin="lower", extent=(*pictures.edges(across), *pictures.edges(upwards)),
                         cmap="inferno", norm=norm, interpolation="nearest", aspect="auto")
    plane.set(xlabel=f"{right} ({length})", ylabel=f"{up} ({length})")
    plane.tick_params(direction="out", top=False, right=False)
    figure.colorbar(image, ax=plane, extend="both", pad=0.02)
    lit = row > 0
    line.errorbar(across[lit], row[lit], pictures.below(row, errors)[lit],
                  **{**style.look(0), "marker": "."})
    line.set(xlabel=f"{right} ({length})", ylabel=label, yscale="log", title=where)
    line.set_ylim(bottom=max(line.get_ylim()[0], row[lit].min() / 3))  # errors may be as large as the values
    return figure
