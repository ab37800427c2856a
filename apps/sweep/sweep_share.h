#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace flatspeckle::apps {

/// Part `number` of `count` parts of a sweep that run apart.
struct SweepShare {
  std::size_t number = 0, count = 1;
};

/// Of i/n. Throws InputError.
SweepShare share_of(const std::string& text);

/// The share's runs of so many, scattered over all, so that what has been done at any time says
/// something about what is left.
std::vector<std::size_t> scattered(std::size_t runs, const SweepShare& share);

}  // namespace flatspeckle::apps
