#include "reference.h"

namespace flatspeckle::wave {

std::string reference_path(const std::string& name) {
  return FLATSPECKLE_DATA "/reference/" + name;
}

Scatterer reference_scatterer(const std::string& kind) {
  Scatterer scatterer;
  scatterer.radius = 1;
  scatterer.kind = kind == "D"                ? Scatterer::Kind::soft
                   : kind == "N"              ? Scatterer::Kind::hard
                   : kind.starts_with("TM15") ? Scatterer::Kind::tm
                                              : Scatterer::Kind::te;
  scatterer.index = kind.ends_with("abs") ? Complex(1.5, 0.1) : Complex(1.5);
  return scatterer;
}

Placement reference_placement(const std::string& folder, const std::string& kind) {
  return read_placement(reference_path(folder + "/placement.csv"), reference_scatterer(kind));
}

}  // namespace flatspeckle::wave
