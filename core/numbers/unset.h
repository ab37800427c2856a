#pragma once

#include <memory>
#include <utility>

namespace flatspeckle {

/// Allocator of a vector whose elements are written before they are read: they are not set to 0
/// when it is made with a size.
template <typename Number>
struct Unset : std::allocator<Number> {
  Unset() = default;
  template <typename Other>
  Unset(const Unset<Other>&) {}
  template <typename Other>
  struct rebind {
    using other = Unset<Other>;
  };

  void construct(Number*) const {}
  template <typename... Values>
  void construct(Number* at, Values&&... values) const {
    std::construct_at(at, std::forward<Values>(values)...);
  }
};

}  // namespace flatspeckle
