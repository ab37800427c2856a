#include "flatland/media/index_field.h"

namespace flatspeckle {

std::string IndexField::describe() const {
  switch (kind) {
    case Kind::linear:
      return "n^2 linear";
    case Kind::parabolic:
      return "parabolic guide";
    case Kind::blobs:
      return std::to_string(blobs.size()) + " blobs of the index";
    case Kind::ultrasound:
      return "standing sound";
    case Kind::grid:
      return "index of a grid";
    case Kind::mean_field:
      return "refraction by the scatterers";
    case Kind::homogeneous:
      break;
  }
  return "homogeneous";
}

}  // namespace flatspeckle
