#include "wave_solver/clusters/cluster_solution.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

void require_apart(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places) {
  const double least = 2 * cluster.radius + cluster.gap;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = length(places[i].centre - places[j].centre);
      if (!(distance >= least * (1 - 1e-12)))
        throw InputError("distance of clusters " + std::to_string(j) + " and " + std::to_string(i),
                         number_text(distance),
                         "must be at least " + number_text(least) + ", two radii and the gap");
    }
}

std::vector<Complex> plane_wave_at(const ClusterTMatrix& cluster, Vec2 centre, Vec2 w,
                                   Complex factor) {
  std::vector<Complex> wave(cluster.modes.size());
  const ModeSet receiver = cluster.modes_at(centre);
  expand_plane_wave(cluster.k, {&receiver, 1}, w, factor, wave);
  return wave;
}

// 1 - T S, column-major, of all clusters.
std::vector<Complex> equations(const ClusterTMatrix& cluster,
                               const std::vector<ClusterPlace>& places,
                               const std::vector<std::vector<Complex>>& responses) {
  const std::size_t size = cluster.modes.size(), unknowns = size * places.size();
  std::vector<Complex> matrix(unknowns * unknowns), waves(size * size);
  for (std::size_t i = 0; i < unknowns; ++i) matrix[i * (unknowns + 1)] = 1;
  for (std::size_t from = 0; from < places.size(); ++from)
    for (std::size_t to = 0; to < places.size(); ++to) {
      if (to == from) continue;
      const ModeSet receiver = cluster.modes_at(places[to].centre);
      translate(cluster.k, {&receiver, 1}, cluster.modes_at(places[from].centre),
                {waves.data(), size});
      multiply(CblasNoTrans, CblasNoTrans, size, size, size, -1, responses[to].data(), size,
               waves.data(), size, 0, &matrix[to * size + unknowns * from * size], unknowns);
    }
  return matrix;
}

std::vector<Complex> driven(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places,
                            const std::vector<std::vector<Complex>>& responses,
                            const std::vector<double>& light_angles) {
  const std::size_t size = cluster.modes.size();
  std::vector<Complex> columns(size * places.size() * light_angles.size());
  Complex* column = columns.data();
  for (const double angle : light_angles)
    for (std::size_t j = 0; j < places.size(); ++j, column += size) {
      const auto wave = plane_wave_at(cluster, places[j].centre, direction(angle), 1);
      multiply(CblasNoTrans, CblasNoTrans, size, 1, size, 1, responses[j].data(), size, wave.data(),
               size, 0, column, size);
    }
  return columns;
}

}  // namespace

std::vector<Complex> cluster_far_fields(const ClusterTMatrix& cluster,
                                        const std::vector<ClusterPlace>& places,
                                        const std::vector<double>& light_angles,
                                        const std::vector<double>& view_angles) {
  require_apart(cluster, places);
  std::vector<std::vector<Complex>> responses;
  for (const auto& place : places) responses.push_back(cluster.turned(place.angle));
  auto matrix = equations(cluster, places, responses);
  auto solution = driven(cluster, places, responses, light_angles);
  const std::size_t size = cluster.modes.size(), unknowns = size * places.size();
  std::vector<lapack_int> pivots(unknowns);
  const auto n = static_cast<lapack_int>(unknowns);
  if (LAPACKE_zgesv(LAPACK_COL_MAJOR, n, static_cast<lapack_int>(light_angles.size()),
                    matrix.data(), n, pivots.data(), solution.data(), n) != 0)
    throw std::runtime_error("clusters: singular equations");
  const Complex factor =
      std::sqrt(2 / (std::numbers::pi * cluster.k)) * std::polar(1.0, -std::numbers::pi / 4);
  std::vector<Complex> fields(light_angles.size() * view_angles.size());
  for (std::size_t v = 0; v < view_angles.size(); ++v)
    for (std::size_t j = 0; j < places.size(); ++j) {
      const auto wave =
          plane_wave_at(cluster, places[j].centre, -direction(view_angles[v]), factor);
      for (std::size_t light = 0; light < light_angles.size(); ++light)
        for (std::size_t i = 0; i < size; ++i)
          fields[light * view_angles.size() + v] +=
              wave[i] * solution[light * unknowns + j * size + i];
    }
  return fields;
}

}  // namespace flatspeckle::wave
