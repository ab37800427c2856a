#include "core/keys/csv.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <set>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/table_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle {

namespace {

constexpr std::string_view degrees = "_deg";

/// Parses the numbers of a table. Decimal commas are accepted if no number has a decimal point.
class NumberReader {
 public:
  NumberReader(const std::filesystem::path& path, const TableText& text)
      : path_(path.string()), text_(text) {}

  double read(const TableLine& line, const std::string& name, const std::string& field,
              bool angle) {
    const std::string number = with_point(line, field);
    const auto value = angle ? written_number(number, KeyUnit("rad")) : read_number(number);
    if (!value || !std::isfinite(*value))
      text_.fail(line, name + " = \"" + field + "\": must be a finite number");
    return *value;
  }

  /// To be called after all numbers are read. Throws InputError if it is not certain that commas in
  /// the numbers are decimal commas: they may separate thousands, or other numbers have a decimal
  /// point.
  void check() const {
    if (comma_ == 0) return;
    const std::string lines =
        path_ + ", line " + std::to_string(comma_) + ": \"" + with_comma_ + '"';
    if (point_ > 0)
      throw InputError(lines + " has a decimal comma, but line " + std::to_string(point_) +
                       " has a decimal point: use only one of the two");
    if (!surely_decimal_ && text_.separator() != ';')
      throw InputError(lines +
                       ": the comma may be a decimal or a thousands separator; must be written "
                       "with a decimal point");
  }

 private:
  std::string with_point(const TableLine& line, std::string field) {
    const auto comma = field.find(',');
    const bool has_point = field.find('.') != field.npos;
    if (has_point && point_ == 0) point_ = line.number;
    if (comma == field.npos || has_point || field.find(',', comma + 1) != field.npos) return field;
    if (comma_ == 0) {
      comma_ = line.number;
      with_comma_ = field;
    }
    surely_decimal_ = surely_decimal_ || !may_divide_thousands(field);
    field[comma] = '.';
    return field;
  }

  /// Whether the comma in a number may separate thousands, as in -12,345.
  static bool may_divide_thousands(std::string_view field) {
    if (field.starts_with('-') || field.starts_with('+')) field.remove_prefix(1);
    const auto comma = field.find(',');
    return comma > 0 && comma <= 3 && field.front() != '0' && field.size() == comma + 4 &&
           field.find_first_not_of("0123456789,") == field.npos;
  }

  std::string path_, with_comma_;
  const TableText& text_;
  /// Line numbers of the first line with a decimal comma and of the first line with a decimal
  /// point; 0 if there is none.
  std::size_t comma_ = 0, point_ = 0;
  bool surely_decimal_ = false;
};

class CsvReader {
 public:
  CsvReader(const std::filesystem::path& path, const AngleColumns& is_angle)
      : path_(path.string()), is_angle_(is_angle), text_(path, true), numbers_(path, text_) {}

  Table read(const std::string& source) {
    const auto& lines = text_.lines();
    if (lines.empty()) throw InputError(path_ + ": is empty; expected a line of column names");
    read_names(lines.front());
    for (auto line = lines.begin() + 1; line != lines.end(); ++line) read_row(*line);
    numbers_.check();
    for (std::size_t i = 0; i < names_.size(); ++i) turn_into_radians(i);
    return {source, std::move(names_), std::move(columns_)};
  }

 private:
  void read_names(const TableLine& line) {
    names_ = text_.fields(line);
    width_ = names_.size();
    while (names_.size() > 1 && names_.back().empty()) names_.pop_back();
    std::set<std::string> known;
    for (const std::string& name : names_) {
      if (name.empty()) text_.fail(line, "a column has no name");
      const std::string stem = name.substr(0, name.find_first_of(" ([/"));
      if (stem != name && is_angle_(stem))
        text_.fail(line, "column \"" + name + "\": name it " + stem + " (radians) or " + stem +
                             std::string(degrees) + " (degrees)");
      if (!known.insert(base(name)).second)
        text_.fail(line, "column \"" + base(name) + "\" appears twice");
    }
    columns_.resize(names_.size());
  }

  /// Appends the numbers of a line as a row. Lines with only empty fields, which spreadsheets also
  /// write, are skipped.
  void read_row(const TableLine& line) {
    auto fields = text_.fields(line);
    if (width_ > 1 && std::ranges::count(fields, "") == std::ssize(fields)) return;
    while (fields.size() > names_.size() && fields.size() <= width_ && fields.back().empty())
      fields.pop_back();
    if (fields.size() != names_.size())
      text_.fail(line, "expected " + std::to_string(names_.size()) + " fields, found " +
                           std::to_string(fields.size()) +
                           hint(fields.size()));
    for (std::size_t i = 0; i < fields.size(); ++i)
      columns_[i].push_back(numbers_.read(line, names_[i], fields[i], is_angle_(names_[i])));
  }

  /// Returns the likely reason why a line has this number of fields, if there is one.
  std::string hint(std::size_t fields) const {
    if (text_.separator() != ',') return "";
    if (fields == 1) return " (fields must be separated by commas, as the names are)";
    return fields >= 2 * names_.size() ? " (with decimal commas, fields must be separated by ;)"
                                       : "";
  }

  bool is_in_degrees(const std::string& name) const {
    return name.ends_with(degrees) && is_angle_(name.substr(0, name.size() - degrees.size()));
  }
  std::string base(const std::string& name) const {
    return is_in_degrees(name) ? name.substr(0, name.size() - degrees.size()) : name;
  }

  void turn_into_radians(std::size_t column) {
    if (!is_in_degrees(names_[column])) return;
    for (double& value : columns_[column]) value *= std::numbers::pi / 180;
    names_[column] = base(names_[column]);
  }

  std::string path_;
  const AngleColumns& is_angle_;
  TableText text_;
  NumberReader numbers_;
  std::size_t width_ = 0;  ///< number of fields in the line of column names
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

}  // namespace

Table::Table(std::string source, std::vector<std::string> names,
             std::vector<std::vector<double>> columns)
    : source_(std::move(source)), names_(std::move(names)), columns_(std::move(columns)) {}

bool Table::has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::span<const double> Table::column(const std::string& name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end())
    throw InputError(source_ + ": no column \"" + name + "\" among " + join_texts(names_, ", "));
  return columns_[static_cast<std::size_t>(found - names_.begin())];
}

bool is_angle_column(const std::string& name) {
  static const std::set<std::string> names = {"angle", "light_angle", "view_angle",
                                              "tilt",  "phase",       "aperture"};
  return names.contains(name);
}

Table read_csv(const std::filesystem::path& path, const AngleColumns& is_angle) {
  return CsvReader(path, is_angle).read(path.string());
}

namespace {

Table table_of(const std::string& key, const std::filesystem::path& path,
               const AngleColumns& is_angle) {
  try {
    return CsvReader(path, is_angle).read(key + " = " + path.string());
  } catch (const InputError& error) {
    throw InputError(key + " = " + error.what());
  }
}

void require_rows(const std::string& key, const std::filesystem::path& path, const Table& table) {
  if (table.rows() == 0)
    throw InputError(key, path.string(),
                     "must have at least one row; it contains only column names");
}

}  // namespace

Table read_key_table(const std::string& key, const std::filesystem::path& path,
                     const AngleColumns& is_angle) {
  Table table = table_of(key, path, is_angle);
  require_rows(key, path, table);
  return table;
}

Table read_key_table(const std::string& key, const std::filesystem::path& path,
                     const std::vector<std::string>& columns, bool may_be_empty) {
  Table table = table_of(key, path, is_angle_column);
  const auto refuse = [&](const std::string& what) {
    throw InputError(key + " = " + path.string() + what);
  };
  for (const std::string& name : table.names())
    if (std::ranges::find(columns, name) == columns.end())
      refuse(": column \"" + name + "\": must be one of " + join_texts(columns, ", "));
  if (!may_be_empty) require_rows(key, path, table);
  for (const std::string& name : table.names())
    for (const double value : table.column(name))
      if (std::abs(value) > most_input)
        refuse(", " + name + " = " + number_text(value) + ": must be from -1e50 to 1e50");
  return table;
}

std::vector<std::vector<double>> read_rows(const std::filesystem::path& path) {
  const TableText text(path, false);
  NumberReader numbers(path, text);
  std::vector<std::vector<double>> rows;
  for (const TableLine& line : text.lines()) {
    auto& row = rows.emplace_back();
    auto fields = text.fields(line);
    if (fields.back().empty()) fields.pop_back();  // the line ends with a comma
    for (const std::string& field : fields)
      row.push_back(numbers.read(line, "number " + std::to_string(row.size() + 1), field, false));
    if (row.size() != rows.front().size())
      text.fail(line, "has " + std::to_string(row.size()) + " numbers, but the first row has " +
                          std::to_string(rows.front().size()) +
                          ": all rows must have the same length");
  }
  numbers.check();
  return rows;
}

}  // namespace flatspeckle
