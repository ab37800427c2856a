#pragma once

#include <array>
#include <span>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/estimators/medium_slope.h"
#include "mc/estimators/path_ends.h"
#include "mc/estimators/slope_sums.h"

namespace flatspeckle::mc {

/// What the logarithm of a path's integrand mu_s^B prod exp(-mu_t r) prod p depends on.
struct GradientTally {
  std::span<const MediumSlope> slopes;
  int scatterers = 1;
  double length = 0;
  std::array<double, most_slopes> phase_slope{};  ///< sums of d log p over the inner scatterers

  template <typename Direction>
  void flight(Vec2, const Direction&, double r) {
    length += r;
    ++scatterers;
  }
  template <typename Direction>
  void scattering(Vec2, const Direction& from, const Direction& to) {
    for (std::size_t p = 0; p < slopes.size(); ++p)
      if (slopes[p].amplitude.depends()) phase_slope[p] += 2 * slopes[p].amplitude(from, to).real();
  }
};

/// Adds weight f_a conj(f_b) and its derivatives, [1 + parameter][entry]. Each term of f (C14's F
/// and R) carries half of the path's own logarithmic derivative, besides those of its end factors.
template <typename Scattering, bool reversed, bool phases>
class GradientScorer {
  using Direction = typename Scattering::Direction;

 public:
  GradientScorer(const Scene& scene, const Scattering& scattering,
                 std::span<const MediumSlope> slopes, std::span<Complex> sums)
      : request_(scene.request),
        medium_(scene.medium),
        scattering_(scattering),
        slopes_(slopes),
        sums_(scene.request, slopes.size(), sums),
        ends_(scene, [](std::size_t ends) { return EndValues(ends); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    auto& [lights, views, light_first, light, view_first, view] = ends_;
    attenuate(lights, x, light);
    attenuate(views, x, view);
    sums_.clear();
    for (std::size_t c = 0; c < sums_.channels(); ++c) {
      const auto [i, v] = request_.channels[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      Slopes half = half_slopes({slopes_});
      for (std::size_t p = 0; p < slopes_.size(); ++p)
        if (slopes_[p].amplitude.depends()) half[p] += slopes_[p].amplitude(from, to);
      add_term(c, half, light, view, local(scattering_, x).amplitude(from, to));
    }
    sums_.accumulate(weight);
  }

  void multiple(const TalliedPath<Direction, GradientTally>& path) {
    ends_.find(path, [this](Ends& ends, Vec2 x, const Direction& arrival, EndValues& out) {
      at(ends, x, arrival, out);
    });
    const Slopes half = half_slopes(path.tally);
    sums_.clear();
    for (std::size_t c = 0; c < sums_.channels(); ++c) {
      add_term(c, half, ends_.light_first, ends_.view_last, 1.0);
      if constexpr (reversed) add_term(c, half, ends_.light_last, ends_.view_first, 1.0);
    }
    sums_.accumulate(path.weight);
  }

 private:
  using Ends = EndFactors<phases>;
  /// Logarithmic derivatives, by parameter.
  using Slopes = std::array<Complex, most_slopes>;
  /// A e of every end and its slopes.
  struct EndValues {
    std::vector<Complex> value;
    std::vector<Slopes> slopes;

    explicit EndValues(std::size_t ends) : value(ends), slopes(ends) {}
  };

  void attenuate(Ends& ends, Vec2 x, EndValues& out) const {
    ends.attenuate(x, out.value);
    for (std::size_t p = 0; p < slopes_.size(); ++p)
      for (std::size_t j = 0; j < ends.size(); ++j)
        out.slopes[j][p] = slopes_[p].log_mu_t * ends.log_attenuation(j);
  }

  void at(Ends& ends, Vec2 x, const Direction& arrival, EndValues& out) const {
    attenuate(ends, x, out);
    local(scattering_, x).towards(arrival, ends.directions(), out.value);
    for (std::size_t p = 0; p < slopes_.size(); ++p) {
      const AmplitudeSlope& amplitude = slopes_[p].amplitude;
      if (!amplitude.depends()) continue;
      for (std::size_t j = 0; j < ends.size(); ++j)
        out.slopes[j][p] += amplitude(arrival, Direction(ends.direction(j)));
    }
  }

  Slopes half_slopes(const GradientTally& tally) const {
    const double by_mu_t = tally.scatterers - medium_.mu_t * tally.length;
    Slopes half{};
    for (std::size_t p = 0; p < slopes_.size(); ++p)
      half[p] = (slopes_[p].log_mu_t * by_mu_t + slopes_[p].log_albedo * tally.scatterers +
                 tally.phase_slope[p]) /
                2;
    return half;
  }

  template <typename Amplitude>
  void add_term(std::size_t c, const Slopes& half, const EndValues& lights, const EndValues& views,
                Amplitude amplitude) {
    const auto [i, v] = request_.channels[c];
    sums_.add_term(c, product(product(lights.value[i], views.value[v]), amplitude),
                   [&, light = i, view = v](std::size_t p) {
                     return half[p] + lights.slopes[light][p] + views.slopes[view][p];
                   });
  }

  const CovarianceRequest& request_;
  const BulkMedium& medium_;
  const Scattering& scattering_;
  std::span<const MediumSlope> slopes_;
  SlopeSums sums_;
  PathEnds<EndValues, reversed, phases> ends_;
};

}  // namespace flatspeckle::mc
