#pragma once

#include <string>
#include <vector>

#include "core/result/collected_result.h"

namespace flatspeckle::apps {

/// A number of a result: "total", "sensors/through/total", "image[3,4]".
class Objective {
 public:
  /// Throws InputError, naming the key that asks for it.
  Objective(std::string key, const std::string& text);

  const std::string& text() const { return text_; }
  /// Throws InputError where the result has no such number.
  double of(const CollectedResult& result) const;
  /// The dataset. Throws InputError.
  const CollectedDataset& dataset(const CollectedResult& result) const;

 private:
  std::size_t place_in(const CollectedResult& result, const CollectedDataset& set) const;

  std::string key_, text_, path_;
  std::vector<std::size_t> index_;
};

}  // namespace flatspeckle::apps
