#pragma once

#include <string>
#include <tuple>
#include <vector>

namespace flatspeckle {

// The functions below process alternatives that the user selects by a word, such as kinds of light
// source. `kinds` is a tuple of structs of values, each with its selecting word in the member
// `word`.

/// Calls use(values) with each struct of the tuple, in order.
template <class Kinds, class Use>
void each_kind(Kinds&& kinds, const Use& use) {
  std::apply([&](auto&... kind) { (use(kind), ...); }, kinds);
}

/// Calls use(values) with the struct that this word selects, if there is one.
template <class Kinds, class Use>
void with_kind(const Kinds& kinds, const std::string& word, const Use& use) {
  each_kind(kinds, [&](const auto& kind) {
    if (word == kind.word) use(kind);
  });
}

template <class Kinds>
std::vector<std::string> kind_words(const Kinds& kinds) {
  std::vector<std::string> words;
  each_kind(kinds, [&](const auto& kind) { words.emplace_back(kind.word); });
  return words;
}

}  // namespace flatspeckle
