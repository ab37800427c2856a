#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

class Hdf5Handle;

/// Type of the values of a dataset; whole numbers count as real.
enum class StoredValues { real, complex, text };

/// Reader of a result file. Throws InputError, which names the file, if the requested content is
/// missing, of another type, truncated or damaged.
class ResultReader {
 public:
  explicit ResultReader(std::filesystem::path path);
  ResultReader(ResultReader&&) noexcept;
  ResultReader& operator=(ResultReader&&) noexcept;
  ~ResultReader();

  const std::filesystem::path& path() const { return path_; }

  /// Whether the file contains a group or dataset of this name.
  bool has(const std::string& name) const;
  bool has_attribute(const std::string& object, const std::string& name) const;

  /// Returns the names of the datasets and groups in a group, in alphabetical order; an empty list
  /// if the group does not exist.
  std::vector<std::string> members(const std::string& group) const;

  /// Returns the paths of all datasets, group by group in alphabetical order.
  std::vector<std::string> datasets() const;
  StoredValues stored_values(const std::string& name) const;
  /// Returns the path of the dimension scale of each axis of a dataset; empty if an axis has none.
  std::vector<std::string> axes(const std::string& name) const;

  /// Returns the length of each axis of a dataset; an empty list for a scalar.
  std::vector<std::size_t> shape(const std::string& name) const;

  /// Returns the values of a dataset in row-major order. Value: double, Complex or
  /// std::string.
  template <typename Value>
  std::vector<Value> dataset(const std::string& name) const;

  /// Returns the value of an attribute. Value: bool, std::uint64_t, double, std::vector<double> or
  /// std::string.
  template <typename Value>
  Value attribute(const std::string& object, const std::string& name) const;

 private:
  std::filesystem::path path_;
  std::unique_ptr<Hdf5Handle> file_;
};

}  // namespace flatspeckle
