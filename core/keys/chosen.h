#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/contract.h"

namespace flatspeckle {

/// Returns the enumerator that belongs to a word: the words are listed in the order of the
/// enumerators. Precondition: `words` contains the word.
template <typename Choice>
Choice chosen(const std::vector<std::string>& words, const std::string& word) {
  const auto found = std::ranges::find(words, word);
  FS_EXPECT(found != words.end());
  return static_cast<Choice>(found - words.begin());
}

}  // namespace flatspeckle
