#include <cmath>

#include <doctest/doctest.h>

#include "mc/paths/estimators/path_power.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_path_power {

namespace {

using tests::pi;

constexpr std::uint64_t paths = 20000;

/// Walks whose weights have a planted factor per path and one per inner scatterer.
class PlantedWalks : public PathWalks {
 public:
  PlantedWalks(std::shared_ptr<const PathWalks> walks, double factor, double inner)
      : PathWalks(walks->scene(), walks->plan(), 1),
        walks_(walks),
        factor_(factor),
        inner_(inner) {}

  void batch(std::uint64_t number, PathScorer& scorer) const override {
    Planted planted(scorer, factor_, inner_);
    walks_->batch(number, planted);
  }
  Complex amplitude(Vec x, Vec from, Vec to) const override {
    return walks_->amplitude(x, from, to);
  }
  void towards(Vec x, Vec from, const Directions& to, std::span<Complex> out) const override {
    walks_->towards(x, from, to, out);
  }
  std::unique_ptr<EndpointFactors> factors(const Scene& scene,
                                           const std::vector<Endpoint>& endpoints,
                                           bool phases) const override {
    return walks_->factors(scene, endpoints, phases);
  }

 private:
  class Planted : public PathScorer {
   public:
    Planted(PathScorer& scorer, double factor, double inner)
        : scorer_(scorer), factor_(factor), inner_(inner) {}

    void single(Vec x, double weight, FaceWaves waves) override {
      scorer_.single(x, factor_ * weight, waves);
    }
    void multiple(const Path& path) override {
      Path changed = path;
      changed.weight *= factor_ * std::pow(inner_, steps_);
      scorer_.multiple(changed);
    }
    bool has_tally() const override { return true; }
    void begin(Vec x, Vec w, double length) override {
      steps_ = 0;
      scorer_.begin(x, w, length);
    }
    void step(Vec x, Vec from, Vec to, double length) override {
      ++steps_;
      scorer_.step(x, from, to, length);
    }

   private:
    PathScorer& scorer_;
    double factor_, inner_;
    int steps_ = 0;
  };

  std::shared_ptr<const PathWalks> walks_;
  double factor_, inner_;
};

}  // namespace

TEST_CASE("path power: equals the extinction in slabs, boxes and layers") {
  const auto request = intensity_request({0.3, -0.9}, tests::far_views({0}));
  const Scene scenes[] = {tests::hg_slab(10, {5, 0}, request),
                          tests::hg_slab(10, {1, 0.9}, request),
                          tests::hg_slab(10, {2, 0.5, 0.7}, request),
                          tests::hg_box(20, 10, {4, -0.4, 0.9}, request),
                          tests::hg_box(20, 10, {1e6, 0.9}, request),
                          tests::layered({{3, 2, 0.5, 0.9}, {4, 0.5, 0, 0.6}}, request)};
  for (const Scene& scene : scenes) {
    CAPTURE(scene.medium.mu_t);
    const PathPower found = path_power(power_walks(scene, 3), paths);
    for (const Invariant& one : {found.first, found.second, found.later}) CHECK(one.holds());
    for (const Invariant& one : {found.first, found.second}) CHECK(one.limit < 0.006);
    CHECK(found.later.limit < 0.06);
  }
}

TEST_CASE("path power: detects a planted factor of 1.01 in the weights") {
  const auto request = intensity_request({0.3}, tests::far_views({0}));
  for (const Scene& scene :
       {tests::hg_slab(10, {5, 0.5}, request), tests::hg_slab(10, {5, 0, 0.8}, request),
        tests::hg_box(20, 10, {3, 0.8}, request)}) {
    const auto walks = power_walks(scene, 3);
    const auto planted = path_power(std::make_shared<PlantedWalks>(walks, 1.01, 1), paths);
    CHECK(!planted.first.holds());
    CHECK(!planted.second.holds());
  }
  const auto deep = power_walks(tests::hg_slab(10, {1, 0}, request), 3);
  const auto inner = path_power(std::make_shared<PlantedWalks>(deep, 1, 1.01), paths);
  CHECK(!inner.later.holds());
}

TEST_CASE("path power: requires plane waves and scattering") {
  const auto request = intensity_request({0}, tests::far_views({0}));
  CHECK(power_walks(tests::hg_slab(10, {4, 0, 0}, request), 1) == nullptr);
  const auto near = intensity_request({point_source({0, -5})}, tests::far_views({0}));
  CHECK(power_walks(tests::hg_box(20, 10, {4}, near), 1) == nullptr);
}

}  // namespace flatspeckle::mc::test_path_power
