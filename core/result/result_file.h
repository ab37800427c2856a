#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/atomic_file.h"
#include "core/result/invariant.h"

namespace flatspeckle {

class Hdf5Handle;
struct CollectedResult;

/// One axis of a dataset: the name of a scale written before, or a plain extent.
using Axis = std::variant<std::size_t, std::string>;

/// Values of a dataset in row-major order (last axis fastest). Texts are UTF-8.
using Values = std::variant<std::span<const double>, std::span<const Complex>,
                            std::span<const std::uint64_t>, std::span<const std::string>>;

/// Value of an attribute; bool is stored as uint8.
using Attribute = std::variant<bool, std::int64_t, std::uint64_t, double, std::string,
                               std::vector<double>, std::vector<std::string>>;

/// A result file in the making (HDF5, readable by version 1.8 and later; h5py sees complex numbers
/// as complex128). It is put together in memory or, where it may be large, on disk under a
/// temporary name; commit() puts it at its path as a whole, and without commit nothing is left.
/// Names may hold groups ("trace/wall_s"), which are made as needed; "/" is the root. One thread at
/// a time.
///
/// All that is written must be finite: std::logic_error names the dataset or attribute otherwise,
/// and also where the number of values does not fit the axes or a name is used twice.
class ResultFile {
 public:
  /// disk: memory stays bounded; one file in the making per path.
  enum class Storage { memory, disk };

  /// Throws IoError. Where a path may be wrong, check_result_path says so before long work.
  explicit ResultFile(std::filesystem::path path, Storage storage = Storage::memory);
  /// No file: what is put here goes there, and there is nothing to commit.
  explicit ResultFile(CollectedResult& collected);
  ResultFile(ResultFile&&) noexcept;
  ResultFile& operator=(ResultFile&&) noexcept;
  ~ResultFile();

  const std::filesystem::path& path() const { return path_; }
  /// Whether there is such a group or dataset.
  bool has(const std::string& name) const;

  /// What a role (core/result/dataset_row.h) stands for from here on: axes, or one unit.
  void bind(const std::string& role, const std::vector<Axis>& names) { roles_[role] = names; }
  /// Throws std::logic_error for a role that is not bound.
  const std::vector<Axis>& bound(const std::string& role) const;

  /// Of a group (made as needed) or dataset.
  void attribute(const std::string& object, const std::string& name, const Attribute& value);

  /// An axis: a 1D dimension scale. Units and long name are left out where empty; "1" says that the
  /// values have no unit.
  void scale(const std::string& name, std::span<const double> values, const std::string& units,
             const std::string& long_name);
  /// The same of very many values, which are made when they are written.
  void scale(const std::string& name, std::size_t count,
             const std::function<double(std::size_t)>& value, const std::string& units,
             const std::string& long_name);
  /// No axes: one scalar.
  void dataset(const std::string& name, const Values& values, const std::vector<Axis>& axes,
               const std::string& units, const std::string& long_name);

  /// A dataset whose values, of the kind of `none`, come in blocks, compressed by chunks of this
  /// shape; axes that it does not reach are whole. What no block brings is 0 or empty.
  void begin_dataset(const std::string& name, const Values& none, const std::vector<Axis>& axes,
                     const std::vector<std::size_t>& chunk, const std::string& units,
                     const std::string& long_name);
  /// Values of a block from index `start` on, of `count` along each axis; axes that these do not
  /// reach are whole. Best of whole chunks. Throws IoError.
  void write_block(const std::string& name, const Values& values,
                   const std::vector<std::size_t>& start, const std::vector<std::size_t>& count);

  /// Remembers estimates whose errors are likely too small, as "intensity: 2 of 8", to tell the
  /// user.
  void note_rare(const std::string& estimates) { rare_.push_back(estimates); }
  const std::vector<std::string>& rare() const { return rare_; }
  /// Remembers a dataset, or OBJECT@ATTRIBUTE, that is left out, for it is not finite.
  void note_undefined(const std::string& name) { undefined_.push_back(name); }
  const std::vector<std::string>& undefined() const { return undefined_; }

  /// Remembers an invariant of the result by the name of its dataset; of several values, the worst.
  void note_invariant(const std::string& name, const Invariant& worst) {
    invariants_.emplace_back(name, worst);
  }
  const std::vector<std::pair<std::string, Invariant>>& invariants() const { return invariants_; }
  bool keeps_invariants() const;

  /// Puts the file at its path, replacing what is there. Throws IoError. Nothing can be written
  /// afterwards.
  void commit() { commit(false, Durable::yes); }
  /// Commits the file with a seal (guarded_read.h) at its end.
  void commit_sealed(Durable durable) { commit(true, durable); }

 private:
  void commit(bool is_sealed, Durable durable);
  void make_room(std::size_t bytes);
  std::vector<std::byte> image();

  std::filesystem::path path_;
  std::unique_ptr<FileBeside> beside_;  // outlives file_
  std::unique_ptr<Hdf5Handle> file_;
  CollectedResult* collected_ = nullptr;  ///< in place of a file
  std::map<std::string, std::vector<Axis>> roles_;
  std::vector<std::string> rare_;
  std::vector<std::pair<std::string, Invariant>> invariants_;
  std::vector<std::string> undefined_;
};

/// check_writable, and throws InputError where another kind of file is, which would be lost.
void check_result_path(const std::filesystem::path& path);

}  // namespace flatspeckle
