#include "flatland/scene/density_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/result/guarded_read.h"
#include "core/result/result_group.h"
#include "core/result/result_reader.h"

namespace flatspeckle {

namespace {

/// Returns the index of the cell that contains a position, given in units of cells. The outermost
/// cells extend beyond the edges of the box.
std::ptrdiff_t cell_of(double position, std::size_t cells) {
  return std::clamp(static_cast<std::ptrdiff_t>(std::floor(position)), std::ptrdiff_t{0},
                    static_cast<std::ptrdiff_t>(cells) - 1);
}

/// Steps of a straight path through the cells of a grid along one axis.
struct Steps {
  std::ptrdiff_t cell, step, last;  ///< current cell; +1 or -1; last cell that the path can reach
  double next, between;  ///< path length from the start to the next cell; path length across a cell

  Steps(double position, double speed, std::size_t cells)
      : cell(cell_of(position, cells)),
        step(speed > 0 ? 1 : -1),
        last(speed > 0 ? static_cast<std::ptrdiff_t>(cells) - 1 : 0),
        between(1 / std::abs(speed)) {
    const double face = static_cast<double>(cell + (speed > 0 ? 1 : 0));
    next = cell == last || speed == 0 ? std::numeric_limits<double>::infinity()
                                      : (face - position) / speed;
  }

  void advance() {
    cell += step;
    next = cell == last ? std::numeric_limits<double>::infinity() : next + between;
  }
};

/// A Gaussian contribution to the relative density: amplitude exp(-r^2 / (2 radius^2)) at distance
/// r from the centre. It is a hole if the amplitude is negative.
struct Blob {
  Vec centre;
  double radius = 1, amplitude = 0;
};

/// Returns int exp(-(t - middle)^2 / (2 radius^2)) dt between `from` and `to`.
double gaussian_between(double from, double to, double middle, double radius) {
  const double scale = 1 / (std::numbers::sqrt2 * radius);
  return std::sqrt(std::numbers::pi / 2) * radius *
         (std::erf((to - middle) * scale) - std::erf((from - middle) * scale));
}

/// Relative density that is 1 plus a sum of Gaussian blobs. Its integral along a straight path has
/// a closed form.
class Blobs : public DensityMap {
 public:
  /// The sum of the negative amplitudes must be at least -1, so that the density is nowhere
  /// negative.
  Blobs(Domain box, Material material, std::vector<Blob> blobs)
      : DensityMap(box, std::move(material)), blobs_(std::move(blobs)) {}

  double relative_density(Vec x) const override {
    double density = 1;
    for (const auto& [centre, radius, amplitude] : blobs_) {
      const Vec from = x - centre;
      density += amplitude * std::exp(-dot(from, from) / (2 * radius * radius));
    }
    return std::max(0.0, density);  // rounding may make it negative in a hole
  }

  std::shared_ptr<const MediumProfile> with(std::vector<Material> materials) const override {
    return std::make_shared<const Blobs>(box(), std::move(materials.front()), blobs_);
  }

  std::string describe() const override {
    return "density with " + std::to_string(blobs_.size()) + " Gaussian blobs";
  }

 private:
  double met(Vec x, Vec w, double length) const override {
    double sum = length;
    for (const auto& [centre, radius, amplitude] : blobs_) {
      const Vec to_centre = centre - x;
      const double along = dot(to_centre, w);
      const Vec across = cross(to_centre, w);
      sum += amplitude * std::exp(-dot(across, across) / (2 * radius * radius)) *
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
             gaussian_between(0, box().depth, centre.z, radius) *
             (box().height > 0
                  ? gaussian_between(-box().height / 2, box().height / 2, centre.y, radius)
                  : 1);
    return 1 + sum / box().content();
  }

  std::vector<Blob> blobs_;
};

std::vector<Blob> read_blobs(const std::string& path, bool in_space) {
  std::vector<std::string> columns{"x", "z", "radius", "amplitude"};
  if (in_space) columns.emplace_back("y");
  const Table table = read_key_table("density_blobs", path, columns);
  std::vector<Blob> blobs;
  double holes = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto of = [&](const char* name) { return table.column(name)[row]; };
    blobs.push_back(
        {{of("x"), of("z"), table.has("y") ? of("y") : 0}, of("radius"), of("amplitude")});
    if (!(blobs.back().radius > 0))
      throw InputError(path + ", radius", blobs.back().radius, "must be positive");
    holes += std::min(0.0, blobs.back().amplitude);
  }
  if (holes < -1)
    throw InputError(path + ", sum of negative amplitudes", holes,
                     "must be at least -1, because a density cannot be negative");
  return blobs;
}

struct Cells {
  CellDensity::Counts counts;
  std::vector<double> density;
};

Cells read_cells(const std::string& path, bool in_space) {
  const ResultReader file(path);
  if (!file.has("relative_density"))
    throw InputError("density_map", path, "has no dataset relative_density");
  const auto shape = file.shape("relative_density");
  if (shape.size() != (in_space ? 3 : 2) || std::ranges::count(shape, 0) > 0)
    throw InputError("density_map", path,
                     std::string("relative_density must have ") +
                         (in_space ? "three axes, z, y and x" : "two axes, z and x"));
  Cells cells{{shape.back(), shape[0], in_space ? shape[1] : 1},
              file.dataset<double>("relative_density")};
  const bool possible = std::ranges::all_of(
      cells.density, [](double value) { return value >= 0 && std::isfinite(value); });
  if (!possible || std::ranges::all_of(cells.density, [](double value) { return value == 0; }))
    throw InputError("density_map", path,
                     "must contain finite, non-negative numbers that are not all 0");
  return cells;
}

void refuse_beside_map(const Keys& keys, const SceneSpec& spec, const std::string& key) {
  if (spec.domain == "slab") throw InputError(key + ": a density map requires domain = box");
  if (!spec.layers.empty()) throw InputError(key + ", layers: give only one of them");
  if (spec.structure != "none") throw InputError(key + ", structure: give only one of them");
  if (keys.given(spec.count))
    throw InputError(key +
                     ", count: leave out count and give the density at points where the map is 1");
}

}  // namespace

CellDensity::CellDensity(Domain box, Material material, Counts counts, std::vector<double> density)
    : DensityMap(box, std::move(material)),
      counts_(counts),
      size_{box.width / static_cast<double>(counts.x), box.depth / static_cast<double>(counts.z),
            box.height > 0 ? box.height / static_cast<double>(counts.y) : 1},
      density_(std::move(density)) {}

Vec CellDensity::in_cells(Vec x) const {
  return {(x.x + box().width / 2) / size_.x, x.z / size_.z, (x.y + box().height / 2) / size_.y};
}

double CellDensity::density_of(std::ptrdiff_t x, std::ptrdiff_t z, std::ptrdiff_t y) const {
  const auto row = static_cast<std::size_t>(z) * counts_.y + static_cast<std::size_t>(y);
  return density_[row * counts_.x + static_cast<std::size_t>(x)];
}

double CellDensity::relative_density(Vec x) const {
  const Vec at = in_cells(x);
  return density_of(cell_of(at.x, counts_.x), cell_of(at.z, counts_.z), cell_of(at.y, counts_.y));
}

std::shared_ptr<const MediumProfile> CellDensity::with(std::vector<Material> materials) const {
  return std::make_shared<const CellDensity>(box(), std::move(materials.front()), counts_,
                                             density_);
}

double CellDensity::met(Vec x, Vec w, double length) const {
  const Vec at = in_cells(x);
  Steps along_x(at.x, w.x / size_.x, counts_.x), along_z(at.z, w.z / size_.z, counts_.z),
      along_y(at.y, w.y / size_.y, counts_.y);
  double sum = 0, gone = 0;
  while (gone < length) {
    Steps& next = along_x.next <= along_z.next ? (along_x.next <= along_y.next ? along_x : along_y)
                                               : (along_z.next <= along_y.next ? along_z : along_y);
    const double to = std::min(next.next, length);
    sum += density_of(along_x.cell, along_z.cell, along_y.cell) * std::max(0.0, to - gone);
    gone = std::max(gone, to);
    if (to == length) break;
    next.advance();
  }
  return sum;
}

double CellDensity::most_relative() const {
  return *std::max_element(density_.begin(), density_.end());
}

double CellDensity::mean_relative() const {
  return std::accumulate(density_.begin(), density_.end(), 0.0) /
         static_cast<double>(density_.size());
}

std::string CellDensity::describe() const {
  std::string text = "density of " + std::to_string(counts_.z) + " x ";
  if (box().height > 0) text += std::to_string(counts_.y) + " x ";
  return text + std::to_string(counts_.x) + " cells";
}

DensityMap::DensityMap(Domain box, Material material)
    : MediumProfile({std::move(material)}), box_(box) {}

/// Solves for the distance by Newton's method. Bisection replaces Newton steps that leave the
/// interval between the lower and the upper bound found so far.
double DensityMap::reach(Vec x, Vec w, double optical_depth, double longest) const {
  const double mu = bulk().mu_t, wanted = optical_depth / mu;
  double low = 0, high = longest;
  if (!(met(x, w, longest) > wanted)) return longest;
  double at = std::min(wanted / std::max(relative_density(x), 1e-3), high / 2);
  constexpr int most_steps = 100;
  for (int step = 0; step < most_steps && high - low > 1e-13 * longest; ++step) {
    const double missing = wanted - met(x, w, at);
    (missing > 0 ? low : high) = at;
    if (std::abs(missing) < 1e-14 * wanted) break;
    const double next = at + missing / std::max(relative_density(x + at * w), 1e-12);
    at = next > low && next < high ? next : (low + high) / 2;
  }
  return at;
}

BulkMedium DensityMap::mean() const {
  return mean_medium({{&bulk(), mean_relative()}});
}

const DatasetTable density_table{
    "density",
    {{"map_density_x", Data::scale, "", "length", "x of the density samples"},
     {"map_density_z", Data::scale, "", "length", "z of the density samples"},
     {"relative_density", Data::real, "map_density_z map_density_x", "1",
      "density of the scatterers relative to the density that the scene states; in space at y = "
      "0"}}};

void DensityMap::write(ResultFile& file) const {
  constexpr int cells = 64;
  std::vector<double> x, z, density;
  for (int i = 0; i < cells; ++i) {
    x.push_back(((i + 0.5) / cells - 0.5) * box_.width);
    z.push_back((i + 0.5) / cells * box_.depth);
  }
  for (const double deep : z)
    for (const double across : x) density.push_back(relative_density({across, deep}));
  const ResultGroup root(file, density_table);
  root.put("map_density_x", x);
  root.put("map_density_z", z);
  root.put("relative_density", density);
}

MakeDensityMap density_map(const Keys& keys, const SceneSpec& spec) {
  const std::string &blobs_path = keys.read(spec.density_blobs),
                    &cells_path = keys.read(spec.density_map);
  if (blobs_path.empty() && cells_path.empty()) return {};
  if (!blobs_path.empty() && !cells_path.empty())
    throw InputError("density_blobs, density_map: give only one of them");
  const bool in_space = spec.dimension == 3;
  refuse_beside_map(keys, spec, blobs_path.empty() ? "density_map" : "density_blobs");
  if (!blobs_path.empty())
    return [blobs = read_blobs(blobs_path, in_space)](const Domain& box, const Material& material) {
      return std::make_shared<const Blobs>(box, material, blobs);
    };
  return [cells = guarded_read(cells_path, [&] { return read_cells(cells_path, in_space); })](
             const Domain& box, const Material& material) {
    return std::make_shared<const CellDensity>(box, material, cells.counts, cells.density);
  };
}

}  // namespace flatspeckle
