#pragma once

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "grin/design/problem/designer.h"

namespace flatspeckle::grin::design {

extern const DatasetTable design_table;

/// How well held-out rays form the pictures, one value for each picture.
struct PictureQuality {
  std::vector<double> psnr_db;    ///< peak signal-to-noise ratio
  std::vector<double> on_screen;  ///< share of the beam's light that falls on the screen
};
PictureQuality picture_quality(const ScreenTarget& design_target,
                               const std::vector<double>& measurements);

/// Writes the designed field in the form that `trace` and `render` read. Also writes the history of
/// the search, the checks and the data of the plots.
void write_design(ResultFile& file, const DesignScene& scene, const Designer& designer,
                  const DesignState& state, const DesignCheck& check);

}  // namespace flatspeckle::grin::design
