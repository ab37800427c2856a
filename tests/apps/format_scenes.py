"""Tiny runs of every subcommand that together cover every row of docs/format.md."""

import math

import h5py

from program import BOX, CYLINDERS, SLAB, ProgramTest

FAR = {"light_angles": [0, 0.3], "view_angles": [0.1, 0.5, 3.0]}
NEAR = {"near_sources": "sources.csv", "near_sensors": "sensors.csv", "method": "wave"}
SINES = [round(math.asin(0.02 * i), 9) for i in range(12)]
TILTS = {"covariance": "memory_effect", "tilts": [0, 0.04, 0.16]}
SMALL_TILTS = {**TILTS, "tilts": [0, 0.001]}
FULL = {"covariance": "full"}
PAIRS = {"covariance": "pairs", "pairs": [0, 0.1, 0.04, 0.14, 0, 0.5, 0, 0.5]}
MAP = {"covariance": "tilt_shift", "tilts": [0, 0.01, 0.03], "shifts": [-0.1, 0, 0.1]}
MOVED = {"covariance": "translation", "shifts": [0, 0.2, 0.5], "beam_waist": 2}
SIDES = {"view_angles": [0.1, 3.0]}
HG = {"width": 20, "depth": 10, "scatterer": "hg", "optical_depth": 2, "g": 0.5, "albedo": 0.9}
DISKS = {"width": 12, "depth": 8, "radii": 0.4, "packing_fraction": 0.4, "realizations": 4}
GRID = {"depth": 100, "optical_depth": [1, 2], "albedo": [1, 0.9], "g": [0, 0.5],
        "tilts": [0, 0.001, 0.002, 0.003]}
RAYS = {"ray_count": 3, "max_length": 5, "path_points": 5}
STAGE = {"field": "parabolic", "index": 1.5, "alpha": 0.5, "stage_box": [-1, -1, 0, 1, 1, 4],
         "mu_s": 0.5, "point_light": [0, 0, 1, 1], "path_bins": [1, 9, 4], "path_moments": True,
         "pixels": [30, 20]}

TAGGED = {**STAGE, "field": "transducers", "alpha": None, "transducer": [1e-5, 5, 0, 0, 0, 0, 1, 0, 0, 0],
          "tag_wavelength": 5e-4, "method": "forward", "path_bins": None, "path_moments": None}
GRADIENT = {"gradient": True, "method": "forward", "delays": [0, 0.1]}


def wedge():
    """Returns a tetrahedron as STL text."""
    corners = ["0 0 1", "1 0 1", "0 1 1", "0 0 2"]
    return "solid wedge\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {corners[i]}\n" for i in facet) + "endloop\nendfacet\n"
        for facet in ([0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3])) + "endsolid wedge\n"


FILES = {
    "curve.csv": "tilt,field_correlation,error\n0.002,0.8,0.05\n0.004,0.6,0.05\n",
    "frames.csv": "a,b\n" + "".join(f"{1 + i * i % 7},{1 + i * i % 11}\n" for i in range(80)),
    "decay.csv": "delay,field_correlation,error\n0.01,0.9,0.01\n0.02,0.8,0.01\n",
    "sensors.csv": "x,z\n0,13\n3,15\n",
    "sources.csv": "x,z\n1,-3\n2,-4\n",
    "sources_3d.csv": "x,y,z\n1,1,-3\n2,0,-4\n",
    "sensors_3d.csv": "x,y,z\n1,1,15\n2,0,14\n",
    "line.csv": "x,z\n" + "".join(f"{0.5 * i},14\n" for i in range(10)),
    "tissue.csv": "thickness,mu_s,mu_a,g,diffusion\n2,10,0.02,0.9,0.5\n100,5,0.01,0.8,1\n",
    "layers.csv": "thickness,density\n3,0.05\n3,0.25\n4,0.15\n",
    "blobs.csv": "x,z,radius,amplitude\n-2,4,2,-1\n5,7,1.5,2\n",
    "disks.csv": "x,z,radius\n0,0,0.3\n1,2,0.2\n",
    "frame_picture.csv": "".join(",".join(str(1 + (i * i + 3 * j * i) % 11) for i in range(64)) + "\n" for j in range(64)),
    "lights.csv": "light,channel,re,im\n0,3,1,0.5\n0,4,1,0\n",
    "three.csv": "x,z\n0,1\n3,4\n-5,9\n",
    "places.csv": "x,z,angle\n0,0,0\n9,1,2\n",
    "picture.csv": "1,2,3,4\n" * 4,
    "wedge.stl": wedge(),
    "shapes.json": '{"Domain": {"Dim": [2, 2, 2]}, "Shapes": [{"Grid": {"Tag": 1, "Size": [2, 2, 1]}}]}',
    "distances.csv": "distance,delay,intensity_correlation,error\n5,0.001,0.9,0.01\n5,0.01,0.5,0.01\n5,0.1,0.05,0.01\n",
    "predictions.csv": "prediction_paths\n400\n500\n",
    "disk_points.csv": "density,radius,index,index_imaginary\n0.1,0.2,1.5,0\n0.2,0.1,1.4,0.01\n",
}

# name: subcommand, keys, exit status if not 0
IMAGE = {"domain": "box", "width": 60, "depth": 10, "scatterer": "hg", "g": 0.5, "optical_depth": 2,
         "object_x": [0, 20], "object_depth": -500, "camera": [-0.3, 0.3], "pixels": 128,
         "repeats": 2, "paths_per_field": 20, "prediction_paths": 500, "samples": None}

SPACE_IMAGE = {"dimension": 3, "width": 30, "height": 30, "depth": 10, "scatterer": "hg", "g": 0.5, "optical_depth": 4,
               "camera_pixels": 64, "camera_aperture": 0.4, "repeats": 2, "starts": 2, "phase_iterations": 8,
               "prediction_draws": 2, "prediction_paths": 2000, "paths_per_field": 500, "samples": None}

FIT = {"free": ["g=0:0.8"], "depth": 100, "optical_depth": 2, "measurement": "curve.csv"}

RUNS = {
    "intensity": ("covariance", {**BOX, **FAR}),
    "checked": ("covariance", {**BOX, "samples": 200000}),
    "box_in_space": ("covariance", {**BOX, "dimension": 3, "height": 5, "light_azimuths": 1, "view_angles": 0.4, "view_azimuths": 2}),
    "tilted_across": ("covariance", {**BOX, "dimension": 3, "height": 5, "light_angles": 0.2, "view_angles": [0.1, 2.9], "covariance": "memory_effect",
                                     "tilts": [0, 0.02], "tilt_azimuth": 1}),
    "camera_across": ("field", {**BOX, "dimension": 3, "height": 5, "view_angles": 0, "camera_pixels": 8, "camera_aperture": 0.2,
                                "fields": 2, "tilts": [0, 0.02], "tilt_azimuth": 1, "method": "paths", "samples": None}),
    "space_near": ("covariance", {**BOX, "dimension": 3, "height": 5, "near_sources": "sources_3d.csv", "near_sensors": "sensors_3d.csv"}),
    "space_solve": ("solve", {"width": 10, "depth": 8, "height": 5, "count": 5, "scatterer": "soft", "radius": 0.1, "dimension": 3,
                            "light_angles": 0.2, "light_azimuths": 1, "view_angles": 0.4, "near_sensors": "sensors_3d.csv"}),
    "far_camera": ("field", {**BOX, "dimension": 3, "height": 5, "view_angles": 0, "camera_pixels": 8, "camera_aperture": 0.2, "fields": 2,
                         "method": "paths", "samples": None}),
    "lens_image": ("field", {**BOX, "dimension": 3, "height": 5, "view_angles": 0, "camera_pixels": 8, "camera_aperture": 0.2,
                       "camera_focus": 3, "fields": 2, "delays": [0, 0.1], "method": "paths", "samples": None}),
    "spectra": ("field", {**BOX, "view_angles": [0.2, 0.4], "fields": 2, "frequency_shifts": [0, 0.001], "method": "paths",
                          "samples": None}),
    "intensity_near": ("covariance", {**BOX, **NEAR}),
    "graded": ("solve", {**BOX, "near_sources": "sources.csv", "near_sensors": "sensors.csv",
                         "index_field": "linear", "index_slope": [0, 0.05]}),
    "layer": ("solve", {**BOX, "medium_index": 1.33, "outside_index": 1.1, "view_angles": 0.4}),
    "graded_paths": ("covariance", {**BOX, "view_angles": 0.4, "index_field": "linear", "index_slope": [0, 0.01], "method": "mc",
                                    "samples": 2000}),
    "layers": ("covariance", {"domain": "box", "width": 20, "layers": "layers.csv"}),
    "density": ("covariance", {"width": 20, "depth": 10, "density": 0.155, "density_blobs": "blobs.csv"}),
    "flow": ("covariance", {**SLAB, "delays": [0, 0.1, 0.2, 0.4, 0.6, 1], "velocity": [1, 0], "method": "mc",
                            "exposures": [0.9, 1]}),
    "full": ("covariance", {**BOX, **FAR, **FULL}),
    "image": ("image", IMAGE),
    "recover": ("recover", {"frames": "frames.csv", "points": 2, "samples": None, "threads": None}),
    "fit": ("fit", {**FIT, "samples": None}),
    "fit_paths": ("fit", {**FIT, "method": "mc", "samples": None}),
    "fit_plan": ("fit", {"plan": True, "choose": "tilts=1", "free": ["g=0:0.8"], "g": 0.5, "depth": 100, "optical_depth": 2,
                         "tilts": [0.002], "samples": None}),
    "fit_decay": ("fit", {"free": ["diffusion=0.001:5"], "depth": 50, "g": 0.6, "optical_depth": 5,
                          "measurement": "decay.csv", "samples": None}),
    "fit_distance": ("fit", {"free": ["mu_a=0.001:0.1", "diffusion=0.1:10"], "depth": 100, "g": 0.9, "mu_s": 10, "detector_radius": 0.5,
                             "measurement": "distances.csv", "samples": None}),
    "fit_plans": ("fit", {"plan": True, "free": ["g=0:0.8"], "vary": "g=0.3,0.5", "depth": 100, "optical_depth": 2,
                          "tilts": [0.002], "samples": None}),
    "image_reference": ("image", {**IMAGE, "reference_x": 5}),
    "image_subsets": ("image", {**IMAGE, "blinking": "subsets", "blinking_frames": 8}),
    "image_excited": ("image", {**IMAGE, "blinking": "speckle", "blinking_frames": 8}),
    "recover_sources": ("recover", {"frames": "frames.csv", "points": 2, "recovery": "sources", "samples": None,
                                    "threads": None}),
    "image_lucy": ("image", {**IMAGE, "reference_x": 5, "deconvolution": "richardson_lucy"}),
    "image_space": ("image", {**SPACE_IMAGE, "object_depth": -300, "object_x": [-6, 6]}),
    "image_moving": ("image", {**SPACE_IMAGE, "object_x": [-0.02, 0.02], "exposure": 1, "exposure_steps": 2}),
    "recover_patterns": ("recover", {"frames": "image_space.h5", "frame_dataset": "frames", "recovery": "sources",
                                     "points": 2, "longest": 10, "samples": None, "threads": None}),
    "recover_phases": ("recover", {"frames": "frames.csv", "points": 2, "recovery": "phases", "samples": None,
                                   "threads": None}),
    "recover_picture": ("recover", {"frames": "frame_picture.csv", "frame_axes": "picture", "longest": 10, "starts": 2,
                                    "phase_iterations": 8, "samples": None, "threads": None}),
    "recover_points": ("recover", {"frames": "frame_picture.csv", "frame_axes": "picture", "longest": 10, "recovery": "search",
                                   "points": 2, "samples": None, "threads": None}),
    "contrast_map": ("contrast", {"frames": "frame_picture.csv", "frame_axes": "picture", "exposure": 0.01, "samples": None,
                                  "threads": None}),
    "recover_reference": ("recover", {"frames": "frames.csv", "reference": "frames.csv", "points": 2,
                                      "samples": None, "threads": None}),
    "recover_lucy": ("recover", {"frames": "frames.csv", "reference": "frames.csv", "points": 2,
                                 "deconvolution": "richardson_lucy", "iterations": 5, "samples": None,
                                 "threads": None}),
    "image_near": ("image", {**IMAGE, "camera_depth": 200, "camera": [-50, 50]}),
    "full_near": ("covariance", {**BOX, **NEAR, **FULL}),
    "full_beams": ("covariance", {**BOX, "beam_waist": 2, "beam_positions": [0, 3], **FULL}),
    "pairs": ("covariance", {**BOX, **PAIRS}),
    "curve": ("covariance", {**BOX, **TILTS}),
    "map": ("covariance", {**BOX, **MAP, "view_angles": [0.1, 0.5]}),
    "map_near": ("covariance", {**BOX, **MAP, "near_sensors": "sensors.csv", "method": "wave"}),
    "moved": ("covariance", {**BOX, **MOVED}),
    "moved_both_sides": ("covariance", {**BOX, **MOVED, **SIDES}),
    "reflected_tilts": ("covariance", {**SLAB, **TILTS, "view_angles": 2.9}),
    "tilts_both_sides": ("covariance", {**BOX, **TILTS, **SIDES}),
    "map_both_sides": ("covariance", {**BOX, **MAP, **SIDES}),
    "gradient": ("covariance", {**HG, **FAR, "gradient": True}),
    "gradient_full": ("covariance", {**HG, **FAR, **FULL, "gradient": True}),
    "gradient_pairs": ("covariance", {**HG, **PAIRS, "gradient": True}),
    "gradient_curve": ("covariance", {**SLAB, **TILTS, "gradient": True}),
    "delays": ("covariance", {**SLAB, "delays": [0, 0.1, 1]}),
    "delays_seconds": ("covariance", {**SLAB, "delays": ["10us", "1ms"], "diffusion": "1e-12 m^2/s",
                                      "length_unit": "um", "view_angles": [0.1, 2.9]}),
    "delays_curve": ("covariance", {**SLAB, **SMALL_TILTS, "delays": [0, 0.1], "method": "transport",
                                    "samples": None}),
    "shifts": ("covariance", {**SLAB, "frequency_shifts": [0, 1e-3], "method": "transport",
                              "samples": None}),
    "shifts_curve": ("covariance", {**SLAB, **SMALL_TILTS, "frequency_shifts": [0, 1e-3],
                                    "method": "transport", "samples": None}),
    "shifts_hertz": ("covariance", {**SLAB, "medium_index": 1.5, "outside_index": 1.5, "length_unit": "um",
                                    "frequency_shifts": ["1GHz", "5GHz"], "linewidths": ["1GHz"],
                                    "method": "transport", "samples": None}),
    "shifts_exact": ("covariance", {**BOX, "frequency_shifts": [0, 1e-3], "method": "wave"}),
    "shifts_validated": ("validate", {**BOX, **FAR, "frequency_shifts": [0, 1e-3]}),
    "shifts_curve_validated": ("validate", {**BOX, **TILTS, "frequency_shifts": [0, 1e-3]}),
    "space": ("covariance", {**SLAB, "method": "transport", "dimension": 3, "tolerance": 1e-3,
                            "samples": None}),
    "short": ("covariance", {**BOX, "target_error": 1e-9}, 3),
    "validate": ("validate", {**BOX, **FAR}),
    "grains": ("field", {**BOX, "view_angles": [round(math.asin(0.005 * i), 9) for i in range(40)]}),
    "own_places": ("validate", {"scatterer": "soft", "radius": 0.2, "width": 20, "depth": 10, "placement": "three.csv", **FAR, "wave_samples": None}),
    "short_both": ("validate", {**BOX, "target_error": 1e-9}, 3),
    "transport": ("covariance", {**SLAB, **FAR, "method": "transport", "tolerance": 1e-3, "samples": None}),
    "solve": ("solve", {**CYLINDERS, **FAR, "map": [-5, 5, 0, 4]}),
    "solve_wavelengths": ("solve", {**CYLINDERS, **FAR, "wavelengths": [0.9, 1.1]}),
    "solve_wavelengths_near": ("solve", {"placement": "disks.csv", "near_sensors": "sensors.csv",
                                         "scatterer": "tm", "wavelengths": [0.9, 1.1]}),
    "solve_near": ("solve", {"placement": "disks.csv", "near_sensors": "sensors.csv",
                             "scatterer": "tm"}),
    "cell": ("solve", {"width": 9.3, "period": 9.3, "depth": 4, "count": 5, "scatterer": "soft", "radius": 0.2,
                       "map": [-3, 3, -1, 5], "map_lights": "lights.csv"}),
    "cell_fast": ("solve", {"width": 3.3, "period": 3.3, "depth": 4, "count": 5, "scatterer": "soft", "radius": 0.2,
                            "solver": "fast"}),
    "matrices_fast": ("matrix", {"width": 3.3, "depth": 4, "count": 5, "scatterer": "soft", "radius": 0.2, "shifts": 1, "samples": 3,
                                 "solver": "fast"}),
    "matrices": ("matrix", {"width": 9.3, "depth": 4, "count": 5, "scatterer": "soft", "radius": 0.2, "shifts": 3, "samples": 4,
                            "numerical_aperture": 0.5, "segments": [2, 6], "conjugated_fraction": [0.5, 1]}),
    "motif": ("solve", {"placement": "disks.csv", "scatterer": "tm", "t_matrix_gap": 3}),
    "solve_copies": ("solve", {"placement": "places.csv", "cluster": "motif.h5", **FAR}),
    "reflectance": ("reflectance", {"layers": "tissue.csv", "medium_index": 1.4, "distances": [5, 10], "ring_width": 1,
                                    "delays": [0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2], "exposures": [1e-2], "gradient": True,
                                    "length_unit": "mm", "tolerance": 0.05, "samples": None}),
    "reflectance_camera": ("reflectance", {"layers": "tissue.csv", "medium_index": 1.4, "wavelength": 850e-6, "distances": [5, 10],
                                           "detector_radius": 1, "delays": [0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2], "exposures": [5e-3],
                                           "diffusion": "1e-12 m^2/s", "length_unit": "mm", "source_power": 0.05,
                                           "quantum_efficiency": 0.5, "pixel_area": 1, "detector_count": 100, "read_noise": 2,
                                           "averaging_time": 2, "flow_layers": 1, "other_flow_error": 0.2, "tolerance": 0.05,
                                           "samples": None}),
    "reflectance_fibres": ("reflectance", {"depth": 100, "mean_free_path": 0.1, "g": 0.9, "albedo": 0.99, "medium_index": 1.4,
                                           "wavelength": 850e-6, "distances": [5], "detector_radius": 1, "length_unit": "mm",
                                           "delays": [0, 1e-6, 1e-5, 1e-4, 1e-3], "diffusion": "1e-12 m^2/s",
                                           "source_power": 0.05, "fibre_modes": 2, "tolerance": 0.05, "samples": None}),
    "flux": ("flux", {**BOX, "angle_bins": 600}),
    "flux_faces": ("flux", {**SLAB, "medium_index": 1.33, "tolerance": 1e-3, "samples": None}),
    "field": ("field", {"width": 20, "depth": 10, "mean_free_path": 10, "view_angles": SINES,
                        "tilts": [0, 0.1], "method": "paths"}),
    "field_near": ("field", {**BOX, "near_sensors": "line.csv", "method": "covariance"}),
    "place": ("place", {**DISKS, "placement": "equilibrium"}),
    "sweep": ("sweep", GRID),
    "sweep_checked": ("sweep", {**GRID, "albedo": 0.9, "g": 0.5, "method": "transport", "tolerance": 1e-2, "samples": None,
                                "dimension": 3, "light_angles": 0.2, "tilt_azimuth": 1}),
    "sweep_partial": ("merge", GRID, 3),
    "sweep_disks": ("sweep", {**BOX, "count": None, "domain": "box", "scatterer": "tm",
                              "density": [0.05, 0.1], "radius": [0.1, 0.2], "tilts": [0, 0.001],
                              "index": ["1.5+0.01i", "1.4"]}),
    "sweep_list": ("sweep", {"width": 20, "depth": 10, "domain": "box", "scatterer": "tm",
                             "points": "disk_points.csv", "tilts": [0, 0.001],
                             "target_error": 0.9}),
    "sweep_both": ("sweep", {**BOX, "albedo": [1, 0.8], "tilts": [0, 0.001], "domain": "box",
                             "scatterer": "point", "method": "both"}),
    "sweep_of": ("sweep", {**STAGE, "of": "render", "vary": ["method=light,path", "mu_a=0,0.1"],
                           "sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [1, 1]}),
    "sweep_of_images": ("sweep", {**IMAGE, "prediction_paths": None, "of": "image", "points_table": "predictions.csv"}),
    "optimise": ("optimise", {**STAGE, "of": "render", "vary": ["mu_a=0:0.1"], "maximise": "total", "scattered": 2, "method": "light",
                              "against": "mu_a=0.2", "pixels": [1, 1], "key_tolerance": 0.5, "target_error": 0.5, "sensor": "area",
                              "sensor_at": [0, 0, 4], "sensor_size": [1, 1]}),
    "ball": ("trace", {**RAYS, "field": "luneburg", "origin": [0, 0, -2], "beam_radius": 0.5}),
    "singlet": ("trace", {**RAYS, "lens": [0, 0, 0, 1, 5, 0, 0.5, 1.5, 0, 0, 0], "origin": [0, 0, -1], "beam_radius": 0.5,
                          "stop_plane": [0, 0, 2, 0, 0, 1], "image_plane": [0, 0, 9, 0, 0, 1], "refocus": True}),
    "aspheric_image": ("trace", {"asphere": [0, 0, 0, 1, 5, -1, 0, 0, 0.5, 1.5, 0, 0, 0], "light": "disk", "ray_count": 120,
                                 "origin": [0, 0, -1], "beam_radius": 0.5, "stop_plane": [0, 0, 1, 0, 0, 1], "max_length": 9,
                                 "image_plane": [0, 0, 10, 0, 0, 1], "refocus": True, "wavelength": 0.01}),
    "guide": ("trace", {**RAYS, "field": "sech", "alpha": 1, "light": "fan", "across": [0, 1, 0]}),
    "ramp": ("trace", {**RAYS, "field": "linear", "slope": [0, 0, 0.1],
                       "stop_plane": [0, 0, 2, 0, 0, 1]}),
    "curves": ("trace", {"connect": [0, 0, 0, 0.3, 0, 3], "max_length": 5, "trials": 100,
                         "path_points": 5, "field": "parabolic", "alpha": 0.5, "index": 1.5}),
    "camera": ("render", {**STAGE, "sensor_at": [0.2, 0, 3.9], "sensor_direction": [0, 0, -1],
                          "field_of_view": 1}),
    "lens_camera": ("render", {**STAGE, "sensor_at": [0.2, 0, 4], "sensor_direction": [0, 0, -1], "lens_radius": 0.5,
                               "focus_distance": 2, "field_of_view": 1, **GRADIENT}),
    "area": ("render", {**STAGE, "sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [1, 1],
                        "length_unit": 0.001, "mu_a": 0.1, "map_box": [-1, -1, 0, 1, 1, 4], "map_cells": [2, 3, 4],
                        **GRADIENT}),
    "directional": ("render", {**STAGE, "sensor": "directional",
                               "mu_a": 0.1, "map_cylinder": [0, 0, 0, 0, 0, 4, 1], "map_cells": [3, 4],
                               **GRADIENT}),
    "sensors": ("render", {**STAGE, "sensor": ["area", "directional"], "sensor_at": [0, 0, 4],
                           "sensor_size": [1, 1], "sensor_name": ["through", "far"]}),
    "disks": ("render", {**STAGE, "pixels": None, "sensor": "radial", "sensor_at": [0, 0, 4], "radii": [0.5, 1],
                         **GRADIENT}),
    "radial": ("render", {**STAGE, "pixels": None, "sensor": "radial", "sensor_at": [0, 0, 4],
                          "sensor_radius": 1, "rings": 4, **GRADIENT}),
    "polar": ("render", {**STAGE, "pixels": None, "sensor": "polar", "rings": 4, **GRADIENT}),
    **{f"tagged_{sensor}": ("render", {**TAGGED, "sensor": sensor, **keys}) for sensor, keys in (
        ("area", {"sensor_at": [0, 0, 4], "sensor_size": [1, 1]}), ("directional", {}), ("polar", {"pixels": None, "rings": 4}),
        ("radial", {"pixels": None, "sensor_at": [0, 0, 4], "sensor_radius": 1, "rings": 2}),
        ("camera", {"sensor_at": [0.2, 0, 4], "sensor_direction": [0, 0, -1], "lens_radius": 0.5, "focus_distance": 2,
                    "field_of_view": 1}))},
    "labels": ("render", {**STAGE, "field": None, "alpha": None, "mu_s": None, "sensor": "directional", "labels": "shapes.json",
                          "label_media": [0, 0.1, 0, 1, 0, 0.5], "map_box": [-1, -1, 0, 1, 1, 4], "map_cells": [2, 3, 4]}),
    "ball_power": ("render", {**STAGE, "field": None, "alpha": None, "index": None, "sensor": "directional",
                              "body_sphere": [0, 0, 2, 0.5], "index_around": 1.3, "max_scatterings": 9}),
    "mesh": ("render", {**STAGE, "field": None, "alpha": None, "index": None, "sensor": "directional",
                        "body_mesh": "wedge.stl", "body_mesh_spacing": 0.2, "method": "light", "pixels": [3, 2], "samples": 200}),
    "aperture": ("design", {"nodes": [3], "goal": "throughput", "sources": [0, 0, -1], "aperture_radius": 0.3,
                            "rays_per_source": 10}),
    "lens": ("design", {"nodes": [2], "directions": 4, "rays_per_direction": 5}),
    "lens_radial": ("design", {"design": "radial", "directions": 1, "rays_per_direction": 9}),
    "lens_graded": ("design", {"design": "guide", "goal": "equal_path", "delta": 0.01, "ray_count": 9}),
    "display": ("design", {"design": "box", "nodes": [7], "goal": "irradiance", "pictures": "picture.csv", "rays_across": 4,
                           "iterations": 1}),
    **{f"bench_{kind}": (f"bench {kind}", {"quick": True, "every": 100})
       for kind in ("error", "stability", "plan")},
}


def cost(subcommand, keys):
    """Returns keys that limit a run: thousands of light paths or dozens of placements."""
    if subcommand.split()[0] in ("solve", "place", "trace", "design", "bench"):
        return {"threads": None if subcommand == "place" else 2}
    if subcommand == "field":
        return {"fields": 4, "threads": 2}
    both = subcommand == "validate" or keys.get("method") == "both"
    if keys.get("method") == "transport":
        return {"threads": 2}
    return {"samples": 4 if keys.get("method") == "wave" else 2000,
            "wave_samples": 4 if both else None, "threads": 2}


def make_file(test, name, subcommand, keys, status=0):
    keys = {**cost(subcommand, keys), **keys, "out": f"{name}.h5"}
    if subcommand == "place":
        test.call("place", **{**keys, "structure": f"{name}.h5", "out": f"{name}.csv"})
    elif subcommand == "merge":
        test.call("sweep", **keys, shard="1/2")
        test.call("merge", "--partial", out=keys["out"], status=status)
    else:
        test.call(*subcommand.split(), **keys, status=status)


class ResultsTest(ProgramTest):
    """Base of tests that read the same files, which are made once."""

    @classmethod
    def setUpClass(cls):
        maker = ProgramTest("call")
        maker.setUp()
        cls.addClassCleanup(maker.doCleanups)
        cls.results = maker.folder
        for name, text in FILES.items():
            maker.write(name, text)
        for name, run in RUNS.items():
            make_file(maker, name, *run)
        cls.files = {name: h5py.File(cls.results / f"{name}.h5") for name in RUNS}
        for file in cls.files.values():
            cls.addClassCleanup(file.close)

    def setUp(self):
        self.folder = self.results

    def on_each_file(self, check):
        """Calls check(open h5py file) for each file."""
        for name, file in self.files.items():
            with self.subTest(file=name):
                check(file)
