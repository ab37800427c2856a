#include "mc/changes/frequency_shifts.h"

#include <cmath>

#include "core/result/result_group.h"
#include "flatland/scene/frequency_shift.h"
#include "mc/estimators/path_fields.h"
#include "mc/estimators/single_scattering.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Length of the flights between scatterers.
struct LengthTally {
  double length = 0;

  template <typename Direction>
  void flight(Vec2 /*from*/, const Direction& /*w*/, double r) {
    length += r;
  }
  template <typename Direction>
  void scattering(Vec2 /*x*/, const Direction& /*from*/, const Direction& /*to*/) {}
};

std::vector<Scene> shifted_scenes(const Scene& scene, const std::vector<double>& shifts) {
  std::vector<Scene> scenes;
  for (const double shift : shifts) scenes.push_back(at_frequency(scene, shift));
  return scenes;
}

/// Adds weight f_a conj(f_b) per entry, then with f_b at each shifted frequency.
template <typename Scattering, bool reversed>
class FrequencyScorer {
  using Fields = PathFields<Scattering, reversed, true>;

 public:
  FrequencyScorer(const Scene& scene, const Scattering& scattering,
                  const std::vector<Scene>& shifted, std::span<Complex> sums)
      : entries_(scene.request.entries),
        changing_(changing_entries(scene.request)),
        sums_(sums),
        fields_(scene, scattering) {
    for (const Scene& other : shifted)
      others_.push_back({Fields(other, scattering), scene.k - other.k});
  }

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    score(weight, 0, [&](Fields& fields) { return fields.single(x); });
  }
  void multiple(const TalliedPath<typename Scattering::Direction, LengthTally>& path) {
    score(path.weight, path.tally.length, [&](Fields& fields) { return fields.multiple(path); });
  }

 private:
  struct Other {
    Fields fields;
    double lag;  ///< k1 - k2
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
  Fields fields_;
  std::vector<Other> others_;
};

struct FrequencyKind {
  using Sums = std::span<Complex>;
  std::vector<Scene> shifted;

  std::size_t quantities() const { return 1 + shifted.size(); }

  LengthTally tally(const Scene&) const { return {}; }

  template <bool reversed, bool phases, typename Scattering>
  auto scorer(const Scene& scene, const Scattering& scattering, Sums sums) const {
    return FrequencyScorer<Scattering, reversed>(scene, scattering, shifted, sums);
  }

  template <typename Scattering>
  Values single(const Scene& scene, const Scattering& scattering) const {
    Values all = single_scattering(scene, scattering);
    const auto& entries = scene.request.entries;
    for (const Scene& other : shifted) {
      Values values(entries.size());
      for_entries(changing_entries(scene.request), [&](std::size_t e) {
        values[e] =
            single_scattering(scene, scattering, FarField(scene, entries[e].a), FarField(other, e));
      });
      all.insert(all.end(), values.begin(), values.end());
    }
    return all;
  }
};

}  // namespace

Plan frequency_plan(const Scene& scene, ReversedPaths reversed) {
  Plan plan = make_plan(scene, reversed);
  plan.phases = true;
  return plan;
}

PathJob frequency_job(const Scene& scene, const Plan& plan, const std::vector<double>& shifts,
                      std::uint64_t seed) {
  PathJob job = path_job(FrequencyKind{shifted_scenes(scene, shifts)}, scene, plan, seed);
  job.field.batches.relative_error = relative_error_of(job.all);
  return job;
}

const DatasetTable frequency_table{
    "frequency shifts",
    {{"frequency_shift", Data::scale, "", "1", "of the second field, relative"},
     {"frequency_covariance", Data::complex_estimate, "frequency_shift LIGHT VIEW", "COVARIANCE",
      "covariance of the field with that at the shifted frequency"},
     {"frequency_correlation", Data::complex_estimate, "frequency_shift LIGHT VIEW", "1",
      "the same over the intensity"},
     {"frequency_diffusion_theory", Data::real, "frequency_shift", "1",
      "|frequency_correlation| of transmitted light in diffusion theory"},
     {"frequency_tilt_covariance", Data::complex_estimate, "frequency_shift tilt VIEW",
      "COVARIANCE", "covariance of the reference with the moved field at the shifted frequency"},
     {"frequency_tilt_correlation", Data::estimate, "frequency_shift tilt", "1",
      "C_E of the reference and the moved field at the shifted frequency"}}};

void write_shift_axis(ResultFile& file, const std::vector<double>& shifts) {
  ResultGroup(file, frequency_table).put("frequency_shift", shifts);
}

void write_frequency_shifts(ResultFile& file, const std::string& group, const Scene& scene,
                            const std::vector<double>& shifts, const ChangeEstimates& found) {
  const CovarianceRequest& request = scene.request;
  const ResultGroup results(file, frequency_table, group);
  const std::string name = request.has_reference() ? "frequency_tilt_" : "frequency_";
  results.put(name + "covariance", found.covariance);
  results.put(name + "correlation", found.correlation);
  if (request.has_reference() || scene.domain.kind != Domain::Kind::slab || scene.profile ||
      !request.transmission_only())
    return;
  results.put("frequency_diffusion_theory", column(shifts, [&](double shift) {
                return diffusion_frequency_correlation(scene, shift);
              }));
}

double diffusion_frequency_correlation(const Scene& slab, double shift) {
  const Complex absorption(0, slab.k * shift);
  const double per_loss = slab.medium.dimension / slab.medium.transport_mean_free_path();
  return std::abs(
      diffusion_loss_correlation(slab.medium, slab.domain.depth, per_loss * absorption));
}

}  // namespace flatspeckle::mc
