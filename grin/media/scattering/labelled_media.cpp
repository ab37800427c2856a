#include "grin/media/scattering/labelled_media.h"

#include <algorithm>

#include "core/error.h"

namespace flatspeckle::grin {

namespace {

constexpr std::size_t numbers_each = 3;

/// Returns the media of the labels. Light that scatters with g = 1 goes on unchanged, so that it is
/// not scattered.
std::vector<ScatteringMedium> media_of(const std::vector<double>& numbers,
                                       const std::string& name) {
  std::vector<ScatteringMedium> media;
  for (std::size_t at = 0; at + numbers_each <= numbers.size(); at += numbers_each) {
    const double mu_s = numbers[at], mu_a = numbers[at + 1], g = numbers[at + 2];
    for (const double coefficient : {mu_s, mu_a})
      if (!(coefficient >= 0 && coefficient < 1e100))
        throw InputError(name, coefficient, "mu_s and mu_a must be at least 0");
    if (!(g > -1 && g <= 1)) throw InputError(name, g, "g must be above -1 and at most 1");
    ScatteringMedium& medium = media.emplace_back(ScatteringMedium{g < 1 ? mu_s : 0, mu_a});
    if (g != 0 && g < 1) medium.phase.which = HgPhase{g};
  }
  return media;
}

}  // namespace

double LabelledMedia::largest_extinction() const {
  double largest = 0;
  for (const ScatteringMedium& medium : media_) largest = std::max(largest, medium.mu_t());
  return largest;
}

ScatteringMedium LabelledMedia::mean() const {
  ScatteringMedium mean;
  double forward = 0;
  std::vector<double> counts(media_.size());
  for (const auto label : volume_.labels) ++counts[label];
  for (std::size_t label = 0; label < media_.size(); ++label) {
    const ScatteringMedium& medium = media_[label];
    const double share = counts[label] / static_cast<double>(volume_.labels.size());
    mean.mu_s += share * medium.mu_s;
    mean.mu_a += share * medium.mu_a;
    forward += share * medium.mu_s * medium.phase.mean_cosine();
  }
  if (forward != 0) mean.phase.which = HgPhase{forward / mean.mu_s};
  return mean;
}

const ScatteringMedium& ScatteringMedium::in_voxel(const Vec3& x) const {
  return labels->at(x);
}

double ScatteringMedium::largest_relative() const {
  if (density) return density->largest();
  return labels ? labels->largest_extinction() / mu_t() : 1;
}

ScatteringMedium labelled_medium(LabelVolume volume, const std::vector<double>& media,
                                 const std::string& name) {
  const auto highest = std::max_element(volume.labels.begin(), volume.labels.end());
  const std::size_t needed = numbers_each * (*highest + std::size_t{1});
  if (media.size() < needed)
    throw InputError(name, media.size(),
                     "must have mu_s mu_a g of each label from 0 to " + std::to_string(*highest) +
                         ": " + std::to_string(needed) + " numbers");
  auto labels = std::make_shared<const LabelledMedia>(std::move(volume), media_of(media, name));
  ScatteringMedium medium = labels->mean();
  if (!(medium.mu_t() > 0))
    throw InputError(name + ": the medium of some voxel must scatter or absorb");
  medium.labels = std::move(labels);
  return medium;
}

}  // namespace flatspeckle::grin
