#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/command/subcommands.h"
#include "apps/results/exported_file.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"

namespace flatspeckle::apps {

namespace {

/// CsvColumn of the table: the text of the value in each row.
struct CsvColumn {
  std::string name, unit;
  std::function<std::string(std::size_t row)> text;
};

std::size_t number_of_values(const std::vector<std::size_t>& shape) {
  std::size_t product = 1;
  for (const std::size_t extent : shape) product *= extent;
  return product;
}

std::string csv_number(double value) {
  return std::isnan(value) ? "NaN" : number_text(value);
}

/// Returns a text as a field of CSV, in quotation marks if it contains special characters.
std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n\r#") == text.npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + '"';
}

std::string unit_in(const ResultReader& file, const std::string& name) {
  return file.has_attribute(name, "units") ? file.attribute<std::string>(name, "units") : "";
}

CsvColumn column_of(std::string name, std::string unit, std::vector<double> values) {
  return {std::move(name), std::move(unit),
          [values = std::move(values)](std::size_t row) { return csv_number(values[row]); }};
}

/// Returns the names of the datasets that can be exported: all but the state of a run.
std::vector<std::string> names_in(const ResultReader& file) {
  auto names = file.datasets();
  std::erase_if(names, [](const std::string& name) { return name.starts_with("state/"); });
  return names;
}

/// Returns, for each value of a range, 0 if it is known, 1 if it is a lower bound, 2 if it is an
/// upper bound (docs/format.md, `censored`); nullopt for datasets that are no ranges.
std::optional<std::vector<double>> censoring(const ResultReader& file, const std::string& name) {
  const std::size_t slash = name.rfind('/') + 1;
  if (file.has_attribute(name, "censored"))
    return std::vector(number_of_values(file.shape(name)),
                       static_cast<double>(file.attribute<std::uint64_t>(name, "censored")));
  if (file.has(name + "_censored")) return file.dataset<double>(name + "_censored");
  const std::string of_curves = name.substr(0, slash) + "range_censored";
  if (name.substr(slash) == "memory_effect_range" && file.has(of_curves))
    return file.dataset<double>(of_curves);
  return std::nullopt;
}

/// Columns of one table, whose rows are the elements of datasets with common axes, in row-major
/// order: the axes, then the values of each dataset.
class ExportTable {
 public:
  /// Throws InputError if the file has no such datasets, or if they have different axes.
  ExportTable(const ResultReader& file, const std::vector<std::string>& names)
      : file_(file), names_(names), shape_(file.shape(names.front())) {
    add_axes();
    for (const std::string& name : names) {
      if (file.shape(name) != shape_ || file.axes(name) != file.axes(names.front()))
        throw InputError("export", name,
                         "must have the axes of " + names.front() +
                             "; export datasets with other axes in a separate call");
      add(name);
    }
  }

  void write(std::ostream& out) const {
    // names come first, since NumPy takes them from the first line
    write_row(out, [](const CsvColumn& column) { return csv_text(column.name); });
    const char* between = "# units: ";
    for (const CsvColumn& column : columns_) {
      if (column.unit.empty()) continue;
      out << between << column.name << " [" << column.unit << ']';
      between = ", ";
    }
    if (*between == ',') out << '\n';
    for (std::size_t row = 0; row < number_of_values(shape_) && out; ++row)
      write_row(out, [row](const CsvColumn& column) { return column.text(row); });
  }

 private:
  template <typename Text>
  void write_row(std::ostream& out, const Text& text) const {
    for (std::size_t i = 0; i < columns_.size(); ++i)
      out << (i > 0 ? "," : "") << text(columns_[i]);
    out << '\n';
  }

  /// Adds a column for each axis: the values of its scale, or the index if it has none.
  void add_axes() {
    const auto scales = file_.axes(names_.front());
    std::size_t after =
        number_of_values(shape_);  // number of elements for each index along the axis
    for (std::size_t axis = 0; axis < shape_.size(); ++axis) {
      const std::size_t extent = shape_[axis];
      if (extent > 0) after /= extent;
      const std::string& scale = scales[axis];
      std::vector<double> values;
      if (!scale.empty()) values = file_.dataset<double>(scale);
      for (std::size_t i = values.size(); i < extent; ++i) values.push_back(static_cast<double>(i));
      columns_.push_back({scale.empty() ? names_.front() + '.' + std::to_string(axis) : scale,
                          scale.empty() ? "" : unit_in(file_, scale),
                          [values, after, extent](std::size_t row) {
                            return csv_number(values[row / after % extent]);
                          }});
    }
  }

  void add(const std::string& name) {
    switch (file_.stored_values(name)) {
      case StoredValues::complex:
        return add_complex(name);
      case StoredValues::text:
        return add_texts(name);
      case StoredValues::real:
        return add_reals(name);
    }
  }

  void add_complex(const std::string& name) {
    std::vector<double> real, imaginary;
    for (const Complex value : file_.dataset<Complex>(name)) {
      real.push_back(value.real());
      imaginary.push_back(value.imag());
    }
    const std::string unit = unit_in(file_, name);
    columns_.push_back(column_of(name + "_re", unit, std::move(real)));
    columns_.push_back(column_of(name + "_im", unit, std::move(imaginary)));
    add_error(name, {});
  }

  void add_texts(const std::string& name) {
    columns_.push_back({name, "", [texts = file_.dataset<std::string>(name)](std::size_t row) {
                          return csv_text(texts[row]);
                        }});
  }

  /// Adds the values and errors; for a range also columns of its bounds. Where only a bound is
  /// known, value and error are NaN.
  void add_reals(const std::string& name) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    auto values = file_.dataset<double>(name);
    const std::string unit = unit_in(file_, name);
    const auto marks = censoring(file_, name);
    if (!marks || marks->size() != values.size()) {
      columns_.push_back(column_of(name, unit, std::move(values)));
      return add_error(name, {});
    }
    std::vector<double> lower(values.size(), none), upper(values.size(), none);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if ((*marks)[i] == 1) lower[i] = std::exchange(values[i], none);
      if ((*marks)[i] == 2) upper[i] = std::exchange(values[i], none);
    }
    columns_.push_back(column_of(name, unit, std::move(values)));
    add_error(name, *marks);
    columns_.push_back(column_of(name + "_at_least", unit, std::move(lower)));
    columns_.push_back(column_of(name + "_at_most", unit, std::move(upper)));
  }

  /// Adds the standard errors if the file has any. marks: as from censoring(), or empty.
  void add_error(const std::string& name, const std::vector<double>& marks) {
    const std::string path = name + "_error";
    if (!file_.has(path) || file_.shape(path) != shape_) return;
    auto errors = file_.dataset<double>(path);
    for (std::size_t i = 0; i < marks.size(); ++i)
      if (marks[i] > 0) errors[i] = std::numeric_limits<double>::quiet_NaN();
    columns_.push_back(column_of(path, unit_in(file_, path), std::move(errors)));
  }

  const ResultReader& file_;
  const std::vector<std::string>& names_;
  std::vector<std::size_t> shape_;
  std::vector<CsvColumn> columns_;
};

/// Returns the table of these datasets of a file. Throws InputError for unknown names; the message
/// lists the names of the file.
ExportTable table_of(const ResultReader& file, const std::vector<std::string>& names) {
  const auto known = names_in(file);
  const std::string all = join_texts(known, " ");
  if (known.empty())
    throw InputError("export", file.path().string(),
                     "contains no results: its run was interrupted; continue it with --resume");
  if (names.empty())
    throw InputError("export: must have names of datasets after the file, which has " + all);
  for (const std::string& name : names)
    if (std::ranges::count(known, name) == 0)
      throw InputError("export", name, "must be one of " + all);
  return {file, names};
}

struct ExportValues {
  std::vector<std::string> words;
  std::string to{};
  ExportFormat format{65, {}};
};

void add_keys(Keys& keys, ExportValues& values) {
  keys.add("to", values.to,
           "File to write instead of CSV; its ending is the format. .npy: numbers of one dataset; "
           ".pfm or .exr (OpenEXR, channel Y): a picture, 32-bit floats; .png: a picture for "
           "display, or with --linear for other programs; .tif: a picture or several frames, "
           "32-bit floats, which recover and other programs read; .vtk or .npy of "
           "ball_spline, radial_spline or excess: the index of a designed field");
  keys.add("select", values.format.select,
           "Elements of the dataset to write, such as realization=0 delay=2: an index, from 0, for "
           "each axis that the file leaves out. Pictures of a complex dataset have its squared "
           "magnitude")
      .only_of("to");
  keys.add("linear", values.format.linear,
           "PNG of 16 bits for other programs, instead of one for display: counts are proportional "
           "to the values, the largest is 65535, and rows are in the order of the file")
      .only_of("to");
  keys.add("nodes", values.format.nodes,
           "Number of points along each axis at which the index of a designed field is written")
      .from(2, 1025)
      .only_of("to");
}

/// Writes one dataset to the file that the key `to` names.
int export_to_file(const Subcommand& command, const ExportValues& values, const std::string& result,
                   const std::vector<std::string>& names) {
  const Keys& keys = command.keys();
  const std::string& to = keys.read(values.to);
  if (names.size() != 1) throw InputError("to", to, "requires the name of one dataset");
  if (is_designed_field(names.front()))
    keys.read(values.format.nodes);
  else
    keys.read(values.format.select);
  if (std::filesystem::path(to).extension() == ".png") keys.read(values.format.linear);
  if (!command.settle()) return ExitStatus::done;
  std::puts(export_file(result, names.front(), to, values.format).c_str());
  return ExitStatus::done;
}

int export_datasets(const Subcommand& command, ExportValues& values) {
  if (values.words.empty()) throw InputError("export: must have a result file and its datasets");
  const std::string& path = values.words.front();
  const std::vector<std::string> names(values.words.begin() + 1, values.words.end());
  if (!std::filesystem::exists(path)) throw InputError("export", path, "no such file");
  read_in_child(path, [&] { table_of(ResultReader(path), names); });
  if (!values.to.empty()) return export_to_file(command, values, path, names);
  if (!command.settle()) return ExitStatus::done;
  const ResultReader file(path);
  table_of(file, names).write(std::cout);
  return ExitStatus::done;
}

}  // namespace

std::unique_ptr<Call> export_csv(const std::string&) {
  return call_with<ExportValues>("export",
                                 "Prints datasets of a result file as CSV: export FILE.h5 DATASET "
                                 "..., or writes one to a file",
                                 export_datasets);
}

}  // namespace flatspeckle::apps
