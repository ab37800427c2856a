#pragma once

#include <vector>

#include "core/result/result_file.h"
#include "grin/trace/trace_scene.h"

namespace flatspeckle::grin {

extern const DatasetTable rays_table;

/// Ends of the rays that came to a stop surface; of all where none did.
std::vector<RayState> ends_to_tell(const std::vector<TracedRay>& rays);
/// Root mean square distance from their mean.
double spot_radius(const std::vector<RayState>& ends);

/// Of any rays: optical paths, ends, invariants.
void write_rays(ResultFile& file, const TraceScene& scene, const std::vector<TracedRay>& rays);

void write_image(ResultFile& file, const RayImage& image);

/// Curves between two points, in the order of their optical paths, and how the trials went.
void write_connections(ResultFile& file, const TraceScene& scene, const FoundConnections& found);

/// Stored points of rays or curves, and the index over the rectangle in z and the transverse axis
/// that they span most, so that they can be drawn. The rays or curves must have been written.
void write_paths(ResultFile& file, const TraceScene& scene, const std::vector<TracedRay>& rays);

}  // namespace flatspeckle::grin
