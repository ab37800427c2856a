#include "mc/paths/dynamics/moving_slopes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/slope_sums.h"
#include "mc/paths/estimators/sloped_ends.h"

namespace flatspeckle::mc {

namespace {

/// Of a path's scatterers: sums of 1 - cos, of from - to, and of its x times the depth.
struct Turned {
  double turn = 0;
  Vec2 slip{};
  double sheared = 0;

  void add(Vec2 x, const SpaceDirection& from, const SpaceDirection& to) {
    const Vec2 turned = Vec2(from) - Vec2(to);
    turn += one_minus_cosine(from, to);
    slip = slip + turned;
    sheared += turned.x * x.z;
  }
  Turned operator+(const Turned& more) const {
    return {turn + more.turn, slip + more.slip, sheared + more.sheared};
  }
};

/// What motion multiplies the second field by has the logarithm -t times this, which is linear in
/// the motion.
Complex rate(const Turned& turned, double k, double diffusion, Vec2 velocity, double shear) {
  return {2 * diffusion * turned.turn, -k * (dot(velocity, turned.slip) + shear * turned.sheared)};
}

struct MovingTally : GradientTally {
  Turned turned;

  void scattering(Vec2 x, const SpaceDirection& from, const SpaceDirection& to) {
    GradientTally::scattering(x, from, to);
    turned.add(x, from, to);
  }
};

struct MovingEnds : SlopedEnds {
  std::vector<Turned> turned;

  explicit MovingEnds(std::size_t ends) : SlopedEnds(ends), turned(ends) {}
};

/// What all batches share.
struct MovingSlopes {
  std::vector<double> delays;
  Motion motion;
  std::vector<MovingSlope> parameters;
  std::vector<MediumSlope> media;  ///< of the parameters
  std::vector<Entry> entries;      ///< of fields [1 + delay][channel]
};

/// What a path has besides its ends.
struct MovingInner {
  LogSlopes half;
  Turned turned;
};

class MovingTerms : public MediumSlopes, public SlopeSums {
 public:
  using Tally = MovingTally;
  using Ends = MovingEnds;

  MovingTerms(const PathWalks& walks, const MovingSlopes& of, std::span<Complex> sums)
      : MediumSlopes(walks, of.media),
        SlopeSums(of.entries.size(), of.entries, of.media.size(), sums),
        of_(of),
        k_(walks.scene().k),
        channels_(walks.scene().request.channels.size()) {}

  MovingEnds ends(std::size_t count) const { return MovingEnds(count); }

  void attenuate(EndFactors& ends, Vec2 x, MovingEnds& out) const {
    MediumSlopes::attenuate(ends, x, out);
    std::fill(out.turned.begin(), out.turned.end(), Turned{});
  }
  void turn(const EndFactors& ends, Vec2 x, const SpaceDirection& arrival, MovingEnds& out) const {
    MediumSlopes::turn(ends, x, arrival, out);
    for (std::size_t j = 0; j < ends.size(); ++j) out.turned[j].add(x, arrival, ends.direction(j));
  }

  MovingInner inner(const MovingTally& tally, Vec2 first) const {
    return {MediumSlopes::inner(tally, first), tally.turned};
  }
  MovingInner one(Vec2 x, Vec2 from, Vec2 to) const {
    MovingInner one{MediumSlopes::one(x, from, to), {}};
    one.turned.add(x, from, to);
    return one;
  }

  /// A term of a channel's field, at time 0 and after each delay.
  void add_term(std::size_t c, Complex term, const MovingInner& inner, const MovingEnds& lights,
                std::size_t i, const MovingEnds& views, std::size_t v) {
    const Turned turned = inner.turned + lights.turned[i] + views.turned[v];
    const auto& [diffusion, velocity, shear] = of_.motion;
    const Complex decay = rate(turned, k_, diffusion, velocity, shear);
    LogSlopes log{}, by_motion{};
    for (std::size_t p = 0; p < of_.parameters.size(); ++p) {
      const MovingSlope& one = of_.parameters[p];
      log[p] = inner.half[p] + lights.slopes[i][p] + views.slopes[v][p];
      by_motion[p] = rate(turned, k_, one.diffusion, one.velocity, one.shear);
    }
    SlopeSums::add_term(c, term, [&](std::size_t p) { return log[p]; });
    for (std::size_t t = 0; t < of_.delays.size(); ++t) {
      const double delay = of_.delays[t];
      const Complex later =
          product(term, std::polar(std::exp(-delay * decay.real()), -delay * decay.imag()));
      SlopeSums::add_term((1 + t) * channels_ + c, later,
                          [&](std::size_t p) { return log[p] - delay * by_motion[p]; });
    }
  }

 private:
  const MovingSlopes& of_;
  double k_;
  std::size_t channels_;
};

}  // namespace

PathJob moving_slope_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                         const Motion& motion, const std::vector<MovingSlope>& slopes,
                         std::uint64_t seed) {
  check_delays(scene, delays);
  MovingSlopes all{delays, motion, slopes, {}, {}};
  for (const MovingSlope& slope : slopes) all.media.push_back(slope.medium);
  require_slopes(scene, all.media);
  const auto channels = static_cast<std::uint32_t>(scene.request.channels.size());
  for (std::uint32_t t = 0; t <= delays.size(); ++t)
    for (std::uint32_t c = 0; c < channels; ++c) all.entries.push_back({c, t * channels + c});
  const std::size_t quantities = (1 + all.media.size()) * (1 + delays.size());
  return path_job({quantities,
                   [of = std::make_shared<const MovingSlopes>(std::move(all))](
                       const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<SlopeScorer<MovingTerms>>(
                         walks, MovingTally{{of->media}, {}}, MovingTerms(walks, *of, sums));
                   }},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
