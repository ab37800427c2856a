#include <map>

#include "apps/sweep/curve_sweep.h"
#include "core/keys/csv.h"
#include "flatland/placement/placement.h"
#include "flatland/request/request.h"
#include "grin/media/fields/scene_field.h"
#include "grin/rays/marching/ray_starts.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/targets.h"

// Tables. The first line, a comment, names the kind of table: "# disks".

namespace flatspeckle::fuzz_table {

namespace {

using namespace flatspeckle::apps;

const char* const path = "table.csv";

void check_placement(const Scatterer& scatterer) {
  for (const auto& [position, placed] : read_placement(path, scatterer)) {
    fuzz::require_finite(position.x + position.z);
    fuzz::require_finite(placed.radius + std::abs(placed.index));
  }
}

void check_sweep(const std::string& config) {
  CurveSweep sweep;
  sweep.parse_config(config + "points = \"table.csv\"\ntilts = [0, 0.01]\n");
  for (std::size_t run = 0; run < sweep.runs(); ++run) {
    const BulkMedium medium = sweep.scene(run).medium;
    for (double number : {medium.mu_s, medium.mu_t, medium.g, medium.albedo})
      fuzz::require_finite(number);
  }
}

void check_rays() {
  grin::RayStartValues values;
  values.rays = path;
  const Keyed<grin::RayStartValues> keyed(values);
  for (const grin::RayStart& ray : make_ray_starts(keyed.keys, keyed.values))
    fuzz::require_finite(ray.direction.norm());
}

void check_blobs() {
  grin::IndexFieldValues values;
  values.field = {"blobs"};
  values.of<grin::BlobsValues>().blobs = path;
  const Keyed<grin::IndexFieldValues> keyed(values);
  const grin::SceneField scene = make_scene_field(keyed.keys, keyed.values, {10});
  fuzz::require_finite(scene.scale);
  fuzz::require_finite(index_at(scene, {0.1, 0.2, 0.3}));
}

void read_table(const std::string& word) {
  static const std::map<std::string, void (*)()> readers = {
      {"points", [] { check_placement({}); }},
      {"disks", [] { check_placement({.kind = Scatterer::Kind::tm, .radius = 0.1}); }},
      {"sensors", [] { read_points("near_sensors", path); }},
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

void use_input(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  fuzz::write_file(path, text);
  fuzz::taken(fuzz::first_line(text), read_table);
}

}  // namespace flatspeckle::fuzz_table
