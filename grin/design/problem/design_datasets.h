#pragma once

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "grin/design/problem/designer.h"

namespace flatspeckle::grin::design {

extern const DatasetTable design_table;

/// The field, so that trace and render can read it, how it was found, what it does, and what is
/// drawn of it.
void write_design(ResultFile& file, const DesignScene& scene, const Designer& designer,
                  const DesignState& state, const DesignCheck& check);

}  // namespace flatspeckle::grin::design
