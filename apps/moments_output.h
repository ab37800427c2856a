#pragma once

#include <string>

#include "core/result/result_file.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::apps {

/// Root attributes: wavelength and extent of the medium.
void write_domain(ResultFile& file, const Scene& scene);
/// Those and the bulk properties.
void write_medium(ResultFile& file, const Scene& scene);

/// The axis of views that are all far (view_angle) or all near (sensor, with its coordinates).
void write_view_axis(ResultFile& file, const std::vector<View>& views);

/// The names of the axes of lights and views.
std::string light_axis(const CovarianceRequest& request);
std::string view_axis(const CovarianceRequest& request);
/// Of a full covariance: light, view, and once more with _2 after their names.
std::vector<Axis> matrix_axes(const CovarianceRequest& request);
/// Of a covariance: in the square of the field's units. Far fields are lengths^(1/2), and a slab's
/// covariance counts per unit length.
std::string covariance_units(const Scene& scene);

/// Entries [first, first + count).
Estimate part(const Estimate& all, std::size_t first, std::size_t count);
/// The lower triangle of a full request's entries as the whole matrix.
Estimate unpack_full(const CovarianceRequest& request, const Estimate& triangle);

/// The axes that a request's datasets stand on.
void write_axes(ResultFile& file, const CovarianceRequest& request);

/// Steps between 0 and a range.
std::size_t steps_below(const std::vector<double>& steps, const mc::Range& range);
/// Whether a range rests on so few steps below it that its error bar, which does not know what the
/// curve does between them, says too little; and the note that says so on standard error.
bool few_steps(const std::vector<double>& steps, const mc::Range& range);
void note_few_steps();
/// "1.36 +- 0.01", or which tilts are missing.
std::string range_text(const mc::Range& range, double error);

/// Mean field and covariance in the shapes of docs/format.md, each with its standard error; `group`
/// is empty for the root. Axes must have been written; moments are those of job and sums.
void write_moments(ResultFile& file, const std::string& group, const FieldJob& job,
                   const Scene& scene, const GroupedSums& sums, const FieldMoments& moments);

}  // namespace flatspeckle::apps
