#include "mc/paths/dynamics/moving_slopes.h"

#include <cmath>
#include <memory>

#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/path_ends.h"
#include "mc/paths/estimators/scored_paths.h"
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

class MovingScorer : public TallyScorer<MovingTally> {
 public:
  MovingScorer(const PathWalks& walks, const MovingSlopes& of, std::span<Complex> sums)
      : TallyScorer(MovingTally{{of.media}, {}}),
        of_(of),
        k_(walks.scene().k),
        channels_(walks.scene().request.channels),
        scattering_(walks.scattering()),
        slopes_(walks, of.media),
        sums_(of.entries.size(), of.entries, of.media.size(), sums),
        ends_(walks, [](std::size_t ends) { return MovingEnds(ends); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) override {
    EndFactors &lights = ends_.lights(), &views = ends_.views();
    auto &light = ends_.light_last, &view = ends_.view_last;
    slopes_.attenuate(lights, x, light);
    slopes_.attenuate(views, x, view);
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      Turned turned;
      turned.add(x, from, to);
      LogSlopes log = slopes_.half_of_one(from, to);
      add(log, light.slopes[i]);
      add(log, view.slopes[v]);
      add_term(c, light.value[i] * view.value[v] * scattering_.amplitude(x, from, to), log, turned);
    }
    sums_.accumulate(weight);
  }

  void multiple(const Path& path) override {
    ends_.find(path,
               [this](EndFactors& ends, Vec2 x, const SpaceDirection& arrival, MovingEnds& out) {
                 slopes_.at(ends, x, arrival, out);
                 for (std::size_t j = 0; j < ends.size(); ++j) {
                   out.turned[j] = {};
                   out.turned[j].add(x, arrival, ends.direction(j));
                 }
               });
    const LogSlopes half = slopes_.half(tally());
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      add_ends(c, half, tally().turned, ends_.light_first, ends_.view_last);
      if (ends_.reversed()) add_ends(c, half, tally().turned, ends_.light_last, ends_.view_first);
    }
    sums_.accumulate(path.weight);
  }

 private:
  void add(LogSlopes& sum, const LogSlopes& more) const {
    for (std::size_t p = 0; p < of_.media.size(); ++p) sum[p] += more[p];
  }

  void add_ends(std::size_t c, const LogSlopes& half, const Turned& inner, const MovingEnds& lights,
                const MovingEnds& views) {
    const auto [i, v] = channels_[c];
    Turned all = inner;
    for (const Turned& end : {lights.turned[i], views.turned[v]}) {
      all.turn += end.turn;
      all.slip = all.slip + end.slip;
      all.sheared += end.sheared;
    }
    LogSlopes log = half;
    add(log, lights.slopes[i]);
    add(log, views.slopes[v]);
    add_term(c, product(lights.value[i], views.value[v]), log, all);
  }

  /// A term of a channel's field, at time 0 and after each delay.
  void add_term(std::size_t c, Complex term, const LogSlopes& log, const Turned& turned) {
    const auto& [diffusion, velocity, shear] = of_.motion;
    const Complex decay = rate(turned, k_, diffusion, velocity, shear);
    LogSlopes by_motion{};
    for (std::size_t p = 0; p < of_.parameters.size(); ++p) {
      const MovingSlope& one = of_.parameters[p];
      by_motion[p] = rate(turned, k_, one.diffusion, one.velocity, one.shear);
    }
    sums_.add_term(c, term, [&](std::size_t p) { return log[p]; });
    for (std::size_t t = 0; t < of_.delays.size(); ++t) {
      const double delay = of_.delays[t];
      const Complex later =
          product(term, std::polar(std::exp(-delay * decay.real()), -delay * decay.imag()));
      sums_.add_term((1 + t) * channels_.size() + c, later,
                     [&](std::size_t p) { return log[p] - delay * by_motion[p]; });
    }
  }

  const MovingSlopes& of_;
  double k_;
  const std::vector<Channel>& channels_;
  const EndScattering& scattering_;
  MediumSlopes slopes_;
  SlopeSums sums_;
  PathEnds<MovingEnds> ends_;
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
                     return std::make_unique<MovingScorer>(walks, *of, sums);
                   }},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
