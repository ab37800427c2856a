#include "mc/paths/walk/walks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/numbers/random.h"
#include "core/run/interrupt.h"
#include "flatland/scene/scene.h"
#include "grin/media/scattering/free_flight.h"
#include "mc/paths/bent/graded_endpoints.h"
#include "mc/paths/endpoint_factors/faced_endpoints.h"
#include "mc/paths/endpoint_factors/profile_flight.h"
#include "mc/paths/endpoint_factors/space_scattering.h"
#include "mc/paths/endpoint_factors/varying_scattering.h"
#include "mc/paths/walk/first_scatterer.h"
#include "mc/paths/walk/importance.h"
#include "mc/paths/walk/path_scorer.h"
#include "mc/paths/walk/plan.h"
#include "mc/paths/walk/scene_scattering.h"

namespace flatspeckle::mc {

namespace {

/// Samples random walks from the lights through a scene [bar2019] and passes their paths to a
/// scorer. Scoring a path costs far more than a step of a walk, so paths with a small expected
/// contribution undergo Russian roulette before they are scored. A weight window splits and
/// terminates walkers by the importance at their depth.
///
/// With reversed paths, the density of a path is the mean of the densities with which the walk
/// samples it from its two ends. This is unbiased, because F + R does not change when a path is
/// reversed, and keeps |R|^2 times the weight bounded.
template <typename Scattering>
class PathWalk {
 public:
  PathWalk(const Scene& scene, const Plan& plan, const Scattering& scattering)
      : plan_(plan),
        domain_(scene.domain),
        medium_(scene.medium),
        profile_(scene.profile.get()),
        scattering_(scattering),
        faces_(scene.faces),
        importance_(scene),
        first_(make_first(scene)),
        expected_view_(scene, view_endpoints(scene)) {}

  /// Prepares a batch. Called before the first walk of the batch.
  void begin(RandomStream& random) {
    // Five times the largest mean number of scatterings of a batch (plan.cpp)
    constexpr std::uint64_t steps_of_splitting = 5'000'000;
    ticket_ = random.uniform();
    if (plan_.waves.size() > 1) wave_ticket_ = random.uniform();
    last_splitting_ = steps_ + steps_of_splitting;
  }

  void walk(RandomStream& random, PathScorer& scorer) {
    has_tally_ = scorer.has_tally();
    const auto first = first_.sample(random);
    if (!first.hit) return;
    const Vec x = first.x;
    const Vec arrival = first.arrival;
    if constexpr (varies<Scattering>) {
      if (mu_s(x) == 0) return;
    }
    if (plan_.sampled_single) score_single(x, arrival, scorer);
    start_ = local(scattering_, x).sample(arrival, random);
    path_ = {x, start_, {}, {}, 0, true};
    start_density_ = -1;
    log_importance_first_ = std::max(importance_.log_importance(x.z), 0.0);
    if (plan_.reversed) expected_first_ = expected(x, -start_);
    const auto [length, weight] = first_flight(x, start_, random);
    scorer.begin(x, start_, length);
    const auto [end, w] = flight_end(x, start_, length);
    follow({end, w, weight, 1}, random, scorer);
    while (!waiting_.empty()) {
      Walker walker = waiting_.back();
      const bool last = --waiting_.back().copies == 0;
      if (last) waiting_.pop_back();
      scorer.take_up(last);
      if (step(walker, random, scorer)) follow(walker, random, scorer);
    }
  }

 private:
  using First = std::conditional_t<bends<Scattering>, GradedFirst, FirstScatterer>;

  First make_first(const Scene& scene) const {
    if constexpr (bends<Scattering>)
      return First(scene, scattering_);
    else
      return First(scene, plan_.weighted ? importance_.mean_derivative() : 0);
  }

  /// A walker on its arrival at a scatterer. Its weight is in units of mu_s^2 / mu_t, the weight of
  /// a path of two scatterers in C14. copies: number of paths that are still to continue from here.
  struct Walker {
    Vec x;
    Vec arrival;
    double weight;
    std::uint32_t copies;
  };

  // Properties of the medium at a place.
  double mu_s(Vec x) const {
    if constexpr (varies<Scattering>) return profile_->mu_s(x);
    return medium_.mu_s;
  }
  double albedo(Vec x) const {
    if constexpr (varies<Scattering>) return profile_->albedo(x);
    return medium_.albedo;
  }

  /// Returns the length and weight of the first flight between scatterers. This flight always ends
  /// inside the medium; otherwise most walks in a thin medium would yield no path.
  std::pair<double, double> first_flight(Vec x, Vec w, RandomStream& random) const {
    if constexpr (bends<Scattering>) {
      const grin::BoundedFlight flight{medium_.mu_t, scattering_.medium().inside(x, w)};
      return {flight.sample(random.uniform()), flight.probability()};
    }
    const double edge = path_to_exit(x, w, random);
    if constexpr (varies<Scattering>) {
      const ProfileFlight flight(*profile_, x, w, edge);
      return {flight.sample(random.uniform()), flight.probability()};
    }
    const BoundedBiasedFlight flight{medium_.mu_t, edge, bias(x, w)};
    const double length = flight.sample(random.uniform());
    return {length, flight.weight(length)};
  }

  /// Returns the place where a flight ends, and the direction of the flight at this place.
  std::pair<Vec, Vec> flight_end(Vec x, Vec w, double length) const {
    if constexpr (bends<Scattering>) {
      const auto place = scattering_.medium().after_flight(x, w, length);
      return place ? std::pair(place->x, place->w) : std::pair(x, w);
    } else {
      if (faces_) return folded(x + length * w, w);
      return {x + length * w, w};
    }
  }

  /// Returns the length of the path from x along w to the place where light leaves the medium. With
  /// faces, the number of reflections on the way is sampled.
  double path_to_exit(Vec x, Vec w, RandomStream& random) const {
    const double edge = domain_.distance_to_edge(x, w);
    if (!faces_ || w.z == 0) return edge;
    const double cosine = std::abs(w.z), reflectance = faces_->leaving().reflectance(cosine),
                 side = domain_.kind == Domain::Kind::slab ? std::numeric_limits<double>::infinity()
                                                           : domain_.distance_to_side(x, w);
    if (reflectance == 0 || edge >= side) return edge;
    if (reflectance >= 1) return side;
    const double reflections = std::floor(std::log(random.uniform()) / std::log(reflectance));
    const double to_face = (w.z > 0 ? domain_.depth - x.z : x.z) / cosine;
    return std::min(side, to_face + reflections * domain_.depth / cosine);
  }

  /// Returns the place and direction in the medium of a ray that was continued beyond the faces
  /// without reflections.
  std::pair<Vec, Vec> folded(Vec x, Vec w) const {
    const double crossings = std::floor(x.z / domain_.depth),
                 rest = std::clamp(x.z - crossings * domain_.depth, 0.0, domain_.depth);
    const bool turned = std::fmod(std::abs(crossings), 2) == 1;
    if (turned) w.z = -w.z;
    return {{x.x, turned ? domain_.depth - rest : rest, x.y}, w};
  }

  /// Follows a walker from its arrival at a scatterer until it leaves the medium, is terminated or
  /// splits.
  void follow(Walker walker, RandomStream& random, PathScorer& scorer) {
    do {
      score(walker, scorer);
      if (plan_.weighted && !reweigh(walker, random, scorer)) return;
    } while (step(walker, random, scorer));
  }

  /// Moves a walker to the next scatterer; returns false if there is none.
  bool step(Walker& walker, RandomStream& random, PathScorer& scorer) {
    constexpr std::uint64_t between_checks = 4096;
    if (++steps_ % between_checks == 0) stop_if_interrupted();
    const Vec w = local(scattering_, walker.x).sample(walker.arrival, random);
    if constexpr (bends<Scattering>) return fly_bent(walker, w, random, scorer);
    const double edge = path_to_exit(walker.x, w, random),
                 flight = sample_flight(walker, w, edge, random);
    if (flight >= edge) return false;
    if (has_tally_) scorer.step(walker.x, walker.arrival, w, flight);
    std::tie(walker.x, walker.arrival) = flight_end(walker.x, w, flight);
    return true;
  }

  bool fly_bent(Walker& walker, Vec w, RandomStream& random, PathScorer& scorer) const {
    const double flight = grin::sample_free_flight(medium_.mu_t, random.uniform());
    const auto place = scattering_.medium().after_flight(walker.x, w, flight);
    if (!place) return false;
    if (has_tally_) scorer.step(walker.x, walker.arrival, w, flight);
    walker.x = place->x;
    walker.arrival = place->w;
    return true;
  }

  /// Samples the length of a flight. Where light decays with depth, half of the flights towards
  /// higher importance are biased by the exponential transform [dwivedi1982]; otherwise rare long
  /// flights would dominate the result.
  double sample_flight(Walker& walker, Vec w, double edge, RandomStream& random) const {
    if constexpr (varies<Scattering>)
      return profile_->reach(walker.x, w, -std::log(random.uniform()), edge);
    const double mu_t = medium_.mu_t;
    if (plan_.weighted) {
      if (const double growth = bias(walker.x, w); growth > 0) {
        const double mu_t_factor = 1 - std::min(growth, grin::BiasedFlight::largest_bias);
        const bool is_biased = random.uniform() < 0.5;
        const double flight =
            grin::sample_free_flight(is_biased ? mu_t_factor * mu_t : mu_t, random.uniform());
        walker.weight *= 2 / (1 + mu_t_factor * std::exp((1 - mu_t_factor) * mu_t * flight));
        return flight;
      }
    }
    return grin::sample_free_flight(mu_t, random.uniform());
  }

  /// Returns the derivative of the log importance at x in the direction w, per mean free path.
  double bias(Vec x, Vec w) const {
    return plan_.weighted ? importance_.derivative(x.z) * w.z / medium_.mu_t : 0;
  }

  /// Applies the weight window; returns false if the walker is terminated or split. Where the
  /// importance exceeds the actual contributions, the number of walkers could grow without limit.
  /// Splitting therefore stops for the rest of the batch after a number of steps. This decision
  /// depends only on the past, so it causes no bias.
  bool reweigh(Walker& walker, RandomStream& random, PathScorer& scorer) {
    walker.weight *= albedo(walker.x);
    const double weighted_importance = walker.weight * importance(walker.x);
    if (weighted_importance < 0.5) {
      walker.weight /= weighted_importance;
      return random.uniform() < weighted_importance;
    }
    if (weighted_importance < 2 || steps_ > last_splitting_) return true;
    constexpr double most_copies = 1000;
    const double copies = std::min(weighted_importance, most_copies);
    walker.weight /= copies;
    walker.copies = static_cast<std::uint32_t>(copies + random.uniform());
    waiting_.push_back(walker);
    scorer.keep();
    return false;
  }

  /// Scores the path that ends at a walker. Expected contributions below the score level undergo
  /// systematic Russian roulette: the ratios of contribution to score level are summed, and
  /// whenever the sum passes a whole number, one path is scored with a weight that represents all
  /// paths since the last one.
  void score(const Walker& walker, PathScorer& scorer) {
    double contribution = expected(walker.x, walker.arrival), backward_density = 0;
    if (plan_.reversed) {
      backward_density = first_.density(walker.x, -walker.arrival, scattering_);
      // The density of each flight contains mu_t at its end. A flight of the reversed path ends at
      // the first scatterer, but none ends at the last scatterer.
      if constexpr (varies<Scattering>) {
        const double mu_t = profile_->mu_t(walker.x);
        backward_density *= mu_t > 0 ? profile_->mu_t(path_.first) / mu_t : 0;
      }
      const double forward = start_density();
      contribution = (forward * contribution + backward_density * expected_first_) /
                     (forward + backward_density);
    }
    double weight = walker.weight;
    if (!survives(contribution * weight / plan_.score_level, weight)) return;
    path_.last = walker.x;
    path_.arrival = walker.arrival;
    path_.weight =
        mu_s(path_.first) * albedo(walker.x) * weight / (start_density() + backward_density);
    const double all_waves = path_.weight;
    for (const auto& [waves, probability] : plan_.waves) {
      path_.weight = all_waves;
      if (!survives(wave_ticket_, probability, path_.weight)) continue;
      path_.waves = waves;
      scorer.multiple(path_);
      path_.new_start = plan_.waves.size() > 1;
    }
  }

  /// Scores a path of one scatterer, with a weight in the same units as in score().
  void score_single(Vec x, Vec light, PathScorer& scorer) {
    double weight = mu_s(x) / first_.density(x);
    if (plan_.single_roulette && albedo(x) > 0 &&
        !survives(expected_view_(x, light) / (albedo(x) * plan_.score_level), weight))
      return;
    for (const auto& [waves, probability] : plan_.waves)
      if (double own = weight; survives(wave_ticket_, probability, own))
        scorer.single(x, own, waves);
  }

  /// Applies systematic Russian roulette with this survival probability. Returns whether the
  /// contribution survives; the weight of a survivor is divided by the probability. sum: fraction
  /// of the sum of all survival probabilities; decisions that depend on each other need separate
  /// sums.
  static bool survives(double& sum, double probability, double& weight) {
    if (probability >= 1) return true;
    sum += probability;
    if (sum < 1) return false;
    sum -= 1;
    weight /= probability;
    return true;
  }
  bool survives(double probability, double& weight) {
    return survives(ticket_, probability, weight);
  }

  /// Returns the importance of x relative to that of the first scatterer, so that a walk that
  /// begins at a great depth is not split at once.
  double importance(Vec x) const {
    constexpr double largest_log = 600;  // logarithm whose exp is finite
    return std::exp(std::min(importance_.log_importance(x.z) - log_importance_first_, largest_log));
  }

  /// Returns the expected contribution of a path that ends at x, for a walker of unit weight. It is
  /// multiplied by the importance at x, because walkers there have typically the weight 1 /
  /// importance.
  double expected(Vec x, Vec arrival) const {
    const double value = expected_view_(x, arrival);
    return plan_.weighted ? value * importance(x) : value;
  }

  /// Returns the joint density of the first scatterer of the walk and the direction after it. It is
  /// computed on first use, because many walks score no path.
  double start_density() {
    if (start_density_ < 0) start_density_ = first_.density(path_.first, start_, scattering_);
    return start_density_;
  }

  const Plan& plan_;
  Domain domain_;
  const BulkMedium& medium_;
  const MediumProfile* profile_;  ///< null if the medium is homogeneous
  const Scattering& scattering_;
  std::optional<Faces> faces_;
  DiffusionImportance importance_;
  First first_;
  ExpectedContribution expected_view_;
  std::vector<Walker> waiting_;
  bool has_tally_ = false;
  Vec start_;
  Path path_;
  double start_density_ = -1, log_importance_first_ = 0, expected_first_ = 0;
  /// fraction of the sum of survival probabilities; a path survives when it reaches 1
  double ticket_ = 0, wave_ticket_ = 0;  // wave_ticket_: of the waves of a path
  std::uint64_t steps_ = 0, last_splitting_ = 0;
};

template <typename Scattering>
class WalksBy final : public PathWalks {
 public:
  WalksBy(const Scene& scene, const Plan& plan, std::uint64_t seed, const Scattering& scattering)
      : PathWalks(scene, plan, seed),
        scattering_(scattering),
        inside_(inside_faces(scene)),
        walk_(inside_, plan_, scattering_) {}

  void batch(std::uint64_t number, PathScorer& scorer) const override {
    RandomStream random(seed_, static_cast<std::uint64_t>(Stream::light_paths), number);
    auto own = walk_;
    own.begin(random);
    for (std::uint64_t path = 0; path < plan_.paths_per_batch; ++path) own.walk(random, scorer);
  }

  Complex amplitude(Vec x, Vec from, Vec to) const override {
    return local(scattering_, x).amplitude(from, to);
  }
  void towards(Vec x, Vec from, const Directions& to, std::span<Complex> out) const override {
    local(scattering_, x).towards(from, to, out);
  }
  std::unique_ptr<EndpointFactors> factors(const Scene& scene,
                                           const std::vector<Endpoint>& endpoints,
                                           bool phases) const override {
    if constexpr (bends<Scattering>)
      return std::make_unique<GradedEndpoints>(scene, endpoints, phases, scattering_.medium());
    if (scene.faces) return std::make_unique<FacedEndpoints>(scene, endpoints, phases);
    return std::make_unique<StraightEndpoints>(scene, endpoints, phases);
  }

 private:
  const Scattering scattering_;
  const Scene inside_;  ///< the scene with the directions inside the faces
  const PathWalk<Scattering> walk_;
};

/// Calls f with the scattering object of any scene, of the type that `phase` selects.
template <typename F>
void with_any_scattering(const Scene& scene, Plan::Phase phase, F f) {
  if (phase == Plan::Phase::varying) return f(varying_scattering(scene));
  if (phase == Plan::Phase::graded) return f(graded_scattering(scene));
  with_scattering(scene, phase, f);
}

}  // namespace

std::vector<Complex> sphere_amplitudes(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  if (medium.has_scatterers) return correlated_amplitudes_in_space(medium, scene.k);
  const auto intervals =
      16384 * (1 + static_cast<std::size_t>(scene.k * scene.scatterer.radius / 10));
  std::vector<Complex> values;
  for (std::size_t i = 0; i <= intervals; ++i)
    values.emplace_back(std::sqrt(medium.space_phase.density(
        std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(intervals)))));
  return values;
}

VaryingScattering varying_scattering(const Scene& scene) {
  std::vector<AnyScattering> forms;
  for (const Material& material : scene.profile->materials()) {
    Scene own = scene;
    own.scatterer = material.scatterer;
    own.medium = material.medium;
    with_scattering(own, phase_of(own),
                    [&](const auto& scattering) { forms.emplace_back(scattering); });
  }
  return {*scene.profile, std::move(forms)};
}

GradedScattering graded_scattering(const Scene& scene) {
  std::vector<GradedScattering> made;
  const auto medium = graded_medium(scene);
  check_graded_endpoints(scene, *medium);
  with_scattering(scene, phase_of(scene), [&](const auto& scattering) {
    made.emplace_back(AnyScattering(scattering), medium);
  });
  return made.front();
}

std::shared_ptr<const PathWalks> path_walks(const Scene& scene, const Plan& plan,
                                            std::uint64_t seed) {
  require_walks(scene, plan.weighted);
  refuse_unpolarised(scene);
  std::shared_ptr<const PathWalks> walks;
  if (scene.medium.mu_s == 0) return walks;
  with_any_scattering(scene, plan.phase, [&]<typename Scattering>(const Scattering& scattering) {
    walks = std::make_shared<const WalksBy<Scattering>>(scene, plan, seed, scattering);
  });
  return walks;
}

}  // namespace flatspeckle::mc
