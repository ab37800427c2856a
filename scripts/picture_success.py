#!/usr/bin/env python3
"""Success of pictures recovered from simulated frames, against photons and object size, and the prediction. `image` in space
simulates the light of letters of 12 to 40 resolution cells behind boxes with and without faces. The photons of a frame are
drawn here, `recover` retrieves pictures from the frames, and their structural similarity is computed here. Prints a table
for the guides and draws a figure.

    scripts/picture_success.py PROGRAM FOLDER [--photons 1e4 1e5 1e6 1e7]

Results that exist in FOLDER are used again.
"""

import argparse
import pathlib
import subprocess
import sys

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "plots"), str(ROOT / "tests/apps")]

# Letters whose lit pixels are resolution cells
LETTERS = {
    12: ("####", "#...", "###.", "#...", "###."),
    20: ("####.", "#...#", "#...#", "####.", "#...#", "#...#", "####."),
    40: ("########", "########", "##......", "#######.", "##......", "##......", "#######.", "....####"),
}
# Number of cells, optical depth, index of the medium (None: no faces), and number of media, which is larger where success is
# uncertain
OBJECTS = [(12, 5, None, 48), (20, 5, None, 24), (40, 10, None, 24), (12, 5, 1.33, 48)]
SCENE = {"dimension": 3, "width": 200, "height": 200, "depth": 10, "scatterer": "hg", "g": 0.9, "camera_aperture": 0.15,
         "camera_pixels": 192, "seed": 11}
SEARCH = {"starts": 10, "phase_iterations": 300}
LEAST = 0.5  # similarity of a success
CELL = 1 / SCENE["width"]  # a resolution cell, as a difference of sines


def run(program, command, out, **keys):
    """Runs a subcommand, unless its result exists. Returns the datasets of the result and the CPU seconds."""
    words = [word for name, value in keys.items() for word in (f"--{name}", str(value))]
    if not out.exists():
        subprocess.run([program, command, *words, "--out", out], check=True, stdout=subprocess.DEVNULL)
    with h5py.File(out) as file:
        found = {}
        file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
        return found, file.attrs["cpu_s"]


def write_letter(path, rows):
    from frame_files import write_png
    write_png(path, np.array([[255 * (c == "#") for c in row] for row in rows], np.uint8))


def aligned(truth, picture):
    """Returns a picture at the shift and rotation by 180 degrees at which it agrees best with the true one."""
    side, best = len(truth), None
    for turned in picture, picture[::-1, ::-1]:
        spectra = [np.fft.rfft2(one, (2 * side, 2 * side)) for one in (truth, turned)]
        products = np.fft.irfft2(spectra[0] * spectra[1].conj())
        if best is None or products.max() > best[0]:
            shift = [(place + side) % (2 * side) - side for place in np.unravel_index(products.argmax(), products.shape)]
            best = products.max(), turned, shift
    _, turned, (down, across) = best
    wide = np.pad(turned, side)
    return wide[side - down:2 * side - down, side - across:2 * side - across]


def similarity(truth, picture, width):
    """Returns the structural similarity of a picture and the true one, with Gaussian windows of this full width."""
    sigma = width / np.sqrt(8 * np.log(2))
    reach = int(np.ceil(3 * sigma))
    offset = np.subtract.outer(np.arange(len(truth)), np.arange(len(truth)))
    window = np.exp(-(offset / sigma)**2 / 2) * (abs(offset) <= reach)
    window /= window.sum(axis=1, keepdims=True)
    a, b = truth / truth.max(), aligned(truth, picture)
    b = b * (truth * b).sum() / (b * b).sum() / truth.max()
    mean_a, mean_b, aa, bb, ab = (window @ one @ window.T for one in (a, b, a * a, b * b, a * b))
    index = ((2 * mean_a * mean_b + 0.01**2) * (2 * (ab - mean_a * mean_b) + 0.03**2)
             / ((mean_a**2 + mean_b**2 + 0.01**2) * (aa - mean_a**2 + bb - mean_b**2 + 0.03**2)))
    lit = a >= 0.01
    rows, columns = np.flatnonzero(lit.any(axis=1)), np.flatnonzero(lit.any(axis=0))
    return index[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1].mean()


class Simulated:
    """Light of the frames of one object behind many media."""

    def __init__(self, options, cells, depth, index, media):
        self.program, self.folder = options.program, options.folder
        picture = self.folder / f"letter_{cells}.png"
        write_letter(picture, LETTERS[cells])
        faces = {} if index is None else {"medium_index": index}
        self.keys = {**SCENE, **SEARCH, **faces, "optical_depth": depth, "object_picture": picture,
                     "object_width": CELL * len(LETTERS[cells][0]), "least_similarity": LEAST,
                     "prediction_draws": options.draws, "prediction_paths": 100000}
        self.name = f"{cells}_{depth}_{index}"
        found, self.seconds = run(self.program, "image", self.folder / f"light_{self.name}.h5", **self.keys,
                                  repeats=media, paths_per_field=options.paths)
        self.light, self.truth = found["frames"], found["true_picture"]
        self.width = found["resolution"] / (2 * SCENE["camera_aperture"] / SCENE["camera_pixels"])
        own = [similarity(self.truth, one, self.width) for one in found["recovered_picture"]]
        if not np.allclose(own, found["similarity"], atol=1e-6):
            sys.exit(f"similarity by the program: {found['similarity']}, here: {own}")

    def measured(self, photons):
        """Returns the similarity of the pictures from frames with this mean number of photons per pixel."""
        frames, out = self.folder / f"frames_{self.name}.h5", self.folder / f"pictures_{self.name}_{photons:.3g}.h5"
        with h5py.File(frames, "w") as file:
            file["frames"] = np.random.default_rng(5).poisson(photons * self.light).astype(float)
        found, _ = run(self.program, "recover", out, frames=frames, frame_dataset="frames", longest=len(self.truth) - 1,
                       photons=photons, **SEARCH)
        return np.array([similarity(self.truth, one, self.width) for one in found["phased_picture"]])

    def predicted(self, photons):
        return run(self.program, "image", self.folder / f"predicted_{self.name}_{photons:.3g}.h5", **self.keys, repeats=0,
                   photons=photons)


def share(successes):
    """Returns a share of successes and its standard error, from a uniform prior."""
    n, found = len(successes), successes.sum()
    likely = (found + 1) / (n + 2)
    return found / n, np.sqrt(likely * (1 - likely) / (n + 3))


def measured(options):
    """Returns the rows of the table as dictionaries."""
    rows = []
    for cells, depth, index, media in OBJECTS:
        simulated = Simulated(options, cells, depth, index, media)
        for photons in options.photons:
            per_pixel = photons / SCENE["camera_pixels"]**2
            found = simulated.measured(per_pixel)
            prediction, seconds = simulated.predicted(per_pixel)
            recovered, error = share(found > LEAST)
            rows.append({"cells": cells, "depth": depth, "index": index, "photons": photons, "similarity": found.mean(),
                         "similarity_error": found.std() / (len(found) - 1)**0.5, "recovered": recovered, "error": error,
                         "predicted_similarity": prediction["predicted_similarity"],
                         "predicted_similarity_error": prediction["predicted_similarity_error"],
                         "predicted": float(prediction["predicted_recovery"]),
                         "cost": simulated.seconds / media / (seconds / options.draws)})
            show(rows[-1], options)
    return rows


def show(row, options):
    draws = np.arange(options.draws) < round(row["predicted"] * options.draws)
    print(f"| {row['cells']} | {row['depth']} | {row['index'] or '-'} | {row['photons']:,.0f} "
          f"| {row['similarity']:.2f} ± {row['similarity_error']:.2f} "
          f"| {row['predicted_similarity']:.2f} ± {row['predicted_similarity_error']:.2f} "
          f"| {row['recovered']:.2f} ± {row['error']:.2f} | {row['predicted']:.2f} ± {share(draws)[1]:.2f} |", flush=True)


def draw(rows, path):
    from lib import style
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(style.PAGE, 2.4), layout="constrained")
    for number, (cells, depth, index, _) in enumerate(OBJECTS):
        own = [row for row in rows if (row["cells"], row["depth"], row["index"]) == (cells, depth, index)]
        photons = [row["photons"] for row in own]
        faces = "" if index is None else ", faces"
        for axis, value, error, line in ((axes[0], "similarity", "similarity_error", "predicted_similarity"),
                                         (axes[1], "recovered", "error", "predicted")):
            axis.errorbar(photons, [row[value] for row in own], [row[error] for row in own], fmt="o", color=f"C{number}",
                          markersize=3, label=f"{cells} cells, optical depth {depth}{faces}")
            axis.plot(photons, [row[line] for row in own], color=f"C{number}", linewidth=0.9)
    axes[0].set(xscale="log", xlabel="photons per frame", ylabel="structural similarity")
    axes[1].set(xscale="log", xlabel="photons per frame", ylabel="share of pictures recovered")
    axes[0].legend(fontsize=6, loc="upper left")
    figure.savefig(path, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--photons", type=float, nargs="+", default=[1e4, 1e5, 1e6, 1e7],
                        help="photons in a frame")
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--paths", type=int, default=4000, help="light paths of each medium")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    print("| cells | optical depth | index | photons per frame | similarity | predicted | recovered | predicted |\n"
          "|---|---|---|---|---|---|---|---|")
    rows = measured(options)
    draw(rows, options.folder / "picture_success.png")
    close = sum(abs(row["predicted"] - row["recovered"]) <= 0.1 for row in rows)
    print(f"success predicted within 0.1 in {close} of {len(rows)} rows; a simulated picture takes "
          f"{min(row['cost'] for row in rows):.0f} to {max(row['cost'] for row in rows):.0f} times as long as a predicted one")


if __name__ == "__main__":
    main()
