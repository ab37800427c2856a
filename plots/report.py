#!/usr/bin/env python3
"""Writes the benchmark report from the three result files of `flatspeckle bench`: report.html, a self-contained page;
report.md with its pictures; and numbers.json, the numbers of the report with a key for each."""

import argparse
import io
import json
import pathlib
import sys

from lib import bench_figures, script
from lib.bench_results import read_bench

import matplotlib.pyplot as plt
from PIL import Image

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "scripts"))
from report_pages import document, markdown
from report_pages.numbers import numbers_of

plt.rcParams.update({"svg.hashsalt": "flatspeckle", "svg.fonttype": "path"})
DPI = 220  # at a width of 7 inches; larger pictures would be too large for a repository


def draw_all(bench, folder):
    """Writes each picture as PNG. Returns {name: SVG} of all pictures for which the files contain data."""
    pictures = {}
    for name, draw in bench_figures.FIGURES.items():
        figure = draw(bench)
        if figure is None:
            continue
        png, svg = io.BytesIO(), io.BytesIO()
        figure.savefig(png, format="png", dpi=DPI)  # a palette of few colours reduces the file to a third
        Image.open(png).convert("RGB").quantize(128).save(folder / f"{name}.png", optimize=True)
        figure.savefig(svg, format="svg", metadata={"Date": None})
        pictures[name] = svg.getvalue()
        plt.close(figure)
    return pictures


def write_report(bench, folder, coverage):
    folder.mkdir(parents=True, exist_ok=True)
    pictures, numbers = draw_all(bench, folder), numbers_of(bench)
    text = document.as_markdown(bench, numbers, pictures, coverage)
    written = {"report.html": markdown.as_html(text, pictures), "report.md": text,
               "numbers.json": json.dumps(numbers, indent=1, ensure_ascii=False, sort_keys=True) + "\n"}
    for name, contents in written.items():
        (folder / name).write_text(contents)
        print(f"wrote {folder / name}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("error", "stability", "plan"):
        parser.add_argument(name, metavar=f"{name.upper()}.h5", help=f"result of flatspeckle bench {name}")
    parser.add_argument("--coverage", metavar="FILE.json", type=pathlib.Path,
                        help="result of tests/apps/coverage.py")
    parser.add_argument("--out", metavar="FOLDER", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    with script.complaints():
        coverage = arguments.coverage and json.loads(arguments.coverage.read_text())
        write_report(read_bench(arguments.error, arguments.stability, arguments.plan),
                     arguments.out, coverage)


if __name__ == "__main__":
    main()
