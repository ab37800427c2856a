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
  /// Returns a column. If there is no column of this name, throws InputError; the message lists the
  /// columns of the file.
  std::span<const double> column(const std::string& name) const;

 private:
  std::string source_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

/// Function that returns whether a column of this name contains angles.
using AngleColumns = std::function<bool(const std::string& name)>;
/// Returns true for angle, light_angle, view_angle, tilt, phase and aperture.
bool is_angle_column(const std::string& name);

/// Reads a table (core/keys/table_text.h): one line of column names, then lines of finite numbers.
/// Empty unnamed columns at the end, as spreadsheets write them, are ignored. Numbers may have a
/// decimal comma if it cannot be a thousands separator, and angles may have a unit (30deg). A
/// column NAME_deg of angles in degrees becomes the column NAME in radians. Throws InputError; the
/// message names file, line and problem.
Table read_csv(const std::filesystem::path& path, const AngleColumns& is_angle = is_angle_column);
/// Reads the table whose path is the value of a key; it must have at least one row. Error messages
/// begin with the key: "layers = tissue.csv, line 3: ...".
Table read_key_table(const std::string& key, const std::filesystem::path& path,
                     const AngleColumns& is_angle = is_angle_column);
/// Reads the table whose path is the value of a key. Throws InputError for columns that are not in
/// `columns`, because they would be ignored, and for numbers of magnitude above 1e50. may_be_empty:
/// whether a table without rows is accepted.
Table read_key_table(const std::string& key, const std::filesystem::path& path,
                     const std::vector<std::string>& columns, bool may_be_empty = false);

/// Reads a table without column names, row by row. Throws InputError if the rows have different
/// lengths.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& path);

}  // namespace flatspeckle
