"""The keys of a subcommand, by the rows of the program's own table."""

import dataclasses
import functools

from flatspeckle import program

TYPES = {"switch": bool, "integer": int, "number": float, "text": str}


@dataclasses.dataclass(frozen=True)
class Key:
    """The rows of one name: several kinds of a thing may each have their own."""

    name: str
    type: type
    is_list: bool
    default: object  # None where there is none
    words: tuple
    unit: str
    accepted: str
    helps: tuple
    group: str
    in_scene_files: bool
    is_file: bool

    @property
    def kind(self):
        """"choice", "file", "text", "number", "integer", "switch", and whether it is a list."""
        names = {bool: "switch", int: "integer", float: "number", str: "text"}
        kind = "choice" if self.words else "file" if self.is_file else names[self.type]
        return f"list of {kind}s" if self.is_list else kind


def converted(row):
    """The default as Python has it."""
    read = {"switch": lambda text: text == "true", "integer": int, "number": float, "text": str}[row["type"]]
    values = [read(text) for text in row["default"]]
    if row["list"]:
        return tuple(values)
    return values[0] if values else None


def key_of(rows):
    first = rows[0]
    return Key(first["name"], TYPES[first["type"]], first["list"], converted(first), tuple(first["words"]),
               first["unit"], first["accepted"], tuple(row["help"] for row in rows), first["group"],
               first["in_scene_files"], first["file"])


@functools.cache
def read_keys(path, subcommand):
    rows = {}
    for row in program.table(path)["subcommands"][subcommand]["keys"]:
        rows.setdefault(row["name"], []).append(row)
    return {name: key_of(same) for name, same in rows.items()}


def keys_of(subcommand):
    """{name: Key}, in the order of --help."""
    return read_keys(program.path(), subcommand)


def rows_for(subcommand, values):
    """Those that a call may use: sweeps and searches of another subcommand take its keys as well."""
    other = {"sweep": values.get("of"), "optimise": values.get("of", "render")}.get(subcommand)
    known = program.table(program.path())["subcommands"]
    own, others = keys_of(subcommand), keys_of(other) if isinstance(other, str) and other in known else {}
    if "points" in others and "points" in own:  # of the subcommand that is swept; the table of the sweep is named apart
        own = {**own, "points": others["points"], "points_table": dataclasses.replace(own["points"], name="points_table")}
    return {**others, **own}
