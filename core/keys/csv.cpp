#include "core/keys/csv.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

constexpr const char* byte_order_mark = "\xEF\xBB\xBF";

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t comma = line.find(','); comma != std::string_view::npos;
       comma = line.find(',')) {
    fields.push_back(trimmed(line.substr(0, comma)));
    line.remove_prefix(comma + 1);
  }
  fields.push_back(trimmed(line));
  return fields;
}

class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& path) : path_(path.string()), file_(path) {
    if (!file_ || std::filesystem::is_directory(path)) throw InputError("cannot read " + path_);
  }

  Table read() {
    if (!next_line()) throw InputError(path_ + ": empty, expected a line of column names");
    read_names();
    while (next_line()) read_row();
    if (file_.bad()) throw InputError("cannot read " + path_);
    return {path_, std::move(names_), std::move(columns_)};
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_ + ", line " + std::to_string(number_) + ": " + what);
  }

  /// Goes to the next line that says something.
  bool next_line() {
    while (std::getline(file_, text_)) {
      if (++number_ == 1 && text_.starts_with(byte_order_mark)) text_.erase(0, 3);
      line_ = trimmed(text_);
      if (!line_.empty() && line_.front() != '#') return true;
    }
    return false;
  }

  void read_names() {
    for (std::string_view field : fields_of(line_)) {
      const std::string name(field);
      if (name.empty()) fail("a column has no name");
      if (std::find(names_.begin(), names_.end(), name) != names_.end())
        fail("column \"" + name + "\" appears twice");
      names_.push_back(name);
    }
    columns_.resize(names_.size());
  }

  void read_row() {
    const auto fields = fields_of(line_);
    if (fields.size() != names_.size())
      fail("expected " + std::to_string(names_.size()) + " fields, found " +
           std::to_string(fields.size()));
    for (std::size_t i = 0; i < fields.size(); ++i)
      columns_[i].push_back(number(fields[i], names_[i]));
  }

  double number(std::string_view field, const std::string& name) const {
    const auto value = read_number(std::string(field));
    if (!value || !std::isfinite(*value))
      fail(name + " = \"" + std::string(field) + "\": must be a finite number");
    return *value;
  }

  std::string path_;
  std::ifstream file_;
  std::string text_;
  std::string_view line_;  ///< the part of text_ that counts
  std::size_t number_ = 0;
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
    throw InputError(source_ + ": no column \"" + name + "\" among " + joined(names_, ", "));
  return columns_[static_cast<std::size_t>(found - names_.begin())];
}

Table read_csv(const std::filesystem::path& path) {
  return CsvReader(path).read();
}

Table read_csv(const std::filesystem::path& path, const std::vector<std::string>& columns) {
  Table table = read_csv(path);
  for (const std::string& name : table.names())
    if (std::find(columns.begin(), columns.end(), name) == columns.end())
      throw InputError(path.string() + ": column \"" + name + "\": must be one of " +
                       joined(columns, ", "));
  for (const std::string& name : table.names())
    for (double value : table.column(name))
      if (std::abs(value) > most_input)
        throw InputError(path.string() + ", " + name, value, "must be from -1e50 to 1e50");
  return table;
}

}  // namespace flatspeckle
