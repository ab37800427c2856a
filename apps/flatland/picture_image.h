#pragma once

#include "apps/flatland/image_keys.h"
#include "core/result/result_file.h"
#include "core/session/session.h"
#include "mc/imaging/simulated/picture_frames.h"

namespace flatspeckle::apps {

/// `image` in space: scene and settings of a run.
struct PictureRun {
  mc::PictureScene scene;
  mc::PictureTask task;
  std::string method;
  std::optional<std::int64_t> paths_per_field;
  double wave_tolerance = 0;
};

/// Reads the keys. Throws InputError.
PictureRun picture_run(const Keys& keys, const ImageKeys& values, std::uint64_t seed, int threads);
Made make_pictures(ResultFile& file, const PictureRun& run, bool prints);

/// Draws the exact fields of `media` placements minus their mean (the coherent field), so that only
/// the speckle is left, as in fields computed by light paths.
mc::FieldDraw exact_fields(const Scene& scene, std::uint64_t media, std::uint64_t seed, int threads,
                           double tolerance);

}  // namespace flatspeckle::apps
