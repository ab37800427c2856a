#!/usr/bin/env python3
"""Map of `flatspeckle render` with map_cylinder or map_box: the fluence rate, and beside it the fluence
rate with its standard errors along a line. Of a cylinder: radius and depth, and along the axis in the
innermost rings; of a box: the plane and the line of cells through the brightest one."""

from lib import style
from lib import pictures
from lib.result_file import Unusable

import matplotlib.pyplot as plt
import numpy as np

NAMES = {"fluence": "fluence rate", "absorbed": "absorbed power density"}
PLANES = {"x": ("z", "y"), "y": ("z", "x"), "z": ("x", "y")}


class Slice:
    """Values [up, right] of a plane and those of the row that is drawn apart."""

    def __init__(self, right, up, values, errors, row, where):
        self.right, self.up, self.values, self.row, self.where = right, up, values, row, where
        self.line, self.errors = values[row], errors[row]


def of_rings(result, values, errors):
    return Slice("depth", "radius", values, errors, 0, "on the axis")


def of_box(result, values, errors, normal):
    right, up = PLANES[normal]
    place = dict(zip("xyz", np.unravel_index(np.argmax(values), values.shape)))
    axes = ["xyz".index(up), "xyz".index(right), "xyz".index(normal)]
    plane, plane_errors = (np.transpose(each, axes)[:, :, place[normal]] for each in (values, errors))
    at = ", ".join(f"{axis} = {result.values(f'map/{axis}')[place[axis]]:.3g}" for axis in (up, normal))
    return Slice(right, up, plane, plane_errors, place[up], f"at {at}")


def slice_of(result, name, normal):
    if not result.has(f"map/{name}"):
        raise Unusable(f"{result.path}: no map/{name}")
    values, errors = result.values(f"map/{name}"), result.values(f"map/{name}_error")
    if values.ndim == 2:
        return of_rings(result, values, errors)
    return of_box(result, values, errors, normal)


def draw(results, arguments):
    for result in results:
        result.refuse_sweep()
    result = results[0]
    length = pictures.length_name(result)
    units = {"1/length^3": f"{length}$^{{-3}}$"}.get(
        result.dataset(f"map/{arguments.quantity}").attrs["units"], f"{length}$^{{-2}}$")
    label = f"{NAMES[arguments.quantity]} ({units})"
    drawn = slice_of(result, arguments.quantity, arguments.normal)
    right, up = (result.values(f"map/{name}") for name in (drawn.right, drawn.up))
    figure, (plane, line) = plt.subplots(1, 2, figsize=(style.PAGE, 2.6))
    norm = pictures.tone([drawn.values], arguments.tone, arguments.decades)
    image = plane.imshow(drawn.values, origin="lower", extent=(*pictures.edges(right), *pictures.edges(up)),
                         cmap="inferno", norm=norm, interpolation="nearest", aspect="auto")
    plane.set(xlabel=f"{drawn.right} ({length})", ylabel=f"{drawn.up} ({length})")
    plane.tick_params(direction="out", top=False, right=False)
    figure.colorbar(image, ax=plane, label=label, extend="both", pad=0.02)
    lit = drawn.line > 0
    line.errorbar(right[lit], drawn.line[lit], np.minimum(drawn.errors, 0.999 * drawn.line)[lit],
                  **{**style.look(0), "marker": "."})
    line.set(xlabel=f"{drawn.right} ({length})", ylabel=label, yscale="log", title=drawn.where)
    return figure


def add_options(parser):
    parser.add_argument("--quantity", choices=NAMES, default="fluence")
    parser.add_argument("--normal", choices=PLANES, default="y", help="of the plane through a box (default: y)")
    pictures.add_tone_options(parser, "log")


if __name__ == "__main__":
    style.main(draw, __doc__, add_options=add_options)
