#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/result/result_file.h"

namespace flatspeckle {

/// A dataset, with all that a result file says of it.
struct CollectedDataset {
  /// By the alternatives of Values.
  using Held = std::variant<std::vector<double>, std::vector<Complex>, std::vector<std::uint64_t>,
                            std::vector<std::string>>;
  std::string name;
  bool is_scale = false;
  std::vector<Axis> axes;
  std::string units, long_name;
  Held values;

  std::size_t count() const;
};

struct CollectedAttribute {
  std::string object, name;
  Attribute value;
};

/// What would stand in a result file, in the order in which it was put there: the result of one
/// point of many, which have a file together. ResultFile(collected) fills it.
struct CollectedResult {
  std::vector<CollectedDataset> datasets;
  std::vector<CollectedAttribute> attributes;

  /// nullptr where there is none.
  const CollectedDataset* find(const std::string& name) const;
  /// Throws std::logic_error where there is one of this name.
  void add(CollectedDataset set);
  /// The same with all values 0, or empty.
  void begin(CollectedDataset set);
  /// As ResultFile::write_block.
  void put_block(const std::string& name, const Values& values, std::vector<std::size_t> start,
                 std::vector<std::size_t> count);
  bool has_group(const std::string& name) const;
  /// Whether no invariant among the datasets exceeds its limit (ResultGroup::check).
  bool keeps_invariants() const;

 private:
  std::vector<std::size_t> extents(const CollectedDataset& set) const;
};

/// All of it into a file.
void put(ResultFile& file, const CollectedResult& result);

// A result as bytes: its layout, which many results share, and its values. Numbers as the machine
// has them.

/// Names, axes, units, numbers of values, and attributes that are no numbers.
std::vector<std::byte> layout_of(const CollectedResult& result);
/// All else, in the order of the layout.
std::vector<std::byte> values_of(const CollectedResult& result);
/// What has this layout; without values, the numbers are all 0. Throws InputError where bytes are
/// missing or left over.
CollectedResult result_of(std::span<const std::byte> layout, std::span<const std::byte> values);
CollectedResult result_of(std::span<const std::byte> layout);

}  // namespace flatspeckle
