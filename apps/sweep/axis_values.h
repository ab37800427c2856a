#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <variant>
#include <vector>

#include "core/keys/written_number.h"

namespace flatspeckle::apps {

/// Values of an axis, as text that reads back as the same numbers: a list of them, or a range,
/// whose values are made when they are asked for, since they may be very many.
class AxisValues {
 public:
  AxisValues(std::vector<std::string> texts = {}) : values_(std::move(texts)) {}
  AxisValues(std::initializer_list<std::string> texts) : values_(std::vector(texts)) {}
  explicit AxisValues(const NumberRange& range) : values_(range) {}

  std::size_t size() const;
  std::string operator[](std::size_t number) const;
  std::string front() const { return (*this)[0]; }
  std::string back() const { return (*this)[size() - 1]; }
  std::vector<std::string> texts() const;
  /// nullptr: a list.
  const NumberRange* range() const { return std::get_if<NumberRange>(&values_); }

 private:
  std::variant<std::vector<std::string>, NumberRange> values_;
};

}  // namespace flatspeckle::apps
