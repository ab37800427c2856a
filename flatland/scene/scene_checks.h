#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace flatspeckle {

// What the keys of a scene are held to. All throw InputError naming key and value.

inline void all_finite(const std::string& key, const std::vector<double>& values) {
  for (double value : values)
    if (!std::isfinite(value)) throw InputError(key, value, "must be finite");
}

/// Whoever writes 45 means degrees.
inline void all_radians(const std::string& key, const std::vector<double>& angles) {
  all_finite(key, angles);
  for (double angle : angles)
    if (std::abs(angle) > 2 * std::numbers::pi)
      throw InputError(key, angle, "angles are in radians, at most 2 pi");
}

inline void not_empty(const std::string& key, const std::vector<double>& values) {
  if (values.empty()) throw InputError(key + " = []: must hold at least one number");
}

inline void no_repeats(const std::string& key, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto twice = std::adjacent_find(values.begin(), values.end());
  if (twice != values.end()) throw InputError(key, *twice, "is given twice");
}

/// The words of a key and what they choose.
template <typename Choice>
using Choices = std::vector<std::pair<std::string, Choice>>;

template <typename Choice>
std::vector<std::string> words_of(const Choices<Choice>& choices) {
  std::vector<std::string> words;
  for (const auto& [word, choice] : choices) words.push_back(word);
  return words;
}

/// Of a word that is one of them.
template <typename Choice>
Choice chosen(const Choices<Choice>& choices, const std::string& word) {
  for (const auto& [name, choice] : choices)
    if (name == word) return choice;
  throw std::logic_error(word + " is no choice");
}

}  // namespace flatspeckle
