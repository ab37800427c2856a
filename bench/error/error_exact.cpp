#include "bench/error/error_exact.h"

#include <cmath>
#include <memory>

#include "core/numbers/random.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::bench {

namespace {

constexpr double tolerance = 1e-2;  // fields are then off by 3e-4, far below any ensemble here

wave::FieldPlan field_plan(const Scene& scene) {
  const Domain& box = scene.domain;
  const double radius = std::hypot(box.width, box.depth) / 2 + scene.scatterer.disk_radius();
  return wave::make_field_plan(scene.request.lights, scene.request.views, scene.k,
                               {{0, box.depth / 2}, radius}, tolerance);
}

// (sum u_a u_b* - sum u_a sum u_b* / n) / (n - 1), n > 1
std::vector<Complex> sample_covariance(const CovarianceRequest& request, double n,
                                       std::span<const Complex> sums) {
  std::vector<Complex> covariance;
  for (std::size_t i = 0; i < request.entries.size(); ++i) {
    const auto [a, b] = request.entries[i];
    const Complex product = sums[request.channels.size() + i];
    covariance.push_back((product - sums[a] * std::conj(sums[b]) / n) / (n - 1));
  }
  return covariance;
}

}  // namespace

FieldJob exact_job(const Scene& original, wave::Method solver, std::uint64_t seed) {
  const auto scene = std::make_shared<const Scene>(original);
  const auto plan = std::make_shared<const wave::FieldPlan>(field_plan(original));
  const wave::SolveOptions options{
      .tolerance = tolerance, .sensors = {}, .diagnose = false, .method = solver};
  FieldJob job;
  job.covariance = [scene](double samples, std::span<const Complex> sums) {
    return sample_covariance(scene->request, samples, sums);
  };
  const std::size_t channels = original.request.channels.size();
  job.batches.size = channels + original.request.entries.size();
  job.batches.run = [=](std::uint64_t number, std::span<Complex> sums) {
    const CovarianceRequest& request = scene->request;
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::placement), number);
    const Placement placement =
        draw_placement(scene->domain, scene->scatterer, scene->placement, random);
    const auto fields = wave::scattered_fields(placement, scene->k, *plan, options);
    const auto field = [&](std::size_t channel) {
      const auto [light, view] = request.channels[channel];
      return fields[light * request.views.size() + view];
    };
    for (std::size_t c = 0; c < channels; ++c) sums[c] += field(c);
    for (std::size_t i = 0; i < request.entries.size(); ++i)
      sums[channels + i] +=
          product_with_conjugate(field(request.entries[i].a), field(request.entries[i].b));
  };
  return job;
}

}  // namespace flatspeckle::bench
