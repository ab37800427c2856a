#include <algorithm>
#include <compare>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

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

/// Returns the prefixes of dataset names in all groups that may contain datasets: the root, the
/// groups of the methods and those of the sensors.
std::vector<std::string> groups_of(const ResultReader& file) {
  std::vector<std::string> groups{"", "mc/", "wave/", "transport/"};
  for (const std::string& sensor : file.members("sensors"))
    groups.push_back("sensors/" + sensor + '/');
  return groups;
}

/// Plot script in plots/, the datasets that it requires, and one that the file must not contain.
struct Drawing {
  std::string script;
  std::vector<std::string> required;
  std::string excluded = {};
};

/// Returns the plot scripts; those that draw several kinds of results have an entry for each.
std::vector<Drawing> all_drawings() {
  return {{"camera_field", {"camera_x", "field"}},
          {"camera_intensity", {"camera_x", "intensity"}},
          {"contrast", {"squared_contrast"}},
          {"contrast_map", {"contrast_map"}},
          {"confocal_scan", {"field", "light_x", "image_x"}},
          {"dws", {"delay", "field_correlation"}, "tilt_q"},
          {"focus_matrix", {"field", "light_x", "sensor_x"}},
          {"frequency", {"frequency_shift", "frequency_correlation"}},
          {"matrix", {"eigenvalue_count"}},
          {"scattering_matrix", {"scattering_matrix"}},
          {"depth_profile", {"map_transmittance"}},
          {"recovered_picture", {"agreement", "phased_picture"}},
          {"simulated_picture", {"recovered_picture", "true_picture"}},
          {"validation", {"deviation", "mc/intensity"}},
          {"validation", {"deviation", "mc/covariance"}},
          {"validation", {"intensity_ratio"}},
          {"memory_effect", {"tilt_q", "field_correlation"}, "shift"},
          {"memory_effect", {"tilt_q", "mc/field_correlation"}, "shift"},
          {"memory_effect", {"translation_range"}},
          {"memory_effect", {"mc/translation_range"}},
          {"tilt_shift", {"tilt_q", "shift", "field_correlation"}},
          {"tissue", {"distance_reflectance"}},
          {"tracked_motion", {"field", "delay", "image_x"}},
          {"sources", {"source_x", "singular_value"}, "source_picture"},
          {"image", {"camera_place", "frame"}},
          {"fit", {"estimate"}},
          {"fit_plan", {"patterns_to_percent"}},
          {"fit_plan", {"point_patterns_to_percent"}},
          {"rays", {"path/z"}},
          {"spot", {"image/ray"}},
          {"light_map", {"map/fluence"}},
          {"design", {"ball_spline"}},
          {"design", {"radial_spline"}},
          {"design", {"graded_spline"}},
          {"design", {"history/rms"}},
          {"field_map", {"total_field"}}};
}

bool can_draw(const Drawing& drawing, const ResultReader& file) {
  return std::ranges::all_of(drawing.required, [&](const auto& name) { return file.has(name); }) &&
         (drawing.excluded.empty() || !file.has(drawing.excluded));
}

/// Returns an attribute of the root as text; empty if the file does not contain it.
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
            << (converged ? "target reached"
                          : "stopped before the target error was reached, or interrupted: continue "
                            "with --resume")
            << "\n\n";
}

/// Prints the properties of each layer of a medium of layers.
void print_layers(const ResultReader& file) {
  if (!file.has("layer")) return;
  const auto values = [&](const char* name) { return file.dataset<double>(name); };
  const auto thickness = values("layer_thickness"), depth = values("layer_optical_depth"),
             g = values("layer_g"), albedo = values("layer_albedo"), index = values("layer_index");
  std::printf("  %-5s %12s %13s %8s %8s %8s %12s\n", "layer", "thickness", "optical depth", "g",
              "albedo", "index", "l*");
  for (std::size_t i = 0; i < thickness.size(); ++i) {
    std::printf("  %-5zu %12.6g %13.6g %8.5g %8.5g %8.5g", i, thickness[i], depth[i], g[i],
                albedo[i], index[i]);
    const double losses = depth[i] * (1 - g[i] * albedo[i]);
    losses > 1e-9 ? std::printf(" %12.6g\n", thickness[i] / losses) : std::printf(" %12s\n", "-");
  }
}

void print_medium(const ResultReader& file) {
  const char* title =
      file.has("layer") ? "Medium: means over the depth of all layers; medium_index and wavelength "
                          "are those of the first layer\n"
                        : "Medium\n";
  for (const AttributeRow& row : scene_table.attributes) {
    const std::string value = row.object.empty() ? attribute_text(file, row) : "";
    if (value.empty()) continue;
    std::cout << title << "  " << row.name << " = " << value << ": " << row.meaning << '\n';
    title = "";
  }
  std::cout << std::flush;
  print_layers(file);
  if (*title == '\0') std::cout << '\n';
}

/// Returns the shape of a dataset as text, such as "3 x 2", or "one number" for a scalar.
std::string shape_text(const std::vector<std::size_t>& shape) {
  std::vector<std::string> sizes;
  for (const std::size_t size : shape) sizes.push_back(std::to_string(size));
  return sizes.empty() ? "one number" : join_texts(sizes, " x ");
}

void print_row(const ResultReader& file, const std::string& path, const DatasetRow& row) {
  std::cout << "  " << path << " (" << shape_text(file.shape(path))
            << "): " << file.attribute<std::string>(path, "long_name");
  if (has_error(row.data)) std::cout << "; with " << path << "_error";
  if (row.data == Data::invariant) std::cout << "; with " << path << "_limit";
  std::cout << '\n';
}

/// Prints the axes of a sweep over the keys of a subcommand. Their names are taken from the scene,
/// where they stand before '=' in quoted texts; '.' is replaced by '_', so that sensor_at.2 has the
/// axis sensor_at_2.
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

/// Prints all datasets of the file, each once although several tables may define its name. The
/// printed description is the one in the file.
void print_datasets(const ResultReader& file) {
  std::cout << "Datasets\n";
  print_swept(file);
  const auto groups = groups_of(file);
  std::set<std::string> printed;
  for (const DatasetTable* table : all_tables())
    for (const DatasetRow& row : table->rows)
      for (const std::string& group : groups) {
        const std::string path = group + row.path;
        if (!path.starts_with("state") && file.has_attribute(path, "long_name") &&
            printed.insert(path).second)
          print_row(file, path, row);
      }
}

// Prints the command that plots the result of a search (optimise) or of a sweep of a subcommand.
void print_map(const ResultReader& file) {
  const std::string name = file.path().string();
  if (file.has("search"))
    std::cout << "\nTo plot it\n  plots/optimisation.py " << name << '\n';
  else
    std::cout << "\nTo plot it\n  plots/experiment_map.py " << name
              << " --value NAME, where NAME is a dataset of the file, over the swept keys\n";
}

/// A plot script and the flags that follow the name of the result.
struct PlotCommand {
  std::string script, flags = {};

  auto operator<=>(const PlotCommand&) const = default;
};

/// Adds the plot scripts for results of `render`: images, and profiles over rings, with more than
/// one pixel; pulses of named sensors, with the flag that names the sensor.
void note_pictures(const ResultReader& file, const std::string& group,
                   std::vector<PlotCommand>& scripts) {
  const std::string sensors = "sensors/", image = group + "image";
  if (group.starts_with(sensors) && file.has(group + "pulse"))
    scripts.push_back(
        {"render_time",
         " --sensor " + group.substr(sensors.size(), group.size() - sensors.size() - 1)});
  if (!file.has_attribute(image, "long_name")) return;
  const auto shape = file.shape(image);
  if (shape.size() == 1 && shape[0] > 1) scripts.push_back({"ring_profile"});
  if (shape.size() == 2 && shape[0] * shape[1] > 1) scripts.push_back({"render"});
}

/// Adds the plot script for results of `field` with more than one detection direction.
void note_fields(const ResultReader& file, std::vector<PlotCommand>& scripts) {
  if (!file.has("field")) return;
  const auto shape = file.shape("field");
  if (shape.size() == 3 && shape[2] > 1) scripts.push_back({"speckle_field"});
}

std::vector<PlotCommand> scripts_for(const ResultReader& file) {
  std::vector<PlotCommand> scripts;
  for (const Drawing& drawing : all_drawings())
    if (can_draw(drawing, file)) scripts.push_back({drawing.script});
  note_fields(file, scripts);
  for (const std::string& group : groups_of(file)) note_pictures(file, group, scripts);
  return scripts;
}

void print_drawings(const ResultReader& file) {
  if (file.has_attribute("/", "of")) return print_map(file);
  const char* title = "\nTo plot it\n";
  std::set<PlotCommand> printed;
  for (const PlotCommand& plot : scripts_for(file)) {
    if (!printed.insert(plot).second) continue;
    std::cout << title << "  plots/" << plot.script << ".py " << file.path().string() << plot.flags
              << '\n';
    title = "";
  }
  if (printed.empty()) std::cout << "\nNo plot script draws this file.\n";
}

void print_all(const std::string& path) {
  const ResultReader file(path);
  if (!file.has_attribute("/", "program") || !file.has_attribute("/", "converged"))
    throw InputError("explain", path, "must be a result of flatspeckle");
  print_run(file);
  if (file.has_attribute("/", "complete") && !file.attribute<bool>("/", "complete")) {
    std::cout
        << "The file only contains sums, since the run was interrupted. The same command with "
           "--resume\ncontinues it; with --samples "
        << number_text(file.attribute<double>("/", "samples"))
        << " as well, it writes the results of what is done.\n";
    return;
  }
  print_medium(file);
  print_datasets(file);
  print_drawings(file);
}

int explain_file(const Subcommand&, Words& values) {
  const std::string path = values.text();
  if (path.empty()) throw InputError("explain: must have exactly one result file");
  if (!std::filesystem::exists(path)) throw InputError("explain", path, "no such file");
  read_in_child(path, [&] { const ResultReader file(path); });
  print_all(path);
  return ExitStatus::done;
}

}  // namespace

std::unique_ptr<Call> explain(const std::string&) {
  return call_with<Words>("explain", "Describes a result file: explain FILE.h5", explain_file);
}

}  // namespace flatspeckle::apps
