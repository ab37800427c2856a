#include "grin/media/field_file.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"

namespace flatspeckle::grin {

namespace {

/// A dataset over x, y and z, and where its nodes lie.
class GridDataset {
 public:
  GridDataset(const ResultReader& file, std::string name) : file_(file), name_(std::move(name)) {}

  FieldGrid grid() const {
    const std::vector<std::size_t> shape = file_.shape(name_);
    if (shape.size() != 3) throw InputError("axes of " + name_, shape.size(), "must be 3: x, y, z");
    FieldGrid grid{vector("origin"), vector("spacing"), {}};
    for (int a = 0; a < 3; ++a) grid.nodes[a] = static_cast<int>(shape[a]);
    return grid;
  }
  std::vector<double> values() const { return file_.dataset<double>(name_); }

 private:
  Vec3 vector(const std::string& attribute) const {
    const auto values = file_.attribute<std::vector<double>>(name_, attribute);
    if (values.size() != 3) throw InputError("numbers in " + attribute, values.size(), "must be 3");
    return {values[0], values[1], values[2]};
  }

  const ResultReader& file_;
  std::string name_;
};

/// So far from the limits of numbers that rays do not come to them, with nodes that can be told
/// apart.
void check_range(const FieldGrid& grid, const std::vector<double>& values) {
  constexpr double least = 1e-100, most = 1e100, most_value = 1e6, rounding = 1e-12;
  const auto high = std::max_element(values.begin(), values.end());
  if (high != values.end() && *high > most_value)
    throw InputError("sample of a grid", *high, "must be at most 1e6");
  for (int a = 0; a < 3; ++a) {
    const double farthest = std::max(std::abs(grid.origin[a]), std::abs(grid.end()[a]));
    if (!(farthest < most)) throw InputError("end of a grid", farthest, "must be below 1e100");
    if (grid.spacing[a] < std::max(least, rounding * farthest))
      throw InputError("spacing of a grid", grid.spacing[a],
                       "must be above 1e-100 and the rounding of its coordinates");
  }
}

struct Samples {
  FieldGrid where;
  std::vector<double> values;
};

Samples read_samples(const std::filesystem::path& path, const std::string& name) {
  const ResultReader file(path);
  const GridDataset dataset(file, name);
  return {dataset.grid(), dataset.values()};
}

/// Every InputError names the file.
template <class Grid>
Grid read_grid(const std::filesystem::path& path, const std::string& name) {
  try {
    const auto [where, values] = guarded_read(path, [&] { return read_samples(path, name); });
    Grid grid(where, values);  // checks too
    check_range(where, values);
    return grid;
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.find(path.string()) != std::string::npos) throw;
    throw InputError(path.string() + ": " + message);
  }
}

}  // namespace

SplineField read_spline_field(const std::filesystem::path& path) {
  return read_grid<SplineField>(path, "excess");
}

DensityGrid read_density_grid(const std::filesystem::path& path) {
  return read_grid<DensityGrid>(path, "density");
}

}  // namespace flatspeckle::grin
