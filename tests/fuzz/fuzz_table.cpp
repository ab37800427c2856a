#include <map>

#include "apps/index_field_options.h"
#include "apps/ray_starts.h"
#include "apps/scene_field.h"
#include "apps/sweep_plan.h"
#include "core/keys/csv.h"
#include "flatland/placement/placement.h"
#include "flatland/request/sensor.h"
#include "tests/fuzz/input.h"

// Tables. The first line, a comment, says what they hold: "# disks".

namespace {

using namespace flatspeckle;
using namespace flatspeckle::apps;

const char* const path = "table.csv";

void check_placement(const Scatterer& scatterer) {
  for (const auto& [position, placed] : read_placement(path, scatterer)) {
    fuzz::require_finite(position.x + position.z);
    fuzz::require_finite(placed.radius + std::abs(placed.index));
  }
}

void check_sweep(const std::string& config) {
  const SweepPlan plan = sweep_plan_of(config + "points = \"table.csv\"\ntilts = [0, 0.01]\n");
  for (std::size_t run = 0; run < plan.runs(); ++run) {
    const BulkMedium medium = plan.scene(run).medium;
    for (double number : {medium.mu_s, medium.mu_t, medium.g, medium.albedo})
      fuzz::require_finite(number);
  }
}

void check_rays() {
  Subcommand command("trace", "");
  RayStartSpec spec;
  add_ray_start_options(command.options(), spec);
  command.parse_config("rays = \"table.csv\"\n");
  for (const RayStart& ray : make_ray_starts(command, spec))
    fuzz::require_finite(ray.direction.norm());
}

void check_blobs() {
  Subcommand command("trace", "");
  IndexFieldSpec spec;
  add_index_field_options(command.options(), spec);
  command.parse_config("field = [\"blobs\"]\nblobs = \"table.csv\"\n");
  const SceneField scene = make_index_field(command, spec, 10);
  fuzz::require_finite(scene.scale);
  fuzz::require_finite(index_at(scene, {0.1, 0.2, 0.3}));
}

void read_table(const std::string& word) {
  static const std::map<std::string, void (*)()> readers = {
      {"points", [] { check_placement({}); }},
      {"disks", [] { check_placement({.kind = Scatterer::Kind::tm, .radius = 0.1}); }},
      {"sensors", [] { read_points(path); }},
      {"sweep", [] { check_sweep("scatterer = \"hg\"\ndepth = 10\n"); }},
      {"sweep_disks", [] { check_sweep("scatterer = \"tm\"\ndepth = 10\nmethod = \"mc\"\n"); }},
      {"rays", check_rays},
      {"blobs", check_blobs}};
  const auto reader = readers.find(word);
  if (reader == readers.end())
    read_csv(path);
  else
    reader->second();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const fuzz::Folder folder;
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  fuzz::write_file(path, text);
  fuzz::taken(fuzz::first_line(text), read_table);
  return 0;
}
