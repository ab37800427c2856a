"""docs/format.md as data: the rows of its tables, and which of them a dataset of a file is."""

import dataclasses
import re

DATASETS, ATTRIBUTES, ROOT_ATTRIBUTES = "dataset", "object", "attribute"  # by their first column
ALTERNATIVES = {"THING": {"ray", "curve"}, "LIGHT": {"light_angle", "light"}, "VIEW": {"view_angle", "sensor"},
                "LIGHT_2": {"light_angle_2", "light_2"}, "VIEW_2": {"view_angle_2", "sensor_2"}}
GRID = ["density", "radius", "index", "optical_depth", "g", "albedo"]


@dataclasses.dataclass(eq=False)
class Row:
    section: str
    name: str
    of_method: bool  # *
    has_error: bool  # ±
    type: str
    axes: list[str]  # alternatives: "scale", "scalar" or "[a, b]"
    units: list[str]
    met: list = dataclasses.field(default_factory=list)  # of Found

    def __str__(self):
        return f"{self.section}: {self.name} {self.type} {' or '.join(self.axes)}"

    def matches(self, name, found):
        return (re.fullmatch(self.name.replace("RUN", "(run|mc|wave)"), name) is not None
                and self.type == found.type and found.units in self.units
                and any(same_axes(axes, found) for axes in self.axes))

    def unmet(self):
        """What the row promises and no file holds."""
        if not self.met:
            return ["no file has it"]
        units = {found.units for found in self.met}
        missing = [f"units {unit}" for unit in self.units if unit not in units]
        seen = {axis for found in self.met if found.axes != "scale" for axis in found.axes}
        for word in set(re.findall(r"\w+", " ".join(self.axes))) & set(ALTERNATIVES):
            missing += [f"axis {axis}" for axis in ALTERNATIVES[word] - seen]
        return missing


@dataclasses.dataclass
class Found:
    """A dataset of a file. axes: "scale" or a tuple, None for an axis without a scale."""
    type: str
    axes: object
    units: str


@dataclasses.dataclass
class AttributeRow:
    type: str
    of: str = ""
    met: bool = False


def same_axes(wanted, found):
    if wanted in ("scale", "scalar"):
        return found.axes == {"scale": "scale", "scalar": ()}[wanted]
    if found.axes == "scale":
        return False
    words, axes = wanted.strip("[]").split(", "), list(found.axes)
    if words[0] == "GRID":
        rest = len(words) - 1
        grid, axes, words = axes[:len(axes) - rest], axes[len(axes) - rest:], words[1:]
        if grid != ["point"] and (not grid or grid != [axis for axis in GRID if axis in grid]):
            return False
    return len(words) == len(axes) and all(
        axis is None if word == "n" else
        axis is not None and re.fullmatch(word.replace("RUN", "(run|mc|wave)"), axis)
        or axis in ALTERNATIVES.get(word, ()) for word, axis in zip(words, axes))


def plain(cell):
    return cell.replace("`", "").strip()


def tables(path):
    """(section, kind, cells) of each row of each table."""
    section, kind = "", None
    for line in path.read_text().splitlines():
        if line.startswith("#"):
            section, kind = plain(line.lstrip("# ")), None
        elif not line.startswith("|"):
            kind = None
        elif kind is None:
            kind = plain(line.split("|")[1])
        elif not line.startswith("|---"):
            yield section, kind, [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


class Document:
    def __init__(self, path):
        self.rows, self.root, self.attributes = [], {}, {}
        for section, kind, cells in tables(path):
            if kind == DATASETS:
                for name, star, error in re.findall(r"`([^`]+)`(\*?)( ±)?", cells[0]):
                    self.rows.append(Row(section, name, bool(star), bool(error), cells[1],
                                         cells[2].split(" or "), plain(cells[3]).split(" or ")))
            elif kind == ROOT_ATTRIBUTES:
                for name in re.findall("`([^`]+)`", cells[0]):
                    self.root[name] = AttributeRow(cells[1], cells[2])
            elif kind == ATTRIBUTES:
                for name in re.findall("`([^`]+)`", cells[0]):
                    for attribute in re.findall("`([^`]+)`", cells[1]):
                        self.attributes[name, attribute] = AttributeRow(cells[2])

    def candidates(self, sections, name, of_method):
        return [row for row in self.rows if row.section in sections and row.of_method == of_method
                and re.fullmatch(row.name.replace("RUN", "(run|mc|wave)"), name)]
