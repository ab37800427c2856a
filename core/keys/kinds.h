#pragma once

#include <string>
#include <tuple>
#include <vector>

namespace flatspeckle {

// The kinds of a thing, one of which a key chooses by its word: a tuple of structs of values, each
// with a `word`.

/// use(values) of each kind, in their order.
template <class Kinds, class Use>
void each_kind(Kinds&& kinds, const Use& use) {
  std::apply([&](auto&... kind) { (use(kind), ...); }, kinds);
}

/// use(values) of the kind of this word, where there is one.
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
