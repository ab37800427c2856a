#!/usr/bin/env python3
"""Writes the placement and scene of the example of reflection-matrix imaging (docs/exact_solver.md): 2100 weak
cylinders (diameter 0.7, index 1.4) and 84 targets (diameter 0.3, index 2.5) in a box of 140 x 60, index 1.33 around
them, lengths in micrometres; TM polarisation, vacuum wavelengths 0.7 to 1, numerical aperture 0.5, 140 illumination
and 140 detection directions. Writes reflection.csv and reflection.toml into the working folder."""

import numpy as np

WIDTH, DEPTH, AROUND = 140, 60, 1.33
GAP = 0.05  # smallest gap between two disks


def targets():
    """Returns the centres on a 12 by 7 oblique grid, so that no two have the same depth or x."""
    column, row = np.meshgrid(np.arange(12), np.arange(7), indexing="ij")
    x = -WIDTH / 2 + 8 + 11 * column + 0.9 * row
    z = 6 + 8 * row + 0.35 * column
    return np.column_stack([x.ravel(), z.ravel()])


def add_disks(centres, radii, count, radius, random):
    """Adds disks one by one at random positions without overlap."""
    centres, radii = list(centres), list(radii)
    while count > 0:
        new = random.uniform((-WIDTH / 2 + radius, radius), (WIDTH / 2 - radius, DEPTH - radius))
        space = np.hypot(*(np.array(centres) - new).T) - np.array(radii) - radius
        if space.min() > GAP:
            centres.append(new)
            radii.append(radius)
            count -= 1
    return np.array(centres), np.array(radii)


def write_placement(path):
    marks = targets()
    centres, radii = add_disks(marks, [0.15] * len(marks), 2100, 0.35, np.random.default_rng(1))
    index = np.where(radii < 0.2, 2.5, 1.4) / AROUND
    rows = np.column_stack([centres, radii, index, 0 * index])
    np.savetxt(path, rows, delimiter=",", header="x,z,radius,index_re,index_im", comments="",
               fmt="%.9g")


def write_scene(path, placement):
    angles = np.arcsin(np.linspace(-1, 1, 140) * 0.5 / AROUND)
    numbers = {"wavelengths": np.array([0.7, 1]) / AROUND, "light_angles": angles,
               "view_angles": np.pi - angles}
    with open(path, "w") as file:
        file.write(f'placement = "{placement}"\nscatterer = "tm"\ntolerance = 1e-4\n'
                   "wavelength_count = 90\n")
        for key, values in numbers.items():
            file.write(f"{key} = [{', '.join(f'{value:.9g}' for value in values)}]\n")


if __name__ == "__main__":
    write_placement("reflection.csv")
    write_scene("reflection.toml", "reflection.csv")
