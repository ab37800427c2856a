#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/result/result_file.h"

namespace flatspeckle {

/// A dataset with its metadata, as in a result file, but in memory.
struct CollectedDataset {
  /// Values of one of the types that Values lists; unlike Values, it owns them.
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

/// Content of a result file, kept in memory in the order in which it was written; used for each
/// point of a sweep, before all points are combined in one file. It is filled through
/// ResultFile(collected).
struct CollectedResult {
  std::vector<CollectedDataset> datasets;
  std::vector<CollectedAttribute> attributes;

  /// Returns the dataset of this name; nullptr if there is none.
  const CollectedDataset* find(const std::string& name) const;
  /// Adds a dataset. Throws std::logic_error if a dataset of this name exists.
  void add(CollectedDataset set);
  /// Adds a dataset with all numbers 0, or all texts empty.
  void begin(CollectedDataset set);
  /// Sets a block of the values of a dataset, as ResultFile::write_block() does.
  void put_block(const std::string& name, const Values& values, std::vector<std::size_t> start,
                 std::vector<std::size_t> count);
  bool has_group(const std::string& name) const;
  /// Whether all invariants that ResultGroup::check() has written are within their limits.
  bool keeps_invariants() const;

 private:
  std::vector<std::size_t> extents(const CollectedDataset& set) const;
};

/// Writes all datasets and attributes of the result into a file.
void put(ResultFile& file, const CollectedResult& result);

// The functions below convert a result to bytes in two parts: the layout, which many results share,
// and the values. Numbers are in the machine's representation.

/// Returns the layout as bytes: names, axes, units and lengths of the datasets, and attributes that
/// are not numbers.
std::vector<std::byte> layout_of(const CollectedResult& result);
/// Returns the values as bytes: the datasets and the attributes that are numbers, in the order of
/// the layout.
std::vector<std::byte> values_of(const CollectedResult& result);
/// Returns the result that has this layout and these values; without the argument `values`, all its
/// numbers are 0. Throws InputError if there are too few or too many bytes.
CollectedResult result_of(std::span<const std::byte> layout, std::span<const std::byte> values);
CollectedResult result_of(std::span<const std::byte> layout);

}  // namespace flatspeckle
