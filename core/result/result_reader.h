#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

class Hdf5Handle;

/// Reads result files. Whatever is missing, of another type, truncated or damaged throws
/// InputError, naming the file.
class ResultReader {
 public:
  explicit ResultReader(std::filesystem::path path);
  ResultReader(ResultReader&&) noexcept;
  ResultReader& operator=(ResultReader&&) noexcept;
  ~ResultReader();

  const std::filesystem::path& path() const { return path_; }

  /// Is there a group or dataset of this name?
  bool has(const std::string& name) const;
  bool has_attribute(const std::string& object, const std::string& name) const;

  /// Names of what is in a group, in alphabetical order; none where there is no such group.
  std::vector<std::string> members(const std::string& group) const;

  /// Extents of a dataset; empty for a scalar.
  std::vector<std::size_t> shape(const std::string& name) const;

  /// Number: double or Complex. Row-major order.
  template <typename Number>
  std::vector<Number> dataset(const std::string& name) const;

  /// Value: bool, std::uint64_t, double, std::vector<double> or std::string.
  template <typename Value>
  Value attribute(const std::string& object, const std::string& name) const;

 private:
  std::filesystem::path path_;
  std::unique_ptr<Hdf5Handle> file_;
};

}  // namespace flatspeckle
