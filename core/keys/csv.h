#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace flatspeckle {

/// Named columns of numbers, all of the same length.
class Table {
 public:
  Table(std::string source, std::vector<std::string> names,
        std::vector<std::vector<double>> columns);

  const std::vector<std::string>& names() const { return names_; }
  std::size_t rows() const { return columns_.front().size(); }
  bool has(const std::string& name) const;
  /// Throws InputError naming the file and its columns if there is none of this name.
  std::span<const double> column(const std::string& name) const;

 private:
  std::string source_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

/// Reads a comma-separated file: one line of column names, then lines of finite numbers. Spaces
/// around fields, blank lines, CRLF, lines that start with '#' and a UTF-8 byte order mark are
/// allowed. Throws InputError naming file, line and what is wrong.
Table read_csv(const std::filesystem::path& path);
/// The same of a table that holds no other columns than these, which nothing would read, and
/// numbers from -1e50 to 1e50.
Table read_csv(const std::filesystem::path& path, const std::vector<std::string>& columns);

}  // namespace flatspeckle
