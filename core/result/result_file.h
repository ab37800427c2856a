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

/// One axis of a dataset: the name of a dimension scale that is already written, or a length for an
/// axis without a scale.
using Axis = std::variant<std::size_t, std::string>;

/// Values of a dataset in row-major order (last axis fastest). Texts are UTF-8.
using Values = std::variant<std::span<const double>, std::span<const Complex>,
                            std::span<const std::uint64_t>, std::span<const std::string>>;

/// Value of an attribute; bool is stored as uint8.
using Attribute = std::variant<bool, std::int64_t, std::uint64_t, double, std::string,
                               std::vector<double>, std::vector<std::string>>;

/// Writer of a result file (HDF5, readable by version 1.8 and later; h5py reads complex numbers as
/// complex128). The file is built in memory or, if it may be large, on disk under a temporary name.
/// commit() moves the complete file to its path; without commit(), no file remains. Names of
/// datasets may contain groups ("trace/wall_s"), which are created as needed; "/" is the root. Not
/// thread-safe.
///
/// Throws std::logic_error, which names the dataset or attribute, if a value is not finite, if the
/// number of values does not match the axes, or if a name is used twice.
class ResultFile {
 public:
  /// Where the file is built: in memory, or on disk, which needs little memory but allows only one
  /// unfinished file per path.
  enum class Storage { memory, disk };

  /// Makes an empty result that commit() writes to `path`. Throws IoError. To detect an unusable
  /// path before long work, call check_result_path().
  explicit ResultFile(std::filesystem::path path, Storage storage = Storage::memory);
  /// Makes a writer that collects the result in memory (`collected`) instead of a file; commit()
  /// must not be called.
  explicit ResultFile(CollectedResult& collected);
  ResultFile(ResultFile&&) noexcept;
  ResultFile& operator=(ResultFile&&) noexcept;
  ~ResultFile();

  const std::filesystem::path& path() const { return path_; }
  /// Whether a group or dataset of this name has been written.
  bool has(const std::string& name) const;

  /// Sets the axes, or the unit, for which a word in capitals (a role, see DatasetRow) stands in
  /// all following calls.
  void bind(const std::string& role, const std::vector<Axis>& names) { roles_[role] = names; }
  /// Returns the axes or the unit set by bind(). Throws std::logic_error if none are set.
  const std::vector<Axis>& bound(const std::string& role) const;

  /// Writes an attribute of a dataset or of a group, which is created if it is missing.
  void attribute(const std::string& object, const std::string& name, const Attribute& value);

  /// Writes an axis (a one-dimensional dimension scale of HDF5). Empty units and long names are not
  /// written; the unit "1" means that the values are dimensionless.
  void scale(const std::string& name, std::span<const double> values, const std::string& units,
             const std::string& long_name);
  /// Writes an axis of many values, whose value i is computed by value(i) while it is written.
  void scale(const std::string& name, std::size_t count,
             const std::function<double(std::size_t)>& value, const std::string& units,
             const std::string& long_name);
  /// Writes a dataset; if `axes` is empty, the dataset is a scalar.
  void dataset(const std::string& name, const Values& values, const std::vector<Axis>& axes,
               const std::string& units, const std::string& long_name);

  /// Creates a dataset whose values are written later by write_block(). Its type is that of `none`.
  /// It is stored in compressed chunks of the shape `chunk`; axes beyond the length of `chunk` are
  /// not divided. Values that are never written are 0 or empty.
  void begin_dataset(const std::string& name, const Values& none, const std::vector<Axis>& axes,
                     const std::vector<std::size_t>& chunk, const std::string& units,
                     const std::string& long_name);
  /// Writes a block of values that begins at the indices `start` and has `count` values along each
  /// axis. Axes beyond the length of `start` and `count` are written in full. Blocks that are whole
  /// chunks are fastest. Throws IoError.
  void write_block(const std::string& name, const Values& values,
                   const std::vector<std::size_t>& start, const std::vector<std::size_t>& count);

  /// Records a text such as "intensity: 2 of 8" about estimates that are undersampled, which is
  /// later shown to the user.
  void note_rare(const std::string& estimates) { rare_.push_back(estimates); }
  const std::vector<std::string>& rare() const { return rare_; }
  /// Records the name of a dataset, or OBJECT@ATTRIBUTE, that is not written because a value is not
  /// finite.
  void note_undefined(const std::string& name) { undefined_.push_back(name); }
  const std::vector<std::string>& undefined() const { return undefined_; }

  /// Records an invariant of the result with the name of its dataset. If the dataset has several
  /// values, `worst` is the one that most exceeds its limit.
  void note_invariant(const std::string& name, const Invariant& worst) {
    invariants_.emplace_back(name, worst);
  }
  const std::vector<std::pair<std::string, Invariant>>& invariants() const { return invariants_; }
  bool keeps_invariants() const;

  /// Completes the file and moves it to its path, replacing an existing file. Throws IoError.
  /// Afterwards nothing more can be written.
  void commit() { commit(false, Durable::yes); }
  /// Calls commit() after appending a checksum record (guarded_read.h) to the file.
  void commit_checksummed(Durable durable) { commit(true, durable); }

 private:
  void commit(bool is_checksummed, Durable durable);
  void reserve_space(std::size_t bytes);
  std::vector<std::byte> image();

  std::filesystem::path path_;
  // declared before file_, because it must be destroyed after file_
  std::unique_ptr<FileBeside> beside_;
  std::unique_ptr<Hdf5Handle> file_;
  CollectedResult* collected_ = nullptr;  ///< if set, receives the result instead of a file
  std::map<std::string, std::vector<Axis>> roles_;
  std::vector<std::string> rare_;
  std::vector<std::pair<std::string, Invariant>> invariants_;
  std::vector<std::string> undefined_;
};

/// Calls check_writable(), and throws InputError if the existing file at `path` is not a result
/// file, because it would be replaced.
void check_result_path(const std::filesystem::path& path);

}  // namespace flatspeckle
