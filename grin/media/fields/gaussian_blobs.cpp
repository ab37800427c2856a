#include "grin/media/fields/gaussian_blobs.h"

#include <algorithm>
#include <limits>

#include "core/keys/csv.h"

namespace flatspeckle::grin {

FieldFacts facts(const GaussianBlobs& field) {
  constexpr std::size_t most_places = 16;
  double scale = std::numeric_limits<double>::infinity(), strength = 0;
  for (const GaussianBlob& blob : field.blobs()) {
    scale = std::min(scale, blob.width);
    strength += std::abs(blob.height);
  }
  std::vector<GaussianBlob> steepest = field.blobs();
  const auto bend = [](const GaussianBlob& b) { return std::abs(b.height) / (b.width * b.width); };
  std::sort(steepest.begin(), steepest.end(),
            [&](const GaussianBlob& a, const GaussianBlob& b) { return bend(a) > bend(b); });
  steepest.resize(std::min(steepest.size(), most_places));
  FieldFacts found{.scale = scale, .strength = strength};
  for (const GaussianBlob& blob : steepest)
    found.places.push_back(blob.centre + blob.width * Vec3::Ones().normalized());
  return found;
}

void add_keys(Keys& keys, BlobsValues& values) {
  add_index_key(keys, values.index, "around the blobs");
  keys.add("blobs", values.blobs,
           "CSV with columns x, y, z, height, width: each blob adds height exp(-r^2/(2 width^2)) "
           "to the index")
      .file();
}

GaussianBlobs make_field(const Keys& keys, const BlobsValues& values, const FieldUse& use) {
  const Table table =
      read_key_table("blobs", keys.required(values.blobs), {"x", "y", "z", "height", "width"});
  const auto x = table.column("x"), y = table.column("y"), z = table.column("z");
  const auto height = table.column("height"), width = table.column("width");
  std::vector<GaussianBlob> blobs;
  for (std::size_t i = 0; i < table.rows(); ++i)
    blobs.push_back({{x[i], y[i], z[i]}, height[i], positive(values.blobs + ", width", width[i])});
  return GaussianBlobs(std::move(blobs), background(keys, values.index, use));
}

}  // namespace flatspeckle::grin
