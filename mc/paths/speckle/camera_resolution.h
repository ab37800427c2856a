#pragma once

#include <cstdint>

#include "flatland/scene/scene.h"
#include "mc/paths/speckle/camera_sides.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Returns the scene with a camera of few pixels, which has the same axis and aperture. Its walks
/// serve all its pixels.
Scene on_coarse_camera(Scene scene);

/// Chooses the cheapest resolution whose error is at most `tolerance`, measured at a few
/// thousand ends of paths. Returns the finest resolution if none is accurate enough. The scene must
/// have a camera and a homogeneous medium that scatters. margin: that of the resolution.
CameraResolution camera_resolution(const Scene& scene, const Plan& plan, std::uint64_t seed,
                                   double tolerance, Vec margin = {});

}  // namespace flatspeckle::mc
