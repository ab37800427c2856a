#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>

#include "apps/command/subcommands.h"
#include "apps/results/datasets.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/guarded_read.h"
#include "core/result/provenance.h"
#include "core/result/result_reader.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::apps {

namespace {

/// Where several methods or sensors tell the same, each has a group.
std::vector<std::string> groups_of(const ResultReader& file) {
  std::vector<std::string> groups{"", "mc/", "wave/", "transport/"};
  for (const std::string& sensor : file.members("sensors"))
    groups.push_back("sensors/" + sensor + '/');
  return groups;
}

/// A script of plots/ and the dataset that it draws, of all that have it.
struct Drawing {
  const char *dataset, *script;
};

constexpr Drawing drawings[] = {{"squared_contrast", "contrast"},
                                {"delay", "dws"},
                                {"frequency_shift", "frequency"},
                                {"deviation", "validation"},
                                {"intensity_ratio", "validation"},
                                {"tilt_q", "memory_effect"},
                                {"field", "speckle_field"},
                                {"source_x", "sources"},
                                {"frame", "image"},
                                {"parameter_name", "fit"},
                                {"path/z", "rays"},
                                {"image/ray", "spot"},
                                {"map/fluence", "light_map"},
                                {"ball_spline", "design"},
                                {"radial_spline", "design"},
                                {"graded_spline", "design"},
                                {"history/rms", "design"},
                                {"total_field", "field_map"}};

/// As text, whatever its type; empty where there is none.
std::string attribute_text(const ResultReader& file, const AttributeRow& row) {
  if (!file.has_attribute("/", row.name)) return "";
  if (row.type == "float64") return number_text(file.attribute<double>("/", row.name));
  if (row.type == "uint64") return std::to_string(file.attribute<std::uint64_t>("/", row.name));
  return row.type == "text" ? file.attribute<std::string>("/", row.name) : "";
}

void print_run(const ResultReader& file) {
  const auto text = [&](const char* name) { return file.attribute<std::string>("/", name); };
  std::cout << file.path().string() << "\n  made by flatspeckle " << text("version") << " on "
            << text("started") << ":\n  " << text("command_line") << '\n';
  const bool converged = file.attribute<bool>("/", "converged");
  std::cout << "  " << number_text(file.attribute<double>("/", "samples")) << " samples in "
            << number_text(file.attribute<double>("/", "wall_s")) << " s; "
            << (converged ? "ended as it was asked to"
                          : "stopped before its target error, or interrupted: --resume goes on")
            << "\n\n";
}

void print_medium(const ResultReader& file) {
  const char* title = "Medium\n";
  for (const AttributeRow& row : scene_table.attributes) {
    const std::string value = row.object.empty() ? attribute_text(file, row) : "";
    if (value.empty()) continue;
    std::cout << title << "  " << row.name << " = " << value << ": " << row.meaning << '\n';
    title = "";
  }
  if (*title == '\0') std::cout << '\n';
}

/// "3 x 2", of a number "one number".
std::string shape_text(const std::vector<std::size_t>& shape) {
  std::vector<std::string> sizes;
  for (const std::size_t size : shape) sizes.push_back(std::to_string(size));
  return sizes.empty() ? "one number" : joined(sizes, " x ");
}

void print_row(const ResultReader& file, const std::string& path, const DatasetRow& row) {
  std::cout << "  " << path << " (" << shape_text(file.shape(path))
            << "): " << file.attribute<std::string>(path, "long_name");
  if (has_error(row.data)) std::cout << "; with " << path << "_error";
  if (row.data == Data::invariant) std::cout << "; with " << path << "_limit";
  std::cout << '\n';
}

/// Axes of what a sweep of a subcommand varied, key=values in its scene: sensor_at.2 as
/// sensor_at_2.
void print_swept(const ResultReader& file) {
  if (!file.has_attribute("/", "of")) return;
  const auto config = file.attribute<std::string>("/", "config");
  for (std::size_t at = 0; (at = config.find('"', at)) != std::string::npos; ++at) {
    const std::size_t equals = config.find_first_of("=\"/", at + 1);
    std::string name = config.substr(at + 1, equals - at - 1);
    std::replace(name.begin(), name.end(), '.', '_');
    if (equals != std::string::npos && config[equals] == '=' &&
        file.has_attribute(name, "long_name"))
      std::cout << "  " << name << " (" << shape_text(file.shape(name))
                << "): " << file.attribute<std::string>(name, "long_name") << "; swept\n";
  }
}

/// Rows of several tables may share a name; what it is here the file itself says.
void print_datasets(const ResultReader& file) {
  std::cout << "Holds\n";
  print_swept(file);
  const auto groups = groups_of(file);
  std::set<std::string> told;
  for (const DatasetTable* table : all_tables())
    for (const DatasetRow& row : table->rows)
      for (const std::string& group : groups) {
        const std::string path = group + row.path;
        if (!path.starts_with("state") && file.has_attribute(path, "long_name") &&
            told.insert(path).second)
          print_row(file, path, row);
      }
}

// Of sweeps of a subcommand and of searches in one: numbers of many of its results.
void print_map(const ResultReader& file) {
  const std::string name = file.path().string();
  if (file.has("search"))
    std::cout << "\nTo draw it\n  plots/optimisation.py " << name << '\n';
  else
    std::cout << "\nTo draw it\n  plots/experiment_map.py " << name
              << " --value NAME, one that it holds, over the keys that were swept\n";
}

/// Of render: pictures and rings of several pixels.
void note_pictures(const ResultReader& file, const std::string& group,
                   std::vector<std::string>& scripts) {
  const std::string image = group + "image";
  if (!file.has_attribute(image, "long_name")) return;
  const auto shape = file.shape(image);
  if (shape.size() == 1 && shape[0] > 1) scripts.push_back("ring_profile");
  if (shape.size() == 2 && shape[0] * shape[1] > 1) scripts.push_back("render");
}

std::vector<std::string> scripts_for(const ResultReader& file) {
  const auto groups = groups_of(file);
  std::vector<std::string> scripts;
  for (const Drawing& drawing : drawings)
    if (std::ranges::any_of(groups,
                            [&](const auto& group) { return file.has(group + drawing.dataset); }))
      scripts.push_back(drawing.script);
  for (const std::string& group : groups) note_pictures(file, group, scripts);
  return scripts;
}

void print_drawings(const ResultReader& file) {
  if (file.has_attribute("/", "of")) return print_map(file);
  const char* title = "\nTo draw it\n";
  std::set<std::string> told;
  for (const std::string& script : scripts_for(file)) {
    if (!told.insert(script).second) continue;
    std::cout << title << "  plots/" << script << ".py " << file.path().string() << '\n';
    title = "";
  }
}

void print_all(const std::string& path) {
  const ResultReader file(path);
  if (!file.has_attribute("/", "program") || !file.has_attribute("/", "converged"))
    throw InputError("explain", path, "must be a result of flatspeckle");
  print_run(file);
  print_medium(file);
  print_datasets(file);
  print_drawings(file);
}

int explain_file(const Subcommand&, OneWord& values) {
  const std::string& path = values.word;
  if (path.empty()) throw InputError("explain: must have one result file, and no more");
  if (!std::filesystem::exists(path)) throw InputError("explain", path, "no such file");
  read_in_child(path, [&] { const ResultReader file(path); });
  print_all(path);
  return ExitStatus::done;
}

}  // namespace

std::unique_ptr<Call> explain(const std::string&) {
  return call_with<OneWord>("explain", "What a result holds, in words: explain FILE.h5",
                            explain_file);
}

}  // namespace flatspeckle::apps
