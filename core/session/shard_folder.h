#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "core/result/result_file.h"
#include "core/result/result_reader.h"

namespace flatspeckle {

/// What a sweep has finished or begun: a sealed file for each point and method, NAME.h5, while it
/// is unfinished NAME.part.h5. For any thread.
class ShardFolder {
 public:
  enum class Part { finished, unfinished };

  explicit ShardFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }
  /// Made if it is not there. Throws IoError.
  void make() const;
  bool has(const std::string& name, Part part) const;

  /// Hands the file to `reading` if it is whole and has this identity (a root attribute). Else, and
  /// where `reading` throws InputError, says what is wrong with it.
  std::optional<std::string> read(const std::string& name, Part part, const std::string& identity,
                                  const std::function<void(const ResultReader&)>& reading);
  /// Renames a file with which something is wrong, and says so on standard error. Throws IoError.
  void set_aside(const std::string& name, Part part, const std::string& wrong);

  /// Writes the file as a whole: its identity and what `contents` adds. A finished one takes the
  /// place of the unfinished. Throws IoError.
  void write(const std::string& name, Part part, const std::string& identity, Durable durable,
             const std::function<void(ResultFile&)>& contents);

  /// Those of the files there.
  std::set<std::string> names() const;
  /// Where there is one.
  void remove_unfinished(const std::string& name) const;
  /// Removes the files of these names, those that a killed process was writing as well, and the
  /// folder if nothing is left in it. Throws IoError.
  void remove(const std::set<std::string>& names) const;

 private:
  std::filesystem::path file(const std::string& name, Part part) const;

  std::filesystem::path folder_;
  std::mutex mutex_;  // HDF5 is for one thread at a time
};

}  // namespace flatspeckle
