"""Keys of a subcommand, from the program's table of keys."""

import dataclasses
import functools

from flatspeckle import program

TYPES = {"switch": bool, "integer": int, "number": float, "text": str}


@dataclasses.dataclass(frozen=True)
class Key:
    """A key: all entries of the table with one name. Several kinds of an object may each have an entry for the same
    name."""

    name: str
    type: type
    is_list: bool
    default: object  # None if there is no default
    words: tuple
    unit: str
    accepted: str
    helps: tuple
    group: str
    in_scene_files: bool
    is_file: bool

    @property
    def kind(self):
        """"choice", "file", "text", "number", "integer" or "switch", or a list of these."""
        names = {bool: "switch", int: "integer", float: "number", str: "text"}
        kind = "choice" if self.words else "file" if self.is_file else names[self.type]
        return f"list of {kind}s" if self.is_list else kind


def converted(row):
    """Returns the default as a Python value."""
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
    """Returns {name: Key}, in the order of --help."""
    return read_keys(program.path(), subcommand)


def rows_for(subcommand, values):
    """Returns the keys that a call may use. Sweeps and searches over another subcommand also accept the keys of that
    subcommand."""
    other = {"sweep": values.get("of"), "optimise": values.get("of", "render")}.get(subcommand)
    known = program.table(program.path())["subcommands"]
    own, others = keys_of(subcommand), keys_of(other) if isinstance(other, str) and other in known else {}
    # `points` means the key of the swept subcommand; the sweep's own key is called points_table.
    if "points" in others and "points" in own:
        own = {**own, "points": others["points"], "points_table": dataclasses.replace(own["points"], name="points_table")}
    return {**others, **own}
