#!/usr/bin/env python3
"""Success of pictures recovered from simulated frames, against photons and object size: `image` in space for letters of 12
to 40 resolution cells, and the prediction. Prints a table for the guides and draws a figure.

    scripts/picture_success.py PROGRAM FOLDER [--repeats 8] [--photons 1e4 1e5 1e6 1e7]
"""

import argparse
import pathlib
import subprocess
import sys

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "plots"), str(ROOT / "tests/apps")]

# Letters whose lit pixels are resolution cells, and the optical depth of the medium
LETTERS = {
    12: (("####", "#...", "###.", "#...", "###."), 5),
    20: ((".###.", "#...#", "#....", "#.###", "#...#", "#...#", ".###."), 5),
    40: (("########", "########", "##......", "#######.", "##......", "##......", "#######.", "....####"), 10),
}
SCENE = {"dimension": 3, "width": 200, "height": 200, "depth": 10, "scatterer": "hg", "g": 0.9, "camera_aperture": 0.15,
         "camera_pixels": 192, "paths_per_field": 4000, "prediction_paths": 100000, "starts": 10, "phase_iterations": 300,
         "least_similarity": 0.5, "seed": 11}
CELL = 1 / SCENE["width"]  # a resolution cell, as a difference of sines


def run(program, out, **keys):
    words = [word for name, value in {**SCENE, **keys}.items() for word in (f"--{name}", str(value))]
    subprocess.run([program, "image", *words, "--out", out], check=True, stdout=subprocess.DEVNULL)
    with h5py.File(out) as file:
        return {name: file[name][()] for name in ("similarity", "recovered", "recovered_error", "predicted_similarity",
                                                  "predicted_similarity_error", "predicted_recovery",
                                                  "separation_correlation")}


def write_letter(path, rows):
    from frame_files import write_png
    write_png(path, np.array([[255 * (c == "#") for c in row] for row in rows], np.uint8))


def measured(options):
    """Returns rows of (cells, optical depth, photons, results)."""
    rows = []
    for cells, (letter, depth) in LETTERS.items():
        picture = options.folder / f"letter_{cells}.png"
        write_letter(picture, letter)
        for photons in options.photons:
            per_pixel = photons / SCENE["camera_pixels"]**2
            found = run(options.program, options.folder / f"p_{cells}_{photons:g}.h5", optical_depth=depth,
                        object_picture=picture, object_width=CELL * len(letter[0]), photons=per_pixel,
                        repeats=options.repeats, average=options.average, prediction_draws=options.draws)
            rows.append((sum(row.count("#") for row in letter), depth, photons, found))
            show(rows[-1])
    return rows


def show(row):
    cells, depth, photons, found = row
    similarity = found["similarity"]
    print(f"| {cells} | {depth} | {photons:g} | {similarity.mean():.2f} ± {similarity.std() / (len(similarity) - 1)**0.5:.2f} "
          f"| {found['predicted_similarity']:.2f} ± {found['predicted_similarity_error']:.2f} "
          f"| {found['recovered']:.2f} ± {found['recovered_error']:.2f} | {found['predicted_recovery']:.2f} |", flush=True)


def draw(rows, path):
    from lib import style
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(style.PAGE, 2.4), layout="constrained")
    for number, (cells, depth) in enumerate(dict.fromkeys(row[:2] for row in rows)):
        own = [row for row in rows if row[:2] == (cells, depth)]
        photons = [row[2] for row in own]
        mean = [row[3]["similarity"].mean() for row in own]
        error = [row[3]["similarity"].std() / (len(row[3]["similarity"]) - 1)**0.5 for row in own]
        axes[0].errorbar(photons, mean, error, fmt="o", color=f"C{number}", markersize=3,
                         label=f"{cells} cells, optical depth {depth}")
        axes[0].plot(photons, [row[3]["predicted_similarity"] for row in own], color=f"C{number}", linewidth=0.9)
        axes[1].errorbar(photons, [row[3]["recovered"] for row in own], [row[3]["recovered_error"] for row in own],
                         fmt="o", color=f"C{number}", markersize=3)
        axes[1].plot(photons, [row[3]["predicted_recovery"] for row in own], color=f"C{number}", linewidth=0.9)
    axes[0].set(xscale="log", xlabel="photons per frame", ylabel="structural similarity")
    axes[1].set(xscale="log", xlabel="photons per frame", ylabel="share of pictures recovered")
    axes[0].legend(fontsize=6)
    figure.savefig(path, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--photons", type=float, nargs="+", default=[1e4, 1e5, 1e6, 1e7],
                        help="photons in a frame")
    parser.add_argument("--repeats", type=int, default=8)
    parser.add_argument("--average", type=int, default=1)
    parser.add_argument("--draws", type=int, default=24)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    print("| cells | optical depth | photons | similarity | predicted | recovered | predicted |\n|---|---|---|---|---|---|---|")
    rows = measured(options)
    draw(rows, options.folder / "picture_success.png")
    close = sum(abs(row[3]["predicted_recovery"] - row[3]["recovered"]) <= 0.1 for row in rows)
    print(f"success predicted within 0.1 in {close} of {len(rows)} cells")


if __name__ == "__main__":
    main()
