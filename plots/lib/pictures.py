"""Axes, units and tone mapping of pictures of `flatspeckle render`."""

from lib import labels, script
from lib.result_file import Result, Unusable

import numpy as np
from matplotlib.colors import LogNorm, Normalize, PowerNorm

LENGTHS = {1.0: "m", 1e-2: "cm", 1e-3: "mm", 1e-6: "µm", 1e-9: "nm"}
BRIGHTEST = 0.999  # quantile of the pixels; brighter ones share one colour
UNITS = {"1/(length^2 sr)": "{}$^{{-2}}$ sr$^{{-1}}$", "1/length^2": "{}$^{{-2}}$", "1/length^3": "{}$^{{-3}}$",
         "1/sr": "sr$^{{-1}}$", "1": ""}
TONES = ("linear", "root", "log")
DARK = 0.01  # fraction of the brightest; if half of the lit pixels are darker, the scale is logarithmic
FAINTEST = 0.02  # quantile of the lit pixels where a logarithmic scale begins
MOST_DECADES = 6


class Sensor(Result):
    """One sensor of a result that has several."""

    def __init__(self, result, name):
        self.path, self.file, self.group = f"{result.path}, {name}", result.file, f"sensors/{name}"

    def locate(self, name):
        """Returns the sensor's own dataset, or else the one that all sensors share."""
        own = f"{self.group}/{name}"
        return own if own in self.file else name


def names_of_sensors(result):
    return list(result.file["sensors"]) if result.has("sensors") else []


def sensors(results):
    """Returns (distinguishing label, sensor) for each sensor of each result."""
    return [(labels.joined(label, name), Sensor(result, name) if name else result)
            for result, label in zip(results, labels.labels(results))
            for name in names_of_sensors(result) or [""]]


def chosen(result, name):
    """Returns one sensor of a result. If the result has several, `name` is required."""
    names = names_of_sensors(result)
    if (name or names) and name not in names:
        raise Unusable(f"{result.path}: --sensor must be one of {' '.join(names) or 'none'}")
    return Sensor(result, name) if name else result


def is_picture(result):
    """Whether the image of a sensor has rows and columns, and more than one pixel."""
    image = result.dataset("image")
    return image.ndim == 2 and image.size > 1


def edges(centres):
    """Returns the outer edges of the first and the last pixel."""
    step = (centres[-1] - centres[0]) / max(len(centres) - 1, 1) or 1
    return centres[0] - step / 2, centres[-1] + step / 2


def length_name(result):
    """Returns the name of the unit of length."""
    unit = result.attribute("length_unit")
    named = [name for metres, name in LENGTHS.items() if unit and np.isclose(metres, unit)]
    return named[0] if named else "length"


def unit_name(result, name):
    """Returns the unit of a dataset, with the name of the unit of length."""
    units = result.dataset(name).attrs["units"]
    return UNITS.get(units, units).format(length_name(result))


def quantity(result):
    """Returns the name of the measured quantity, with its unit."""
    units = result.dataset("image").attrs["units"]
    symbol = {"1/(length^2 sr)": "basic radiance $L/n^2$", "1/length^2": "irradiance"}.get(units, "power")
    return f"{symbol} ({unit_name(result, 'image')})"


def axis_names(result):
    units = result.dataset("row").attrs["units"]
    if units == "length":
        return [f"{side} ({length_name(result)})" for side in ("to the right", "along sensor_up")]
    if result.dataset("image").attrs["units"] == "1/sr":
        return "direction component, sideways", "direction component, upwards"
    return "tangent of the angle, sideways", "tangent of the angle, upwards"


def extent(result):
    left, right = edges(result.values("column"))
    top, bottom = edges(result.values("row"))
    return left, right, bottom, top


def tone(pictures, arguments):
    """Returns a colour norm for all pictures, by the options of tone_options(). Those that are None are chosen from
    the pixel values."""
    kind, decades = arguments.tone, arguments.decades
    values = np.concatenate([np.ravel(picture) for picture in pictures])
    lit = values[values > 0]
    if len(lit) == 0:
        raise Unusable("all pixels are dark")
    low, high = arguments.range or (None, np.quantile(lit, BRIGHTEST))
    kind = kind or ("log" if np.median(lit) < DARK * high else "root")
    if low is not None and not (0 <= low < high and (low > 0 or kind != "log")):
        raise Unusable(f"--range {low:g} {high:g}: must rise from 0 (above 0 for --tone log)")
    if kind == "log":
        span = np.log10(high / np.quantile(lit, FAINTEST))
        return LogNorm(low or high * 10.0**-(decades or np.clip(span, 1, MOST_DECADES)), high, clip=True)
    return Normalize(low or 0, high, clip=True) if kind == "linear" else PowerNorm(0.5, low or 0, high, clip=True)


def tone_options(default=None):
    """Returns a decorator that adds the options --tone, --decades and --range to a plot."""
    words = default or "root, or log if most of the picture is dark"
    tone = script.option("--tone", choices=TONES, default=default,
                         help=f"scale from brightness to colour (default: {words})")
    decades = script.option("--decades", type=float,
                             help="range of --tone log in powers of ten (default: that of the lit pixels)")
    limits = script.option("--range", type=float, nargs=2, metavar=("LOW", "HIGH"),
                           help="values at the ends of the colour scale (default: chosen from the pixels)")
    return lambda draw: tone(decades(limits(draw)))


def height_over_width(result):
    left, right, bottom, top = extent(result)
    return (top - bottom) / (right - left)


def below(values, errors):
    """Returns error bars that a logarithmic axis can show."""
    return np.minimum(errors, 0.999 * values)


def show(axis, result, picture, **look):
    return axis.imshow(picture, origin="upper", extent=extent(result), interpolation="nearest",
                       **look)
