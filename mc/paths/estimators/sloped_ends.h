#pragma once

#include <array>
#include <span>
#include <vector>

#include "mc/paths/estimators/medium_slope.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// What the logarithm of a path's integrand mu_s^B prod exp(-mu_t r) prod p depends on.
struct GradientTally {
  std::span<const MediumSlope> slopes;
  int scatterers = 1;
  double length = 0;
  std::array<double, most_slopes> phase_slope{};  ///< sums of d log p over the inner scatterers

  void flight(Vec2, const SpaceDirection&, double r) {
    length += r;
    ++scatterers;
  }
  void scattering(Vec2, const SpaceDirection& from, const SpaceDirection& to) {
    for (std::size_t p = 0; p < slopes.size(); ++p)
      if (slopes[p].amplitude.depends()) phase_slope[p] += 2 * slopes[p].amplitude(from, to).real();
  }
};

/// Logarithmic derivatives, by parameter.
using LogSlopes = std::array<Complex, most_slopes>;

/// A e of every end and its slopes.
struct SlopedEnds {
  std::vector<Complex> value;
  std::vector<LogSlopes> slopes;

  explicit SlopedEnds(std::size_t ends) : value(ends), slopes(ends) {}
};

/// Derivatives of paths and of their ends by what a medium is made of (SlopeScorer). Each term of a
/// field (C14's F and R) carries half of the path's own logarithmic derivative, besides those of
/// its end factors.
class MediumSlopes {
 public:
  using Tally = GradientTally;
  using Ends = SlopedEnds;

  MediumSlopes(const PathWalks& walks, std::span<const MediumSlope> slopes)
      : medium_(walks.scene().medium), slopes_(slopes) {}

  SlopedEnds ends(std::size_t count) const { return SlopedEnds(count); }

  void attenuate(EndFactors& ends, Vec2 x, SlopedEnds& out) const {
    ends.attenuate(x, out.value);
    for (std::size_t p = 0; p < slopes_.size(); ++p)
      for (std::size_t j = 0; j < ends.size(); ++j)
        out.slopes[j][p] = slopes_[p].log_mu_t * ends.log_attenuation(j);
  }

  void turn(const EndFactors& ends, Vec2, const SpaceDirection& arrival, SlopedEnds& out) const {
    for (std::size_t p = 0; p < slopes_.size(); ++p) {
      const AmplitudeSlope& amplitude = slopes_[p].amplitude;
      if (!amplitude.depends()) continue;
      for (std::size_t j = 0; j < ends.size(); ++j)
        out.slopes[j][p] += amplitude(arrival, SpaceDirection(ends.direction(j)));
    }
  }

  LogSlopes inner(const GradientTally& tally, Vec2) const {
    const double by_mu_t = tally.scatterers - medium_.mu_t * tally.length;
    LogSlopes half{};
    for (std::size_t p = 0; p < slopes_.size(); ++p)
      half[p] = (slopes_[p].log_mu_t * by_mu_t + slopes_[p].log_albedo * tally.scatterers +
                 tally.phase_slope[p]) /
                2;
    return half;
  }

  LogSlopes one(Vec2 x, Vec2 from, Vec2 to) const {
    LogSlopes one = inner({slopes_}, x);
    for (std::size_t p = 0; p < slopes_.size(); ++p)
      if (slopes_[p].amplitude.depends()) one[p] += slopes_[p].amplitude(from, to);
    return one;
  }

 private:
  const BulkMedium& medium_;
  std::span<const MediumSlope> slopes_;
};

}  // namespace flatspeckle::mc
