#include "mc/paths/walk/walks.h"

#include "mc/paths/bent/graded_ends.h"
#include "mc/paths/endpoint_factors/space_scattering.h"
#include "mc/paths/walk/path_walk.h"
#include "mc/paths/walk/scene_scattering.h"

namespace flatspeckle::mc {

namespace {

template <typename Scattering>
class ScatteringAtEnds final : public EndScattering {
 public:
  explicit ScatteringAtEnds(const Scattering& scattering) : scattering_(scattering) {}

  const Scattering& form() const { return scattering_; }

  Complex amplitude(Vec2 x, Vec2 from, Vec2 to) const override {
    return local(scattering_, x).amplitude(from, to);
  }
  void towards(Vec2 x, const SpaceDirection& from, const Directions& to,
               std::span<Complex> out) const override {
    local(scattering_, x).towards(from, to, out);
  }
  std::unique_ptr<EndFactors> factors(const Scene& scene, const std::vector<End>& ends,
                                      bool phases) const override {
    if constexpr (bends<Scattering>)
      return std::make_unique<GradedEnds>(scene, ends, phases, scattering_.medium());
    else
      return std::make_unique<StraightEnds>(scene, ends, phases);
  }

 private:
  const Scattering scattering_;
};

template <typename Scattering>
class WalksBy final : public PathWalks {
 public:
  WalksBy(const Scene& scene, const Plan& plan, std::uint64_t seed, const Scattering& scattering)
      : PathWalks(scene, plan, seed),
        scattering_(scattering),
        walk_(scene_, plan_, scattering_.form()) {}

  const EndScattering& scattering() const override { return scattering_; }

  void batch(std::uint64_t number, PathScorer& scorer) const override {
    RandomStream random(seed_, static_cast<std::uint64_t>(Stream::light_paths), number);
    auto own = walk_;
    own.begin(random);
    for (std::uint64_t path = 0; path < plan_.paths_per_batch; ++path) own.walk(random, scorer);
  }

 private:
  const ScatteringAtEnds<Scattering> scattering_;
  const PathWalk<Scattering> walk_;
};

/// Calls f with the scattering of any scene.
template <typename F>
void with_any_scattering(const Scene& scene, Plan::Phase phase, F f) {
  if (phase == Plan::Phase::varying) return f(varying_scattering(scene));
  if (phase == Plan::Phase::graded) return f(graded_scattering(scene));
  if (phase == Plan::Phase::space) return f(SpaceScattering(scene.medium.space_phase));
  with_scattering(scene, phase, f);
}

}  // namespace

VaryingScattering varying_scattering(const Scene& scene) {
  std::vector<AnyScattering> forms;
  for (const Material& material : scene.profile->materials()) {
    Scene own = scene;
    own.scatterer = material.scatterer;
    own.medium = material.medium;
    with_scattering(own, phase_of(own.scatterer),
                    [&](const auto& scattering) { forms.emplace_back(scattering); });
  }
  return {*scene.profile, std::move(forms)};
}

GradedScattering graded_scattering(const Scene& scene) {
  std::vector<GradedScattering> made;
  const auto medium = graded_medium(scene);
  check_graded_ends(scene, *medium);
  with_scattering(scene, phase_of(scene.scatterer), [&](const auto& scattering) {
    made.emplace_back(AnyScattering(scattering), medium);
  });
  return made.front();
}

std::shared_ptr<const PathWalks> path_walks(const Scene& scene, const Plan& plan,
                                            std::uint64_t seed) {
  require_walks(scene, plan.weighted);
  std::shared_ptr<const PathWalks> walks;
  if (scene.medium.mu_s == 0) return walks;
  with_any_scattering(scene, plan.phase, [&]<typename Scattering>(const Scattering& scattering) {
    walks = std::make_shared<const WalksBy<Scattering>>(scene, plan, seed, scattering);
  });
  return walks;
}

}  // namespace flatspeckle::mc
