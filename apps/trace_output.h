#pragma once

#include <vector>

#include "apps/ray_connections.h"
#include "apps/ray_starts.h"
#include "apps/ray_tracing.h"
#include "apps/scene_field.h"
#include "core/result/result_file.h"

namespace flatspeckle::apps {

/// Of any rays: optical paths, ends, invariants. length_unit: metres.
void write_rays(ResultFile& file, const SceneField& scene, const std::vector<RayStart>& starts,
                const std::vector<TracedRay>& rays, double length_unit);

/// Curves between two points, in the order of their optical paths, and how the trials went.
void write_connections(ResultFile& file, const FoundConnections& found, double length_unit);

/// Stored points of rays or curves, and the index over the rectangle in z and the transverse axis
/// that they span most, so that they can be drawn. The rays or curves must have been written.
void write_paths(ResultFile& file, const SceneField& scene, const std::vector<TracedRay>& rays);

}  // namespace flatspeckle::apps
