#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/numbers/statistics.h"
#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "core/result/result_file.h"

namespace flatspeckle {

/// Writer for the root of a result file or one of its groups. A DatasetTable lists the datasets and
/// attributes that may be written, with their types, units, long names and axes. Those with a value
/// that is not finite are not written but recorded (ResultFile::undefined()), so that the rest of
/// the result is not lost. Throws std::logic_error for names that are not in the table and for
/// values of another type, and the exceptions of ResultFile.
class ResultGroup {
 public:
  /// group: name of the group; empty for the root. The table must outlive this object.
  ResultGroup(ResultFile& file, const DatasetTable& table, const std::string& group = "");

  void put(const std::string& path, const Values& values) const;
  void put(const std::string& path, double scalar) const { put(path, std::span(&scalar, 1)); }
  void put(const std::string& path, std::uint64_t scalar) const {
    put(path, std::span(&scalar, 1));
  }
  /// Writes values, and their standard errors as PATH_error. rare: marks of undersampled values
  /// (see Estimate); written as PATH_rare if any of them is 1.
  void put(const std::string& path, const Values& values, std::span<const double> errors,
           std::span<const std::uint64_t> rare = {}) const;
  void put(const std::string& path, double scalar, double error) const {
    put(path, std::span<const double>(&scalar, 1), std::span<const double>(&error, 1));
  }
  /// Writes an estimate; only its real parts if the table defines the dataset as real.
  void put(const std::string& path, const Estimate& estimate) const;
  /// Writes invariants, and their limits as PATH_limit. If one of them exceeds its limit, the
  /// result counts as not converged.
  void check(const std::string& path, std::span<const Invariant> invariants) const;
  void check(const std::string& path, const Invariant& invariant) const {
    check(path, std::span(&invariant, 1));
  }
  /// Writes an axis with the values 0, 1, ..., count - 1.
  void number(const std::string& path, std::size_t count) const;
  /// Creates a complex dataset, whose values are then written by ResultFile::write_block().
  void begin(const std::string& path, const std::vector<std::size_t>& chunk) const;

  /// Returns the metadata of a dataset from the table.
  const DatasetRow& row(const std::string& path) const { return row_of(table_, path); }

  void attribute(const std::string& object, const std::string& name, const Attribute& value) const;
  /// Writes an attribute of this group or, if `group` was empty, of the root.
  void attribute(const std::string& name, const Attribute& value) const {
    attribute("", name, value);
  }

 private:
  void write(const DatasetRow& row, const Values& values) const;
  std::vector<Axis> axes(const DatasetRow& row) const;
  std::string unit(const DatasetRow& row) const;

  ResultFile& file_;
  const DatasetTable& table_;
  std::string prefix_;
};

/// Returns the list of value(thing) for all things, as a vector that put() accepts: of texts, of
/// doubles, or of std::uint64_t for integers and enumerators. value: a member of the things, or a
/// function.
template <class Things, class Value>
auto column(const Things& things, const Value& value) {
  using Given = std::decay_t<std::invoke_result_t<const Value&, decltype(*things.begin())>>;
  constexpr bool counts = std::is_integral_v<Given> || std::is_enum_v<Given>;
  std::vector<std::conditional_t<counts, std::uint64_t, Given>> values;
  for (const auto& thing : things)
    values.push_back(
        static_cast<std::conditional_t<counts, std::uint64_t, Given>>(std::invoke(value, thing)));
  return values;
}

}  // namespace flatspeckle
