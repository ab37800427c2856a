#pragma once

#include <vector>

#include "core/result/result_file.h"
#include "grin/scene/trace_scene.h"

namespace flatspeckle::apps {

/// Of any rays: optical paths, ends, invariants. length_unit: metres.
void write_rays(ResultFile& file, const grin::SceneField& scene,
                const std::vector<grin::RayStart>& starts, const std::vector<grin::TracedRay>& rays,
                double length_unit);

/// Curves between two points, in the order of their optical paths, and how the trials went.
void write_connections(ResultFile& file, const grin::FoundConnections& found, double length_unit);

/// Stored points of rays or curves, and the index over the rectangle in z and the transverse axis
/// that they span most, so that they can be drawn. axis: "ray" or "curve".
void write_paths(ResultFile& file, const grin::SceneField& scene, const std::string& axis,
                 const std::vector<grin::TracedRay>& rays);

}  // namespace flatspeckle::apps
