#include "apps/optimise/objective.h"

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

bool is_plain(const CollectedDataset& set) {
  return !set.is_scale && !set.name.ends_with("_error") && !set.name.ends_with("_rare") &&
         std::holds_alternative<std::vector<double>>(set.values);
}

/// Of what could be asked for: those of one number first.
std::string names_in(const CollectedResult& result) {
  constexpr std::size_t most = 12;
  std::vector<std::string> names;
  for (const bool is_single : {true, false})
    for (const CollectedDataset& set : result.datasets)
      if (is_plain(set) && (set.count() == 1) == is_single)
        names.push_back(set.name + (is_single ? "" : "[i]"));
  if (names.size() > most) names.resize(most);
  return joined(names, " ");
}

std::size_t extent(const CollectedResult& result, const Axis& axis) {
  if (const auto* count = std::get_if<std::size_t>(&axis)) return *count;
  return result.find(std::get<std::string>(axis))->count();
}

}  // namespace

Objective::Objective(std::string key, const std::string& text)
    : key_(std::move(key)), text_(text), path_(text.substr(0, text.find('['))) {
  if (path_ == text) return;
  std::string inside = text.substr(path_.size() + 1);
  const bool is_closed = inside.ends_with(']');
  if (is_closed) inside.pop_back();
  std::istringstream numbers(inside);
  for (std::string number; std::getline(numbers, number, ',');) {
    const auto whole = read_whole_number(std::string(trimmed(number)));
    if (!whole || *whole < 0) break;
    index_.push_back(static_cast<std::size_t>(*whole));
  }
  const auto commas = static_cast<std::size_t>(std::ranges::count(inside, ','));
  if (!is_closed || index_.size() != commas + 1)
    throw InputError(key_, text, "must be a dataset of the result, as total or image[3,4]");
}

const CollectedDataset& Objective::dataset(const CollectedResult& result) const {
  const CollectedDataset* const set = result.find(path_);
  if (set == nullptr || !is_plain(*set))
    throw InputError(key_, text_, "must be a real number of the result, as " + names_in(result));
  return *set;
}

std::size_t Objective::place_in(const CollectedResult& result, const CollectedDataset& set) const {
  if (index_.empty() && set.count() == 1) return 0;
  std::size_t place = 0;
  std::vector<std::string> extents;
  bool fits = index_.size() == set.axes.size();
  for (std::size_t i = 0; i < set.axes.size(); ++i) {
    const std::size_t count = extent(result, set.axes[i]);
    extents.push_back(std::to_string(count));
    fits = fits && index_[i] < count;
    if (fits) place = place * count + index_[i];
  }
  if (!fits)
    throw InputError(key_, text_,
                     path_ + " has " + joined(extents, " x ") +
                         " numbers: name one by its place, " + path_ + "[0" +
                         (extents.size() > 1 ? ",0]" : "]"));
  return place;
}

double Objective::of(const CollectedResult& result) const {
  const CollectedDataset& set = dataset(result);
  return std::get<std::vector<double>>(set.values)[place_in(result, set)];
}

}  // namespace flatspeckle::apps
