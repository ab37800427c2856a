#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

void read_hg(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  made.g = keys.read(values.g).value_or(0);
  read_bulk_albedo(keys, values, made);
}

}  // namespace

const ScattererKind hg_kind{"hg", Scatterer::Kind::hg, read_hg, nullptr};

}  // namespace flatspeckle
