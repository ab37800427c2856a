#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace flatspeckle {

// What the keys of a scene are held to. All throw InputError naming key and value.

inline double positive(const std::string& key, double value) {
  if (!(std::isfinite(value) && value > 0)) throw InputError(key, value, "must be positive");
  constexpr double most = 1e50;  // products of a few of them stay numbers
  if (value > most || value < 1 / most) throw InputError(key, value, "must be from 1e-50 to 1e50");
  return value;
}

inline double positive(const std::string& key, const std::optional<double>& value) {
  if (!value) throw InputError(key + " is not given: must be positive");
  return positive(key, *value);
}

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

template <typename Value>
inline void only_for(const std::string& key, const std::optional<Value>& value, bool applies,
                     const std::string& what) {
  if (value && !applies) throw InputError(key, *value, "is a key of " + what + " only");
}

template <typename Choice>
Choice choose(const std::string& key, const std::string& word,
              const std::vector<std::pair<std::string, Choice>>& choices) {
  std::string accepted = "must be one of";
  for (const auto& [name, choice] : choices) {
    if (name == word) return choice;
    accepted += ' ' + name;
  }
  throw InputError(key, word, accepted);
}

}  // namespace flatspeckle
