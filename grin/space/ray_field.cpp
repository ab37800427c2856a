#include "grin/space/ray_field_of.h"

namespace flatspeckle::grin {

extern template std::unique_ptr<const RayField> ray_field_in_file<0>(const AnyIndexField& field);
extern template std::unique_ptr<const RayField> ray_field_in_file<1>(const AnyIndexField& field);
extern template std::unique_ptr<const RayField> ray_field_in_file<2>(const AnyIndexField& field);
extern template std::unique_ptr<const RayField> ray_field_in_file<3>(const AnyIndexField& field);

std::unique_ptr<const RayField> make_ray_field(const AnyIndexField& field) {
  constexpr decltype(&make_ray_field) in_file[ray_field_files] = {
      ray_field_in_file<0>, ray_field_in_file<1>, ray_field_in_file<2>, ray_field_in_file<3>};
  return in_file[field.index() % ray_field_files](field);
}

}  // namespace flatspeckle::grin
