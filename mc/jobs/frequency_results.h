#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/jobs/crossings.h"
#include "mc/jobs/source_contrast.h"

namespace flatspeckle::mc {

extern const DatasetTable frequency_table;

/// Frequency shifts of the second field, relative to the frequency of the first one.
struct FrequencyShifts {
  std::vector<double> relative{};
  std::optional<double> optical{};  ///< optical frequency in Hz, if it is known

  /// Returns a relative shift in Hz, or unchanged if the optical frequency is not known.
  double shown(double shift) const { return shift * optical.value_or(1); }
};

/// Writes the axis of the shifts, also in Hz if the optical frequency is known.
void write_shift_axis(ResultFile& file, const FrequencyShifts& shifts);
/// Writes the covariances and correlations for each frequency shift into a group of the file
/// (empty: the root) and, for an intensity request with light transmitted through a homogeneous
/// slab, the correlations of diffusion theory. The axes of the request and of the shifts must have
/// been written before.
void write_frequency_shifts(ResultFile& file, const std::string& group, const Scene& scene,
                            const std::vector<double>& shifts, const ChangeEstimates& found);

/// Writes the shifts at which C_I is 1/2, the half widths.
void write_half_widths(ResultFile& file, const FrequencyShifts& shifts, const Crossings& widths);

/// Writes the squared contrasts of sources that are not monochromatic, and their linewidths.
void write_source_contrast(ResultFile& file, const FrequencyShifts& shifts,
                           const std::vector<SourceLine>& lines, const Estimate& squares);

}  // namespace flatspeckle::mc
