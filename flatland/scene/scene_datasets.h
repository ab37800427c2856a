#pragma once

#include "core/result/dataset_row.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

// What results hold of their scene. Axes bind the roles LIGHT and VIEW, of lights and views, in a
// full covariance LIGHT_2 and VIEW_2 too.

extern const DatasetTable scene_table, axes_table, beams_table;

/// Root attributes: wavelength and extent of the medium.
void write_domain(ResultFile& file, const Scene& scene);
/// Those and the bulk properties.
void write_medium(ResultFile& file, const Scene& scene);

/// Says in what unit fields (FIELD) and their squares (COVARIANCE) are. Far fields are
/// lengths^(1/2), and a slab's covariance counts per unit length.
void bind_units(ResultFile& file, const Scene& scene);
/// The axis of lights: light_angle of plane waves, else light with its coordinates.
void write_light_axis(ResultFile& file, const Lights& lights);
/// The axis of views that are all far (view_angle) or all near (sensor, with its coordinates).
void write_view_axis(ResultFile& file, const std::vector<View>& views);
/// The axes that the datasets of the scene's request stand on, and their units.
void write_axes(ResultFile& file, const Scene& scene);

}  // namespace flatspeckle
