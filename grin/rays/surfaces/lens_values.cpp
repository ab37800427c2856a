#include "grin/rays/surfaces/lens_values.h"

#include "core/keys/number_text.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

Lens lens_of(const std::string& key, std::span<const double> numbers) {
  const double radius = positive(key + ", radius", numbers[3]);
  const double thickness = positive(key + ", thickness", numbers[6]);
  if (const auto lens = Lens::make(vector_of(numbers), radius, numbers[4], numbers[5], thickness))
    return *lens;
  throw InputError(key, number_text({numbers.begin(), numbers.begin() + lens_numbers}),
                   "radii of curvature must not be below the radius, and faces not meet within it");
}

std::vector<Lens> lenses_of(const Keys& keys, const std::vector<double>& member) {
  std::vector<Lens> lenses;
  for (const auto numbers : parts_of(keys.read(member), lens_numbers))
    lenses.push_back(lens_of(keys.name(member), numbers));
  return lenses;
}

}  // namespace flatspeckle::grin
