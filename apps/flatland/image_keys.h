#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/results/estimation.h"
#include "core/keys/keys.h"
#include "flatland/scene/scene.h"
#include "mc/imaging/camera_exposure.h"
#include "mc/imaging/recovery/phase_retrieval.h"
#include "mc/imaging/recovery/recovery.h"
#include "mc/jobs/dynamics.h"

namespace flatspeckle::apps {

/// Values of the keys of `image` that apply only in space.
struct PictureKeys {
  std::vector<double> object_y;
  std::string object_picture;
  std::optional<double> object_width, object_disc, object_spacing;
  mc::Detector detector;
  mc::DynamicsValues moving;  ///< whose only delay is the exposure
  std::int64_t exposure_steps = 8;
  std::optional<double> length_unit;
  mc::PhaseTask phases;
  double least_similarity = 0.6;
  std::int64_t prediction_draws = 16;
};

/// Values of the keys of the subcommand `image`.
struct ImageKeys {
  SceneSpec spec;
  std::vector<double> object_x, object_brightness, object_depth;
  std::optional<double> object_extent, camera_depth, reference_x, memory_range;
  double object_scale = 1;
  std::optional<std::int64_t> object_count;
  std::vector<double> camera;
  std::int64_t pixels = 4096, repeats = 16, average = 1;
  std::optional<std::int64_t> points, paths_per_field;
  double resolution = 1;
  mc::CameraNoise noise;
  mc::DeconvolutionKeys deconvolution;
  std::string method = "paths";
  std::optional<std::int64_t> prediction_paths;
  std::string blinking = "none";
  std::int64_t blinking_frames = 50, excitation_paths = 20000;
  double lit = 0.5;
  std::optional<double> excitation_wavelength, excitation_optical_depth;
  std::optional<std::int64_t> sources;
  MethodSettings estimation;
  PictureKeys space;
};

void add_image_keys(Keys& keys, ImageKeys& values);

/// Returns the number of light paths for predictions.
std::uint64_t prediction_paths(const Keys& keys, const ImageKeys& values);

/// Returns the brightness of each of `points` points.
std::vector<double> brightness_of(const Keys& keys, const ImageKeys& values, std::size_t points);
/// Returns the number of points that the key object_count selects from `points`.
std::size_t count_of(const Keys& keys, const ImageKeys& values, std::size_t points);

}  // namespace flatspeckle::apps
