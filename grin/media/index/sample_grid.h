#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Nodes of sampled fields: node (i, j, k) is at origin + (i, j, k) * spacing, k varies fastest.
struct FieldGrid {
  Vec3 origin, spacing;
  std::array<int, 3> nodes;

  std::size_t size() const { return static_cast<std::size_t>(nodes[0]) * nodes[1] * nodes[2]; }
  Vec3 end() const {
    return origin + spacing.cwiseProduct(Vec3(nodes[0] - 1, nodes[1] - 1, nodes[2] - 1));
  }
};

/// Throws InputError for fewer than least_nodes nodes along an axis, a spacing that is not
/// positive, an origin that is not finite, or a number of samples other than the number of nodes.
void check(const FieldGrid& grid, std::size_t samples, int least_nodes);

struct GridSamples {
  FieldGrid where;
  std::vector<double> values;
};
/// Throws InputError for values near overflow and for nodes that are closer than the rounding of
/// their coordinates.
void check_range(const GridSamples& samples);

/// Reads a dataset of an HDF5 file with axes x, y, z and its attributes "origin" and "spacing",
/// three numbers each. Throws an InputError that names a dataset or attribute that is missing or
/// has another shape, and as check_range() does.
GridSamples read_samples(const std::filesystem::path& path, const std::string& dataset);

/// Returns the index around a field of `design`, the attribute host_index of its dataset; 1 if
/// there is none. Throws InputError unless it is positive.
double host_index_in(const std::filesystem::path& path, const std::string& dataset);

/// Returns an object of type Grid, constructed from the samples in a file (read_samples). Every
/// InputError names the file.
template <class Grid>
Grid read_grid(const std::filesystem::path& path, const std::string& dataset) {
  try {
    const auto [where, values] = read_samples(path, dataset);
    return Grid(where, values);
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.find(path.string()) != std::string::npos) throw;
    throw InputError(path.string() + ": " + message);
  }
}

}  // namespace flatspeckle::grin
