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

/// The root of a result file or one of its groups, and the table of what may be written there:
/// units, long names, axes and companions come from its rows. Datasets and attributes with a value
/// that is not finite are left out and noted (ResultFile::undefined), that the rest of a finished
/// run is not lost. Throws std::logic_error for a name without a row, for values that are not what
/// the row says, and as ResultFile does.
class ResultGroup {
 public:
  /// group: its name, or empty for the root. The table must live as long.
  ResultGroup(ResultFile& file, const DatasetTable& table, const std::string& group = "");

  void put(const std::string& path, const Values& values) const;
  void put(const std::string& path, double scalar) const { put(path, std::span(&scalar, 1)); }
  void put(const std::string& path, std::uint64_t scalar) const {
    put(path, std::span(&scalar, 1));
  }
  /// rare: see Estimate; written, as path_rare, only where a value is.
  void put(const std::string& path, const Values& values, std::span<const double> errors,
           std::span<const std::uint64_t> rare = {}) const;
  void put(const std::string& path, double scalar, double error) const {
    put(path, std::span<const double>(&scalar, 1), std::span<const double>(&error, 1));
  }
  /// Of an estimate that is real: the real parts.
  void put(const std::string& path, const Estimate& estimate) const;
  /// Writes an invariant, or one of each thing along an axis, with its limit. Where one fails, the
  /// result has not converged.
  void check(const std::string& path, std::span<const Invariant> invariants) const;
  void check(const std::string& path, const Invariant& invariant) const {
    check(path, std::span(&invariant, 1));
  }
  /// An axis 0, 1, ..., count - 1.
  void number(const std::string& path, std::size_t count) const;
  /// For blocks that follow (ResultFile::write_block).
  void begin(const std::string& path, const std::vector<std::size_t>& chunk) const;

  /// What is known of a dataset.
  const DatasetRow& row(const std::string& path) const { return row_of(table_, path); }

  void attribute(const std::string& object, const std::string& name, const Attribute& value) const;
  /// Of the root.
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

/// A value of each thing, as put() takes them: texts, numbers, or (of whole numbers and
/// enumerators) counts. value: a member or function of a thing.
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
