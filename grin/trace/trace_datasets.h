#pragma once

#include <vector>

#include "core/result/result_file.h"
#include "grin/trace/image_quality.h"
#include "grin/trace/paraxial.h"
#include "grin/trace/trace_scene.h"

namespace flatspeckle::grin {

extern const DatasetTable rays_table;

/// Returns the ends of the rays that reached a stop surface; if none did, of all rays.
std::vector<RayState> ends_to_print(const std::vector<TracedRay>& rays);
/// Returns the root mean square distance of the ends from their mean.
double spot_radius(const std::vector<RayState>& ends);

/// Writes the starts, ends, optical paths and invariants of rays.
void write_rays(ResultFile& file, const TraceScene& scene, const std::vector<TracedRay>& rays);

void write_image(ResultFile& file, const RayImage& image);
void write_system(ResultFile& file, const ParaxialSystem& system);
void write_quality(ResultFile& file, const ImageQuality& quality);

/// Writes the curves between two points, sorted by optical path, and the outcomes of the trials.
void write_connections(ResultFile& file, const TraceScene& scene, const FoundConnections& found);

/// Writes the stored points of rays or curves for plots, and an index map in the plane of z and the
/// transverse axis along which the points extend furthest. Call write_rays() or write_connections()
/// first.
void write_paths(ResultFile& file, const TraceScene& scene, const std::vector<TracedRay>& rays);

}  // namespace flatspeckle::grin
