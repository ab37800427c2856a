#include "grin/space/ray_field_of.h"

namespace flatspeckle::grin {

template std::unique_ptr<const RayField> ray_field_in_file<3>(const AnyIndexField& field);

}  // namespace flatspeckle::grin
