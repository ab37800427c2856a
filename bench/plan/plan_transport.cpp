// Comparisons for deterministic transport through slabs.

#include "bench/plan/plan_timing.h"
#include "bench/scenes/standard_scenes.h"
#include "mc/distance/distance_job.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::bench {

namespace {

constexpr double tolerance = 1e-6, in_space_tolerance = 1e-3;

std::vector<Complex> covariance(const Scene& slab, const mc::FieldChange& change = {}) {
  return mc::slab_covariance(slab, false, {tolerance}, change).value;
}

std::vector<Complex> covariance_in_space(const Scene& slab) {
  return mc::slab_covariance(slab, false, {in_space_tolerance}).value;
}

/// Solves transport separately for each tilt, repeating work that all tilts share.
template <class CovarianceOf>
std::vector<Complex> one_by_one(const Scene& slab, const CovarianceOf& covariance_of) {
  std::vector<Complex> values;
  Scene single = slab;
  for (const Entry& entry : slab.request.entries) {
    single.request.entries = {entry};
    values.push_back(covariance_of(single).front());
  }
  return values;
}

/// Solves transport with faces that hardly reflect.
std::vector<Complex> with_faces(Scene slab) {
  slab.faces = Faces{1, 1 + 1e-12};
  return covariance(slab);
}

std::vector<Complex> with_derivatives(const Scene& slab) {
  auto values = mc::slab_derivatives(slab, false, {tolerance}, mc::BulkParameter::mu_t).value;
  values.resize(slab.request.entries.size());
  return values;
}

/// Solves for g1 at two distances. gradient: whether derivatives by the coefficients, from which
/// the error of the flow is computed, are also found.
std::vector<Complex> distant(const Scene& slab, bool gradient) {
  mc::DistanceRequest request;
  for (const double distance : {1000.0, 3000.0})
    request.detectors.push_back({mc::DistanceDetector::Kind::ring, distance, 200});
  request.dynamics.delays = {1e-3, 1e-2};
  request.gradient = gradient;
  auto values = mc::distance_solution(slab, request, 1).value;
  values.resize(request.detectors.size() * (request.dynamics.delays.size() + 1));
  return values;
}

}  // namespace

std::vector<PlanCase> transport_plan_cases() {
  const Scene slab = slab_hg(0.9);
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = 0.9;
  Scene few = slab;
  few.request.entries.resize(8);
  const Scene space = mc::in_space(few, spec);
  const auto alone = [](const Scene& scene) { return covariance(scene); };
  const auto on_slab = [&](const std::string& left_out, const ValueFunction& general) {
    return case_of_values({"transport", left_out, "slab_hg g 0.9, 64 tilts", "solution"}, tolerance,
                          [=](bool) -> TwoAlternatives {
                            return {general, [=] { return alone(slab); }};
                          });
  };
  return {
      on_slab("tilts one by one", [=] { return one_by_one(slab, alone); }),
      case_of_values(
          {"transport", "tilts one by one", "slab_hg g 0.9, 8 tilts in space", "solution"},
          in_space_tolerance,
          [=](bool) -> TwoAlternatives {
            return {[=] { return one_by_one(space, covariance_in_space); },
                    [=] { return covariance_in_space(space); }};
          }),
      // a tiny frequency shift makes all numbers complex
      on_slab("a second frequency", [=] { return covariance(slab, {.shift = 1e-14}); }),
      on_slab("faces", [=] { return with_faces(slab); }),
      case_of_values(
          {"transport", "derivatives for the error of the flow",
           "slab_hg g 0.9 in space, two distances", "solution"},
          1e-9,
          [=](bool) -> TwoAlternatives {
            return {[=] { return distant(space, true); }, [=] { return distant(space, false); }};
          }),
      on_slab("derivatives", [=] { return with_derivatives(slab); })};
}

}  // namespace flatspeckle::bench
