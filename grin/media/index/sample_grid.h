#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Where the samples of a field lie: node (i, j, k) at origin + (i, j, k) * spacing, k fastest.
struct FieldGrid {
  Vec3 origin, spacing;
  std::array<int, 3> nodes;

  std::size_t size() const { return static_cast<std::size_t>(nodes[0]) * nodes[1] * nodes[2]; }
  Vec3 end() const {
    return origin + spacing.cwiseProduct(Vec3(nodes[0] - 1, nodes[1] - 1, nodes[2] - 1));
  }
};

/// Throws InputError for fewer nodes along an axis, a spacing that is not positive, an origin that
/// is not finite, or another number of samples than nodes.
void check(const FieldGrid& grid, std::size_t samples, int least_nodes);

struct GridSamples {
  FieldGrid where;
  std::vector<double> values;
};
/// A dataset of an HDF5 file with axes x, y, z, and on it the attributes "origin" and "spacing",
/// three numbers each; so far from the limits of numbers that rays do not come to them, with nodes
/// that can be told apart. Throws InputError naming what is missing or of another shape.
GridSamples read_samples(const std::filesystem::path& path, const std::string& dataset);

/// What is made of such samples. Every InputError names the file.
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
