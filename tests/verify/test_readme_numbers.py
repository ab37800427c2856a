#!/usr/bin/env python3
"""Checks that the README's marked numbers equal those in docs/report/numbers.json.

Each number is marked as <!-- report:KEY -->text<!-- /report -->. With --write, each text is replaced by the one of
the report."""

import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
README, NUMBERS = ROOT / "README.md", ROOT / "docs" / "report" / "numbers.json"
MARK = re.compile(r"(<!-- report:(\S+?) -->)(.*?)(<!-- /report -->)", re.DOTALL)
OPENING = re.compile(r"<!-- report:")


def complaints(readme, numbers):
    """Yields one line for each fault."""
    marks = list(MARK.finditer(readme))
    if not marks:
        yield "no number is marked"
    if len(marks) != len(OPENING.findall(readme)):
        yield "a mark is not closed"
    for mark in marks:
        key, text = mark[2], mark[3]
        if key not in numbers:
            yield f"{key}: the report has no such number"
        elif text != numbers[key]["text"]:
            yield f"{key}: {text!r}, but the report has {numbers[key]['text']!r}"


def filled_in(readme, numbers):
    def text_of(mark):
        known = numbers.get(mark[2], {"text": mark[3]})
        return f"{mark[1]}{known['text']}{mark[4]}"

    return MARK.sub(text_of, readme)


def main():
    numbers = json.loads(NUMBERS.read_text())
    readme = README.read_text()
    if "--write" in sys.argv[1:]:
        readme = filled_in(readme, numbers)
        README.write_text(readme)
    found = list(complaints(readme, numbers))
    for complaint in found:
        print(f"README.md: {complaint}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
