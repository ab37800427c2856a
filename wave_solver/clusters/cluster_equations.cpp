#include "wave_solver/clusters/cluster_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/scaled_bessel.h"
#include "wave_solver/dense/dense_factor.h"

namespace flatspeckle::wave {

namespace {

std::string text_of(const ClusterPlace& place) {
  return "(" + number_text(place.centre.x) + ", " + number_text(place.centre.z) + ")";
}

// In order of x, so that only near ones are compared.
void require_apart(const ClusterTMatrix& cluster, std::vector<ClusterPlace> places) {
  const double least = (2 * cluster.radius + cluster.gap) * (1 - 1e-12);
  std::ranges::sort(places, {}, [](const ClusterPlace& place) { return place.centre.x; });
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = i; j-- > 0 && places[i].centre.x - places[j].centre.x < least;)
      if (const double distance = length(places[i].centre - places[j].centre); distance < least)
        throw InputError(
            "distance of the clusters at " + text_of(places[j]) + " and " + text_of(places[i]),
            number_text(distance),
            "must be at least " + number_text(least) + ", two radii of their circles and the gap");
}

// The root of |response|, of cos n and sin n the same: what sigma is in units of w.
std::vector<double> sizes_of(const ClusterTMatrix& cluster) {
  const std::size_t size = cluster.modes.size();
  const auto own = [&](std::size_t i) { return std::abs(cluster.response[i * (size + 1)]); };
  std::vector<double> sizes{std::sqrt(own(0))};
  for (std::size_t i = 1; i < size; i += 2)
    sizes.insert(sizes.end(), 2, std::sqrt((own(i) + own(i + 1)) / 2));
  for (double& one : sizes)
    one = std::max(one, std::sqrt(std::numeric_limits<double>::min()));  // where nothing scatters
  return sizes;
}

// What w of each mode is in fields: w_n, or w_n |H_n| as close as anything comes.
std::vector<double> reaches_of(const ClusterTMatrix& cluster) {
  const auto outgoing = scaled_hankel(cluster.order, cluster.k * (cluster.radius + cluster.gap));
  std::vector<double> reaches;
  for (const Mode& mode : cluster.modes)
    reaches.push_back(std::max(static_cast<double>(mode.weight),
                               static_cast<double>(mode.weight * abs(outgoing[mode.order]))));
  return reaches;
}

std::vector<Complex> inverted(Entries matrix, std::size_t size) {
  std::vector<Complex> columns(size * size);
  for (std::size_t i = 0; i < size; ++i) columns[i * (size + 1)] = 1;
  return DenseFactor(std::move(matrix), size).solve(columns);
}

}  // namespace

namespace {

// How far the inverse of the inverse is from the response, as fields see it.
double lost_by(const ClusterTMatrix& cluster, const ScaledInverse& found) {
  const auto& sigma = found.sizes;
  const std::size_t size = sigma.size();
  const auto back = inverted({found.inverse.begin(), found.inverse.end()}, size);
  const auto reach = reaches_of(cluster);
  double wrong = 0, all = 0;
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i) {
      const Complex whole = cluster.response[i + size * j];
      const double weight = reach[i] * reach[j];
      wrong += std::norm(weight * (whole + sigma[i] * sigma[j] * back[i + size * j]));
      all += std::norm(weight * whole);
    }
  return all > 0 ? std::sqrt(wrong / all) : 0;
}

}  // namespace

// What is inverted is accretive, as M is. Where orders that hardly scatter leave no inverse at all,
// all is lost.
ScaledInverse scaled_inverse(const ClusterTMatrix& cluster) {
  ScaledInverse found{sizes_of(cluster), {}, std::numeric_limits<double>::infinity()};
  const auto& sigma = found.sizes;
  const std::size_t size = sigma.size();
  Entries scaled(size * size);
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i)
      scaled[i + size * j] = -cluster.response[i + size * j] / (sigma[i] * sigma[j]);
  try {
    found.inverse = inverted(std::move(scaled), size);
    found.lost = lost_by(cluster, found);
  } catch (const std::runtime_error&) {
  }
  return found;
}

void ClusterEquations::add_copies(const ClusterTMatrix& own,
                                  const std::vector<ClusterPlace>& places) {
  require_apart(own, places);
  std::map<double, OwnBlock> turned;
  for (const auto& [centre, angle] : places) {
    OwnBlock& block = turned[angle];
    if (!block) block = std::make_shared<const std::vector<Complex>>(own.turned(angle));
    add({centre, own.radius}, own.modes, block);
  }
}

ClusterEquations::ClusterEquations(const ClusterTMatrix& cluster,
                                   const std::vector<ClusterPlace>& places,
                                   const ScaledInverse& inverse)
    : WaveEquations(cluster.k), whole_(true) {
  ClusterTMatrix own = cluster;
  for (std::size_t i = 0; i < own.modes.size(); ++i)
    own.modes[i].weight = own.modes[i].weight * ScaledReal(inverse.sizes[i]);
  own.response = inverse.inverse;
  add_copies(own, places);
}

ClusterEquations::ClusterEquations(const ClusterTMatrix& cluster,
                                   const std::vector<ClusterPlace>& places)
    : WaveEquations(cluster.k), whole_(false) {
  ClusterTMatrix own = cluster;
  own.response.assign(own.response.size(), 0);
  add_copies(own, places);
}

}  // namespace flatspeckle::wave
