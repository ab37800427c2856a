#include "grin/render/curved/ray_field_in.h"

namespace flatspeckle::grin {

template std::unique_ptr<const RayField> ray_field_in<0>(const AnyIndexField&,
                                                         std::span<const Surface>, bool);

}  // namespace flatspeckle::grin
