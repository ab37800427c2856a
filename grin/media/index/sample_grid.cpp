#include "grin/media/index/sample_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"

namespace flatspeckle::grin {

namespace {

/// A dataset of a file with axes x, y and z, and the positions of its nodes.
class GridDataset {
 public:
  GridDataset(const ResultReader& file, std::string name) : file_(file), name_(std::move(name)) {}

  FieldGrid grid() const {
    const std::vector<std::size_t> shape = file_.shape(name_);
    if (shape.size() != 3) throw InputError("axes of " + name_, shape.size(), "must be 3: x, y, z");
    for (const char* attribute : {"origin", "spacing"})
      if (!file_.has_attribute(name_, attribute))
        throw InputError(name_ + " has no attribute " + attribute +
                         ": requires origin and spacing, three numbers each");
    FieldGrid grid{vector("origin"), vector("spacing"), {}};
    for (int a = 0; a < 3; ++a) grid.nodes[a] = static_cast<int>(shape[a]);
    return grid;
  }
  std::vector<double> values() const { return file_.dataset<double>(name_); }

 private:
  Vec3 vector(const std::string& attribute) const {
    const auto values = file_.attribute<std::vector<double>>(name_, attribute);
    if (values.size() != 3)
      throw InputError(attribute + ": has " + std::to_string(values.size()) +
                       " numbers, must have 3");
    return {values[0], values[1], values[2]};
  }

  const ResultReader& file_;
  std::string name_;
};

}  // namespace

void check(const FieldGrid& grid, std::size_t samples, int least_nodes) {
  for (int a = 0; a < 3; ++a) {
    if (grid.nodes[a] < least_nodes)
      throw InputError("nodes of a grid", grid.nodes[a],
                       "must be at least " + std::to_string(least_nodes));
    if (!(grid.spacing[a] > 0 && std::isfinite(grid.spacing[a])))
      throw InputError("spacing of a grid", grid.spacing[a], "must be positive");
    if (!std::isfinite(grid.origin[a]))
      throw InputError("origin of a grid", grid.origin[a], "must be finite");
  }
  if (samples != grid.size())
    throw InputError("samples of a grid", samples, "must be one for each node");
}

void check_range(const GridSamples& samples) {
  const auto& [grid, values] = samples;
  constexpr double least = 1e-100, most = 1e100, most_value = 1e6, rounding = 1e-12;
  const auto high = std::max_element(values.begin(), values.end());
  if (high != values.end() && *high > most_value)
    throw InputError("sample of a grid", *high, "must be at most 1e6");
  for (int a = 0; a < 3; ++a) {
    const double farthest = std::max(std::abs(grid.origin[a]), std::abs(grid.end()[a]));
    if (!(farthest < most)) throw InputError("end of a grid", farthest, "must be below 1e100");
    if (grid.spacing[a] < std::max(least, rounding * farthest))
      throw InputError("spacing of a grid", grid.spacing[a],
                       "must be above 1e-100 and above the rounding of the coordinates");
  }
}

GridSamples read_samples(const std::filesystem::path& path, const std::string& dataset) {
  return guarded_read(path, [&] {
    const ResultReader file(path);
    const GridDataset samples(file, dataset);
    GridSamples read{samples.grid(), samples.values()};
    check_range(read);
    return read;
  });
}

double host_index_in(const std::filesystem::path& path, const std::string& dataset) {
  return guarded_read(path, [&] {
    const ResultReader file(path);
    if (!file.has_attribute(dataset, "host_index")) return 1.0;
    const auto host = file.attribute<double>(dataset, "host_index");
    if (!(host > 0 && host < 1e6)) throw InputError("host_index", host, "must be from 0 to 1e6");
    return host;
  });
}

}  // namespace flatspeckle::grin
