#include "apps/sweep/axis_values.h"

#include "core/keys/number_text.h"

namespace flatspeckle::apps {

std::size_t AxisValues::size() const {
  return range() != nullptr ? range()->count : std::get<0>(values_).size();
}

std::string AxisValues::operator[](std::size_t number) const {
  return range() != nullptr ? number_text(range()->at(number)) : std::get<0>(values_)[number];
}

std::vector<std::string> AxisValues::texts() const {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < size(); ++i) texts.push_back((*this)[i]);
  return texts;
}

}  // namespace flatspeckle::apps
