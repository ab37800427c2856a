#pragma once

#include "core/result/dataset_row.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

// Datasets and attributes of the scene in result files. Dataset tables name axes and units by
// placeholders. Writing the axes binds LIGHT and VIEW to the axes of lights and views and, for a
// full covariance, LIGHT_2 and VIEW_2 to those of the second field.

extern const DatasetTable scene_table, axes_table, beams_table;

/// Writes the wavelength and the extent of the medium as root attributes.
void write_domain(ResultFile& file, const Scene& scene);
/// Writes the domain and the bulk properties.
void write_medium(ResultFile& file, const Scene& scene);

/// Binds the placeholders FIELD and COVARIANCE to the units of fields and covariances. Far fields
/// of a box have the unit length^(1/2), in space length. The covariance of a slab is divided by the
/// illuminated length or area, so that it has no unit.
void bind_units(ResultFile& file, const Scene& scene);
/// Writes the axis of lights: light_angle for plane waves, otherwise the number `light` with the
/// coordinates of each light.
void write_light_axis(ResultFile& file, const Lights& lights);
/// Writes the axis of views that are all far (view_angle) or all near (sensor, with its
/// coordinates), or the two axes of a camera.
void write_view_axis(ResultFile& file, const std::vector<View>& views,
                     const std::optional<FarCamera>& camera = {});
/// Writes the axes for the datasets of the scene's request, and binds their units.
void write_axes(ResultFile& file, const Scene& scene);

}  // namespace flatspeckle
