#pragma once

#include <filesystem>
#include <functional>
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

/// Whether a column of this name holds angles.
using AngleColumns = std::function<bool(const std::string& name)>;
/// angle, light_angle, view_angle, tilt, phase and aperture.
bool is_angle_column(const std::string& name);

/// Reads a table (core/keys/table_text.h): one line of column names, then lines of finite numbers.
/// Columns without a name behind all others may be there, empty, as spreadsheets write them. A
/// number may have a decimal comma where that cannot mean anything else, angles a unit (30deg); the
/// angles of a column NAME_deg become those of a column NAME, in radians. Throws InputError naming
/// file, line and what is wrong.
Table read_csv(const std::filesystem::path& path, const AngleColumns& is_angle = is_angle_column);
/// Reads the table that a key names, which must have a row or more. Messages begin with the
/// key: "layers = tissue.csv, line 3: ...".
Table read_key_table(const std::string& key, const std::filesystem::path& path,
                     const AngleColumns& is_angle = is_angle_column);
/// The same of a table that holds no other columns than these, which nothing would read, and
/// numbers from -1e50 to 1e50. may_be_empty: without rows, too.
Table read_key_table(const std::string& key, const std::filesystem::path& path,
                     const std::vector<std::string>& columns, bool may_be_empty = false);

/// Reads a table without names of columns, row by row. Throws InputError where a row has fewer or
/// more numbers than the first.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& path);

}  // namespace flatspeckle
