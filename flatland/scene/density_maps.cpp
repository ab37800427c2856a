#include "flatland/scene/density_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "flatland/media/density_map.h"

namespace flatspeckle {

namespace {

/// A Gaussian of the relative density, amplitude exp(-r^2 / (2 radius^2)); a hole where the
/// amplitude is negative.
struct Blob {
  Vec2 centre;
  double radius = 1, amplitude = 0;
};

/// int exp(-(t - middle)^2 / (2 radius^2)) dt
double gaussian_between(double from, double to, double middle, double radius) {
  const double scale = 1 / (std::numbers::sqrt2 * radius);
  return std::sqrt(std::numbers::pi / 2) * radius *
         (std::erf((to - middle) * scale) - std::erf((from - middle) * scale));
}

/// Relative density 1 and Gaussian blobs. What a way meets is in closed form.
class Blobs : public DensityMap {
 public:
  /// The density must be positive everywhere: negative amplitudes add up to -1 at the most.
  Blobs(Domain box, Material material, std::vector<Blob> blobs)
      : DensityMap(box, std::move(material)), blobs_(std::move(blobs)) {}

  double relative_density(Vec2 x) const override {
    double density = 1;
    for (const auto& [centre, radius, amplitude] : blobs_) {
      const Vec2 from = x - centre;
      density += amplitude * std::exp(-dot(from, from) / (2 * radius * radius));
    }
    return std::max(0.0, density);  // what rounding leaves of a hole
  }

  std::string describe() const override {
    return "density of " + std::to_string(blobs_.size()) + " blobs";
  }

 private:
  double met(Vec2 x, Vec2 w, double length) const override {
    double sum = length;
    for (const auto& [centre, radius, amplitude] : blobs_) {
      const Vec2 way = centre - x;
      const double along = dot(way, w), across = way.x * w.z - way.z * w.x;
      sum += amplitude * std::exp(-across * across / (2 * radius * radius)) *
             gaussian_between(0, length, along, radius);
    }
    return std::max(0.0, sum);
  }

  double most_relative() const override {
    double most = 1;
    for (const Blob& blob : blobs_) most += std::max(0.0, blob.amplitude);
    return most;
  }

  double mean_relative() const override {
    double sum = 0;
    for (const auto& [centre, radius, amplitude] : blobs_)
      sum += amplitude * gaussian_between(-box().width / 2, box().width / 2, centre.x, radius) *
             gaussian_between(0, box().depth, centre.z, radius);
    return 1 + sum / box().area();
  }

  std::vector<Blob> blobs_;
};

std::vector<Blob> read_blobs(const std::string& path) {
  const Table table = read_csv(path, {"x", "z", "radius", "amplitude"});
  std::vector<Blob> blobs;
  double holes = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto of = [&](const char* name) { return table.column(name)[row]; };
    blobs.push_back({{of("x"), of("z")}, of("radius"), of("amplitude")});
    if (!(blobs.back().radius > 0))
      throw InputError(path + ", radius", blobs.back().radius, "must be positive");
    holes += std::min(0.0, blobs.back().amplitude);
  }
  if (holes < -1)
    throw InputError(path + ", amplitude: those below 0 add up to", holes,
                     "must not be less than -1, for no density is negative");
  return blobs;
}

struct Cells {
  std::size_t rows = 0;
  std::vector<double> density;
};

Cells read_cells(const std::string& path) {
  const ResultReader file(path);
  if (!file.has("relative_density"))
    throw InputError("density_map", path, "has no dataset relative_density");
  const auto shape = file.shape("relative_density");
  if (shape.size() != 2 || shape[0] == 0 || shape[1] == 0)
    throw InputError("density_map", path, "relative_density must have two axes, z and x");
  Cells cells{shape[0], file.dataset<double>("relative_density")};
  const bool possible = std::ranges::all_of(
      cells.density, [](double value) { return value >= 0 && std::isfinite(value); });
  if (!possible || std::ranges::all_of(cells.density, [](double value) { return value == 0; }))
    throw InputError("density_map", path, "must hold finite numbers, none negative, not all 0");
  return cells;
}

void refuse_beside_map(const Keys& keys, const SceneSpec& spec, const std::string& key) {
  if (spec.domain == "slab") throw InputError(key + ": a density map needs a box");
  if (!spec.layers.empty()) throw InputError(key + ", layers: give one of them");
  if (spec.structure != "none") throw InputError(key + ", structure: give one of them");
  if (keys.given(spec.count))
    throw InputError(key + ", count: give the density where the map is 1");
}

}  // namespace

MakeDensityMap density_map(const Keys& keys, const SceneSpec& spec) {
  const std::string &blobs_path = keys.read(spec.density_blobs),
                    &cells_path = keys.read(spec.density_map);
  if (blobs_path.empty() && cells_path.empty()) return {};
  if (!blobs_path.empty() && !cells_path.empty())
    throw InputError("density_blobs, density_map: give one of them");
  refuse_beside_map(keys, spec, blobs_path.empty() ? "density_map" : "density_blobs");
  if (!blobs_path.empty())
    return [blobs = read_blobs(blobs_path)](const Domain& box, const Material& material) {
      return std::make_shared<const Blobs>(box, material, blobs);
    };
  return [cells = guarded_read(cells_path, [&] { return read_cells(cells_path); })](
             const Domain& box, const Material& material) {
    return std::make_shared<const CellDensity>(box, material, cells.rows, cells.density);
  };
}

}  // namespace flatspeckle
