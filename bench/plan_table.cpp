// What each thing that a plan leaves out saves: the general kernel against the specialised one on
// the same batches, in turn on one thread; medians of the time per path. Where both draw the same
// random numbers, the results agree to rounding; where they cannot, within 4 standard errors. Else
// the exit status is 1.
//
//   bench_plan [rounds]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "bench/contest.h"
#include "bench/standard_scenes.h"
#include "core/stopwatch.h"
#include "mc/covariance_estimator.h"

using namespace flatspeckle;
using namespace flatspeckle::bench;

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::uint64_t seed = 1;

/// An estimator as the benchmark sees it.
struct Kernel {
  FieldJob job;
  GroupedSums sums{job.batches.size};
  std::vector<double> seconds_per_path{};

  void run(std::uint64_t batches) {
    std::vector<Complex> out(job.batches.size);
    const double start = thread_cpu_seconds();
    for (std::uint64_t b = 0; b < batches; ++b) {
      std::fill(out.begin(), out.end(), 0);
      job.batches.run(sums.batches(), out);
      sums.add(job.batches.samples_per_batch, out);
    }
    seconds_per_path.push_back((thread_cpu_seconds() - start) /
                               (static_cast<double>(batches) * job.batches.samples_per_batch));
  }
  Estimate estimate() const { return jackknife(sums, job.covariance); }
};

struct Comparison {
  std::string left_out, on;
  Kernel general, special;
  bool same_numbers;  ///< both draw the same random numbers
};

mc::Plan plan_of(const Scene& scene) {
  return mc::make_plan(scene, mc::ReversedPaths::no);
}

/// The kernel that a scene would have against the one that `generalise` makes of its plan.
template <typename F>
Comparison comparison(std::string left_out, std::string on, const Scene& scene, bool same_numbers,
                      F generalise) {
  mc::Plan general = plan_of(scene);
  generalise(general);
  return {std::move(left_out),
          std::move(on),
          {mc::covariance_job(scene, general, seed)},
          {mc::covariance_job(scene, plan_of(scene), same_numbers ? seed : seed + 1)},
          same_numbers};
}

/// Listed entries against the whole matrix of their channels.
Comparison few_pairs(const Scene& listed) {
  mc::Plan special = plan_of(listed);
  Scene whole = listed;
  whole.request.kind = CovarianceRequest::Kind::full;
  whole.request.entries.clear();
  const auto channels = static_cast<std::uint32_t>(whole.request.channels.size());
  for (std::uint32_t a = 0; a < channels; ++a)
    for (std::uint32_t b = 0; b <= a; ++b) whole.request.entries.push_back({a, b});
  mc::Plan general = plan_of(whole);
  special.sampled_single = general.sampled_single = true;
  special.paths_per_batch = general.paths_per_batch;
  FieldJob job = mc::covariance_job(whole, general, seed);
  job.covariance = [all = job.covariance, entries = listed.request.entries](
                       double samples, std::span<const Complex> sums) {
    const auto matrix = all(samples, sums);
    std::vector<Complex> picked;
    for (const auto [a, b] : entries)
      picked.push_back(a >= b ? matrix[a * (a + 1) / 2 + b]
                              : std::conj(matrix[b * (b + 1) / 2 + a]));
    return picked;
  };
  return {"the rest of the matrix",
          "box_points, 64 tilts",
          {std::move(job)},
          {mc::covariance_job(listed, special, seed)},
          true};
}

Scene with_request(Scene scene, CovarianceRequest request) {
  scene.request = std::move(request);
  return scene;
}

std::vector<View> views_around(int count) {
  std::vector<View> views;
  for (int v = 0; v < count; ++v) views.push_back(far_view(2 * pi * (v + 0.5) / count));
  return views;
}

std::vector<Comparison> comparisons() {
  using mc::Plan;
  const auto standard = standard_scenes();
  const Scene points = standard[0].scene, slab = standard[4].scene;
  const Scene around = with_request(points, intensity_request({0}, views_around(64)));
  const Scene full = with_request(points, full_request({0, 0.1}, views_around(64)));
  std::vector<Comparison> rows;
  rows.push_back(comparison("anisotropy", "box_points, 64 tilts", points, false,
                            [](Plan& plan) { plan.phase = Plan::Phase::henyey_greenstein; }));
  rows.push_back(comparison("tabulated amplitude", "box_points, 64 tilts", points, false,
                            [](Plan& plan) { plan.phase = Plan::Phase::tabulated; }));
  rows.push_back(comparison("near ends", "box_points, 64 tilts", points, true,
                            [](Plan& plan) { plan.near = true; }));
  rows.push_back(comparison("absorption", "box_points, 64 tilts", points, false,
                            [](Plan& plan) { plan.weighted = true; }));
  rows.push_back(comparison("reversed paths", "slab_hg g 0, 64 tilts", slab, false,
                            [](Plan& plan) { plan.reversed = true; }));
  rows.push_back(comparison("phases", "box_points, 64 intensities", around, true,
                            [](Plan& plan) { plan.phases = true; }));
  rows.push_back(few_pairs(points));
  rows.push_back(comparison("entry by entry", "box_points, full, 128 channels", full, true,
                            [](Plan& plan) { plan.rank_k = false; }));
  return rows;
}

double largest_difference(const Estimate& a, const Estimate& b) {
  double difference = 0, largest = 0;
  for (std::size_t e = 0; e < a.value.size(); ++e) {
    difference = std::max(difference, std::abs(a.value[e] - b.value[e]));
    largest = std::max(largest, std::abs(b.value[e]));
  }
  return difference / largest;
}

double most_sigma(const Estimate& a, const Estimate& b) {
  double most = 0;
  for (std::size_t e = 0; e < a.value.size(); ++e)
    most = std::max(most, std::abs(a.value[e] - b.value[e]) / std::hypot(a.error[e], b.error[e]));
  return most;
}

/// Whether the results agree.
bool print_row(Comparison& row, int rounds) {
  Kernel &general = row.general, &special = row.special;
  constexpr std::uint64_t batches = 40;
  std::vector<double> ratio;
  for (int round = 0; round < rounds; ++round) {
    general.run(batches);
    special.run(batches);
    ratio.push_back(general.seconds_per_path.back() / special.seconds_per_path.back());
  }
  const Estimate a = general.estimate(), b = special.estimate();
  const double difference = row.same_numbers ? largest_difference(a, b) : most_sigma(a, b);
  const bool same = difference < (row.same_numbers ? 1e-12 : 4);
  std::printf("%-24s %-34s %9.3f %9.3f %7.2f  %.2g %s %s\n", row.left_out.c_str(), row.on.c_str(),
              1e6 * median(general.seconds_per_path), 1e6 * median(special.seconds_per_path),
              median(ratio), difference, row.same_numbers ? "of the largest" : "standard errors",
              same ? "" : "DIFFERENT");
  std::fflush(stdout);
  return same;
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 9;
  std::printf("microseconds per path, one thread, medians of %d\n%-24s %-34s %9s %9s %7s  %s\n",
              rounds, "left out", "scene", "general", "special", "ratio", "difference");
  bool same = true;
  for (Comparison& row : comparisons()) same = print_row(row, rounds) && same;
  return same ? 0 : 1;
}
