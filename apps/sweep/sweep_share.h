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
class ScatteredRuns {
 public:
  explicit ScatteredRuns(std::size_t runs, const SweepShare& share = {});

  std::size_t size() const;
  std::size_t operator[](std::size_t number) const;

 private:
  std::size_t runs_, stride_;
  SweepShare share_;
};

}  // namespace flatspeckle::apps
