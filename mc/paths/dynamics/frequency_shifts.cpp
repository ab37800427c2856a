#include "mc/paths/dynamics/frequency_shifts.h"

#include <cmath>
#include <complex>
#include <memory>

#include "flatland/scene/frequency_shift.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/path_fields.h"
#include "mc/paths/estimators/single_scattering.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Total length of the flights between scatterers.
struct LengthTally {
  double length = 0;

  void flight(Vec /*from*/, Vec /*w*/, double r) { length += r; }
  void scattering(Vec /*x*/, Vec /*from*/, Vec /*to*/) {}
};

std::vector<Scene> shifted_scenes(const Scene& scene, const std::vector<double>& shifts) {
  std::vector<Scene> scenes;
  for (const double shift : shifts) scenes.push_back(at_frequency(scene, shift));
  return scenes;
}

/// Adds weight f_a conj(f_b) for every entry; then, for each shifted frequency, weight f_a
/// conj(f_b) with f_b at that frequency, for the first changing_entries() entries.
class FrequencyScorer : public TallyScorer<LengthTally> {
 public:
  FrequencyScorer(const PathWalks& walks, const std::vector<Scene>& shifted,
                  std::span<Complex> sums)
      : TallyScorer(LengthTally{}),
        entries_(walks.scene().request.entries),
        changing_(changing_entries(walks.scene().request)),
        sums_(sums),
        fields_(walks, walks.scene(), true) {
    for (const Scene& other : shifted)
      others_.push_back({PathFields(walks, other, true), walks.scene().k - other.k});
  }

  /// Scores the path of one scatterer at x.
  void single(Vec x, double weight, FaceWaves waves) override {
    score(weight, 0, [&](PathFields& fields) { return fields.single(x, waves); });
  }
  void multiple(const Path& path) override {
    score(path.weight, tally().length, [&](PathFields& fields) { return fields.multiple(path); });
  }

 private:
  struct Other {
    PathFields fields;
    double lag;  ///< k1 - k2: wavenumber of the first field minus that of the second
  };

  template <typename FieldOf>
  void score(double weight, double length, FieldOf field_of) {
    const std::span<const Complex> first = field_of(fields_);
    for (std::size_t e = 0; e < entries_.size(); ++e)
      sums_[e] += weight * product_with_conjugate(first[entries_[e].a], first[entries_[e].b]);
    Complex* sum = &sums_[entries_.size()];
    for (auto& [fields, lag] : others_) {
      const std::span<const Complex> second = field_of(fields);
      const Complex turned = std::polar(weight, lag * length);
      for (std::size_t e = 0; e < changing_; ++e)
        sum[e] += product(turned, product_with_conjugate(first[entries_[e].a], second[e]));
      sum += entries_.size();
    }
  }

  const std::vector<Entry>& entries_;
  std::size_t changing_;
  std::span<Complex> sums_;
  PathFields fields_;
  std::vector<Other> others_;
};

/// Returns the contribution of paths of one scatterer to the quantities of frequency_job(), in
/// closed form.
Values single_covariances(const PathWalks& walks, const std::vector<Scene>& shifted) {
  const Scene& scene = walks.scene();
  Values all = single_scattering(scene, walks);
  const auto& entries = scene.request.entries;
  for (const Scene& other : shifted) {
    Values values(entries.size());
    for_entries(changing_entries(scene.request), [&](std::size_t e) {
      values[e] =
          single_scattering(scene, walks, FarField(scene, entries[e].a), FarField(other, e));
    });
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

}  // namespace

Plan frequency_plan(const Scene& scene, ReversedPaths reversed) {
  Plan plan = make_plan(scene, reversed);
  plan.phases = true;
  return plan;
}

PathJob frequency_job(const Scene& scene, const Plan& plan, const std::vector<double>& shifts,
                      std::uint64_t seed) {
  const auto shifted = std::make_shared<const std::vector<Scene>>(shifted_scenes(scene, shifts));
  PathJob job =
      path_job({1 + shifts.size(),
                [shifted](const PathWalks& walks, std::span<Complex> sums) {
                  return std::make_unique<FrequencyScorer>(walks, *shifted, sums);
                },
                [shifted](const PathWalks& walks) { return single_covariances(walks, *shifted); }},
               scene, plan, seed);
  job.field.batches.relative_error = relative_error_of(job.all);
  return job;
}

}  // namespace flatspeckle::mc
