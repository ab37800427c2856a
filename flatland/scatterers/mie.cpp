#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

void read_mie(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  require_radius(values);
  read_radius_and_index(keys, values, made);
}

}  // namespace

const ScattererKind mie_kind{"mie", Scatterer::Kind::mie, read_mie, nullptr};

}  // namespace flatspeckle
