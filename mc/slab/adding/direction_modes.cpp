#include "mc/slab/adding/direction_modes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "mc/slab/adding/plane.h"
#include "mc/slab/adding/space.h"

namespace flatspeckle::mc {

namespace {

/// Returns the directions of the refracted pairs.
template <typename Geometry, typename Number>
auto directions(const std::vector<LayerWavesOf<Geometry, Number>>& pairs, bool are_views) {
  std::vector<PairOf<typename Geometry::Direction>> list;
  for (const auto& waves : pairs)
    list.push_back(are_views ? turned_round(waves.front().pair) : waves.front().pair);
  return list;
}

/// Returns the waves of pairs: first all refracted pairs, then, if there are faces, all their
/// reflections. down, up: the radiance that the scattering of the refracted pairs adds or, for
/// views, the sensitivity with which they collect it. Those of the reflections are mirror images.
template <typename Geometry, typename Number>
PairWavesOf<Number> with_waves(const std::vector<LayerWavesOf<Geometry, Number>>& pairs,
                               const RowsOf<Number>& down, const RowsOf<Number>& up) {
  const std::size_t each = pairs.front().size();
  PairWavesOf<Number> found{{}, {}, down, up, {}, std::ssize(pairs)};
  if (each == 2) {
    found.down = concatenated(down, up);
    found.up = concatenated(up, down);
  }
  for (std::size_t w = 0; w < each; ++w)
    for (const auto& waves : pairs) {
      found.top.push_back(waves[w].wave.top);
      found.bottom.push_back(waves[w].wave.bottom);
      found.factor.push_back(waves[w].factor);
    }
  return found;
}

double norm(const Rows& rows) {
  return rows.norm();
}
double norm(const Dual<Rows>& rows) {
  return rows.value.norm() + rows.derivative.norm();
}

}  // namespace

template <typename Geometry, typename Number>
DirectionModesOf<Geometry, Number>::DirectionModesOf(const Slab& slab, const Discrete& discrete,
                                                     int highest, const Momentum& momentum,
                                                     const Pairs& lights, const Pairs& views)
    : slab_(slab),
      discrete_(discrete),
      highest_(highest),
      q_(Geometry::size(momentum, slab.k / slab.mu_t)) {
  const auto follow = [&](const Pairs& pairs, bool are_views) {
    std::vector<PairInLayersOf<Geometry, Number>> followed;
    for (const auto& pair : pairs)
      followed.emplace_back(slab, are_views ? turned_round(pair) : pair);
    return followed;
  };
  const auto of_lights = follow(lights, false), of_views = follow(views, true);
  const auto in_layer = [](const auto& followed, std::size_t layer) {
    std::vector<LayerWaves> waves;
    for (const auto& pair : followed) waves.push_back(pair.layers()[layer]);
    return waves;
  };
  for (std::size_t layer = 0; layer < slab.layers.size(); ++layer) {
    const auto fed = [&](const std::vector<LayerWaves>& waves, bool are_views) {
      return Geometry::template fed<Number>(discrete_.layers()[layer], momentum, highest_,
                                            mc::directions<Geometry, Number>(waves, are_views));
    };
    const auto own_lights = in_layer(of_lights, layer), own_views = in_layer(of_views, layer);
    const Waves of_light = fed(own_lights, false),
                of_view = views == lights ? of_light : fed(own_views, true);
    endpoints_.push_back({with_waves<Geometry, Number>(own_lights, of_light.down, of_light.up),
                          with_waves<Geometry, Number>(own_views, of_view.up, of_view.down)});
  }
}

template <typename Geometry, typename Number>
double DirectionModesOf<Geometry, Number>::q(std::size_t layer) const {
  return q_ * (slab_.mu_t / slab_.layers[layer].mu_t);
}

template <typename Geometry, typename Number>
auto DirectionModesOf<Geometry, Number>::parts() const -> std::vector<Part> {
  std::vector<Part> list;
  if (q_ == 0) {
    for (int f = 0; f <= Geometry::function_kinds * highest_; ++f)
      list.push_back({{f}, mode(f) % 2 == 0});
    return list;
  }
  for (int first = 0; first < Geometry::function_kinds; ++first) {  // cosines, then sines
    Part part{{}, 0};
    for (const int parity : {0, 1}) {
      for (int m = first; m <= highest_; ++m)
        if (m % 2 == parity) part.functions.push_back(first * highest_ + m);
      if (parity == 0) part.even = static_cast<int>(part.functions.size());
    }
    if (!part.functions.empty()) list.push_back(part);
  }
  return list;
}

template <typename Geometry, typename Number>
auto DirectionModesOf<Geometry, Number>::layers(const Part& part) const -> std::vector<Layer> {
  std::vector<Layer> list;
  if (is_dark(part, &EndpointWavesOf<Number>::lights) ||
      is_dark(part, &EndpointWavesOf<Number>::views))
    return list;
  for (std::size_t layer = 0; layer < slab_.layers.size(); ++layer)
    list.push_back({transport(layer, part), slab_.optical_depth(slab_.layers[layer]),
                    part_of(endpoints_[layer].lights, part),
                    part_of(endpoints_[layer].views, part)});
  return list;
}

template <typename Geometry, typename Number>
bool DirectionModesOf<Geometry, Number>::is_dark(const Part& part,
                                                 Waves EndpointWavesOf<Number>::*waves) const {
  constexpr double rounding = 1e-13;
  double within = 0, all = 0;
  for (const auto& endpoints : endpoints_) {
    const Waves own = part_of(endpoints.*waves, part);
    within += norm(own.down) + norm(own.up);
    all += norm((endpoints.*waves).down) + norm((endpoints.*waves).up);
  }
  return within < rounding * all;
}

template <typename Geometry, typename Number>
Number DirectionModesOf<Geometry, Number>::extinction(std::size_t layer) const {
  const auto& of = slab_.layers[layer];
  return slab_.departure.extinction(of.k / of.mu_t) - discrete_.layers()[layer].peak_scattering();
}

template <typename Geometry, typename Number>
TransportOperatorOf<Number> DirectionModesOf<Geometry, Number>::transport(std::size_t layer,
                                                                          const Part& part) const {
  const AngularGrid& grid = discrete_.grid(layer);
  const double extinction = std::abs(value_of(this->extinction(layer)));
  return {block(layer, part, &Scattering::difference), block(layer, part, &Scattering::sum),
          part.even * grid.size(),
          (extinction + std::abs(q(layer))) /
              *std::min_element(grid.cosine().begin(), grid.cosine().end())};
}

template <typename Geometry, typename Number>
MatrixOf<Number> DirectionModesOf<Geometry, Number>::block(
    std::size_t layer, const Part& part, MatrixOf<Real> Scattering::*scattering) const {
  const AngularGrid& grid = discrete_.grid(layer);
  const Eigen::Index n = grid.size(), count = std::ssize(part.functions);
  const Eigen::ArrayXd momentum = q(layer) * grid.angle().array().sin() / grid.cosine().array();
  Matrix extinction = Matrix::Zero(count * n, count * n), across = extinction;
  for (Eigen::Index a = 0; a < count; ++a) {
    const int m = mode(part.functions[a]);
    extinction.block(a * n, a * n, n, n) = grid.cosine().cwiseInverse().asDiagonal();
    for (Eigen::Index b = 0; b < count; ++b) {
      const int other = mode(part.functions[b]);
      if (std::abs(other - m) != 1) continue;
      const double coupling = (m - other) * Geometry::coupling(std::min(m, other));
      across.block(a * n, b * n, n, n) = (coupling * momentum).matrix().asDiagonal();
    }
  }
  const auto scattered = each_part<Real>([&](const auto& of) {
    Matrix all = Matrix::Zero(count * n, count * n);
    for (Eigen::Index a = 0; a < count; ++a)
      all.block(a * n, a * n, n, n) =
          of(discrete_.layers()[layer].of_mode(mode(part.functions[a])).*scattering);
    return all;
  });
  const Departure<Number>& departure = slab_.departure;
  return times(this->extinction(layer), extinction) - scattered + times(departure.length, across);
}

template <typename Geometry, typename Number>
auto DirectionModesOf<Geometry, Number>::part_of(const Waves& all, const Part& part) const
    -> Waves {
  const Eigen::Index n = value_of(all.down).cols() / functions(),
                     count = std::ssize(part.functions);
  const auto taken = [&](const Rows& rows) {
    Rows found(rows.rows(), count * n);
    for (Eigen::Index a = 0; a < count; ++a)
      found.middleCols(a * n, n) = rows.middleCols(part.functions[a] * n, n);
    return found;
  };
  return {all.top,    all.bottom, linear(taken, all.down), linear(taken, all.up),
          all.factor, all.pairs};
}

template class DirectionModesOf<PlaneGeometry, double>;
template class DirectionModesOf<PlaneGeometry, Complex>;
template class DirectionModesOf<PlaneGeometry, Dual<double>>;
template class DirectionModesOf<SpaceGeometry, double>;
template class DirectionModesOf<SpaceGeometry, Complex>;
template class DirectionModesOf<SpaceGeometry, Dual<double>>;

}  // namespace flatspeckle::mc
