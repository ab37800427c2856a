// Slabs without chance.

#include "bench/plan/plan_rooms.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/standard_scenes.h"
#include "mc/slab/adding/space_scene.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::bench {

namespace {

constexpr double tolerance = 1e-6, in_space_tolerance = 1e-3;

Scene with_entries(Scene scene, std::vector<Entry> entries) {
  scene.request.entries = std::move(entries);
  return scene;
}

std::vector<Complex> covariance(const Scene& slab, const mc::FieldChange& change = {}) {
  return mc::slab_covariance(slab, false, {tolerance}, change).value;
}

std::vector<Complex> covariance_in_space(const Scene& slab) {
  return mc::slab_covariance(slab, false, {in_space_tolerance}).value;
}

/// What tilts share, done again for each.
std::vector<Complex> one_by_one(const Scene& slab,
                                std::vector<Complex> (*covariance_of)(const Scene&)) {
  std::vector<Complex> values;
  for (const Entry& entry : slab.request.entries)
    values.push_back(covariance_of(with_entries(slab, {entry})).front());
  return values;
}

PlanRow tilts_alone(const Scene& slab, double cpu_seconds) {
  PlanRow row{.per = "solution"};
  const auto of = [](const Scene& scene) { return covariance(scene); };
  compare_values(
      row, [&] { return one_by_one(slab, of); }, [&] { return covariance(slab); }, tolerance,
      cpu_seconds);
  return row;
}

PlanRow tilts_alone_in_space(const Scene& slab, double cpu_seconds) {
  PlanRow row{.per = "solution"};
  compare_values(
      row, [&] { return one_by_one(slab, covariance_in_space); },
      [&] { return covariance_in_space(slab); }, in_space_tolerance, cpu_seconds);
  return row;
}

/// Complex numbers throughout.
PlanRow second_frequency(const Scene& slab, double cpu_seconds) {
  PlanRow row{.per = "solution"};
  compare_values(
      row, [&] { return covariance(slab, {.shift = 1e-14}); }, [&] { return covariance(slab); },
      tolerance, cpu_seconds);
  return row;
}

PlanRow derivatives(const Scene& slab, double cpu_seconds) {
  PlanRow row{.per = "solution"};
  const auto with_slopes = [&] {
    auto values = mc::slab_slopes(slab, false, {tolerance}, mc::BulkParameter::mu_t).value;
    values.resize(slab.request.entries.size());
    return values;
  };
  compare_values(
      row, with_slopes, [&] { return covariance(slab); }, tolerance, cpu_seconds);
  return row;
}

}  // namespace

std::vector<PlanCase> transport_plan_cases() {
  const Scene slab = standard_scenes()[5].scene;
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = 0.9;
  Scene few = slab;
  few.request.entries.resize(8);
  const Scene space = mc::in_space(few, spec);
  const std::string room = "transport", plane = "slab_hg g 0.9, 64 tilts";
  const auto on = [](const Scene& scene, PlanRow (*row)(const Scene&, double)) {
    return [=](double cpu_seconds) { return row(scene, cpu_seconds); };
  };
  return {named(room, "tilts one by one", plane, on(slab, tilts_alone)),
          named(room, "tilts one by one", "slab_hg g 0.9, 8 tilts in space",
                on(space, tilts_alone_in_space)),
          named(room, "a second frequency", plane, on(slab, second_frequency)),
          named(room, "derivatives", plane, on(slab, derivatives))};
}

}  // namespace flatspeckle::bench
