#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "mc/imaging/recovery.h"

namespace flatspeckle {
class ResultFile;
}

namespace flatspeckle::mc {

extern const DatasetTable recovery_table;

void write_recovery(ResultFile& file, const std::vector<std::string>& names,
                    const RecoveryTask& task, const std::vector<Recovered>& all);

}  // namespace flatspeckle::mc
