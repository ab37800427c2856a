"""Pictures for coverage.py: {name: keys of render}; each run takes about a second."""

from program import DATA

SCENES = DATA / "scenes"
BOX = {"stage_box": [-2, -2, -2, 2, 2, 2]}
SKIN = {**BOX, "body_sphere": [0, 0, 0, 1], "index": 1.4, "body_mu_s": 5, "body_mu_a": 0.1,
        "body_phase": "henyey_greenstein", "body_g": 0.9}
BEAM = {"beam_light": [0, 0, -2, 0, 0, 1, 0.5, 1]}
LENS = {"sensor_at": [2, 0, 0], "sensor_direction": [-1, 0, 0], "field_of_view": 1.2,
        "lens_radius": 0.05, "focus_distance": 1.5, "pixels": [12, 12]}
PINHOLE = {"sensor_at": [1.999, 0, 0], "sensor_direction": [-1, 0, 0], "field_of_view": 1.2,
           "pixels": [12, 12]}
FEWER = {"pixels": [24, 16]}

PICTURES = {
    "glass_ball": {"config": SCENES / "render_glass_ball.toml", **FEWER, "samples": 300000},
    "fisheye": {"config": SCENES / "render_fisheye.toml", **FEWER, "samples": 400000},
    "waveguide": {"config": SCENES / "render_waveguide.toml", "pixels": [12, 12], "samples": 200000},
    "fibre": {"config": SCENES / "render_grin_fibre.toml", "path_bins": [80.42, 80.74, 4],
              "pixels": [12, 12], "samples": 20000},
    "fog": {**BOX, "mu_s": 1, "mu_a": 0.1, "point_light": [0, 0, 0, 1], **PINHOLE,
            "samples": 300000},
    "skin_lens": {**SKIN, **BEAM, **LENS, "samples": 1600000},
    "skin_pinhole": {**SKIN, "point_light": [0, 0, -1.5, 1], **PINHOLE, "samples": 150000},
    "luneburg_outside": {**BOX, "field": "luneburg", "radius": 1, "body_mu_s": 1, **BEAM, **LENS,
                         "samples": 120000},
    "map": {**BOX, "mu_s": 5, "mu_a": 0.1, "phase": "henyey_greenstein", "g": 0.9, **BEAM,
            "sensor": "none", "map_cylinder": [0, 0, -2, 0, 0, 2, 1], "map_cells": [8, 16],
            "samples": 20000},
}
