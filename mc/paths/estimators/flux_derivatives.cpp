#include <array>
#include <cmath>
#include <memory>

#include "core/run/interrupt.h"
#include "mc/paths/estimators/flux_walk.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/paths/walk/plan.h"
#include "mc/paths/walk/scene_scattering.h"

namespace flatspeckle::mc {

namespace {

constexpr std::uint64_t derivative_walks_per_batch = 400;
constexpr std::size_t exits = 2;  ///< reflected light and transmitted light

/// Input of a job, shared by all batches.
struct FluxDerivatives {
  Scene scene;
  std::vector<MediumDerivative> parameters;
};

/// Samples walks of one light, one after another.
template <typename Scattering>
class FluxDerivativeWalk {
 public:
  FluxDerivativeWalk(const FluxDerivatives& of, const Scattering& scattering, Vec light,
                     RandomStream& random)
      : of_(of),
        domain_(of.scene.domain),
        mu_t_(of.scene.medium.mu_t),
        scattering_(scattering),
        entry_(domain_, light, 0),
        random_(random) {}

  /// Samples a walk and adds it to the sums [1 + parameter][light][exit]. sums: begin at the entry
  /// of the first exit of this light. stride: distance in the sums between one parameter and the
  /// next.
  void walk(std::span<Complex> sums, std::size_t stride) {
    log_derivatives_ = {};
    Vec x = entry_.sample(random_), w = entry_.light();
    const grin::BoundedFlight first{mu_t_, domain_.distance_to_edge(x, w)};
    double weight = first.probability(), flight = first.sample(random_.uniform());
    while (true) {
      collide(flight);
      x = x + flight * w;
      weight *= std::min(1.0, of_.scene.medium.albedo);
      if (weight < 0.5) {
        if (random_.uniform() > weight) return;
        weight = 1;
      }
      const Vec from = w;
      w = scattering_.sample(from, random_);
      turn(from, w);
      const double edge = domain_.distance_to_edge(x, w);
      flight = grin::sample_free_flight(mu_t_, random_.uniform());
      if (flight >= edge) return leave(x + edge * w, w, edge, weight, sums, stride);
      if (++steps_ % 4096 == 0) stop_if_interrupted();
    }
  }

 private:
  void collide(double flight) {
    for (std::size_t p = 0; p < of_.parameters.size(); ++p)
      log_derivatives_[p] += of_.parameters[p].log_mu_t * (1 - mu_t_ * flight);
  }

  void turn(Vec from, Vec to) {
    for (std::size_t p = 0; p < of_.parameters.size(); ++p) {
      const MediumDerivative& derivative = of_.parameters[p];
      log_derivatives_[p] += derivative.log_albedo;
      if (derivative.amplitude.depends())
        log_derivatives_[p] += 2 * derivative.amplitude(from, to).real();
    }
  }

  void leave(Vec x, Vec w, double edge, double weight, std::span<Complex> sums,
             std::size_t stride) const {
    std::array<Complex, flux_shares + 1> shares{};
    FluxTally(of_.scene, shares).leave(x, w, weight);
    const double power[exits] = {shares[reflected].real(), shares[transmitted].real()};
    for (std::size_t end = 0; end < exits; ++end) {
      sums[end] += power[end];
      for (std::size_t p = 0; p < of_.parameters.size(); ++p)
        sums[(1 + p) * stride + end] +=
            power[end] * (log_derivatives_[p] - of_.parameters[p].log_mu_t * mu_t_ * edge);
    }
  }

  const FluxDerivatives& of_;
  Domain domain_;
  double mu_t_;
  const Scattering& scattering_;
  LightEntry entry_;
  RandomStream& random_;
  std::array<double, most_derivatives> log_derivatives_{};
  std::uint64_t steps_ = 0;
};

template <typename Scattering>
SummedBatches batches(const std::shared_ptr<const FluxDerivatives>& of,
                      const Scattering& scattering, std::uint64_t seed) {
  return [=](std::uint64_t number, std::span<Complex> sums) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
    const Lights& lights = of->scene.request.lights;
    for (std::size_t light = 0; light < lights.size(); ++light) {
      FluxDerivativeWalk<Scattering> walk(*of, scattering, lights[light].direction(), random);
      for (std::uint64_t path = 0; path < derivative_walks_per_batch; ++path)
        walk.walk(sums.subspan(exits * light), exits * lights.size());
    }
  };
}

}  // namespace

PathJob flux_derivative_job(const Scene& scene, const std::vector<MediumDerivative>& derivatives,
                            std::uint64_t seed) {
  require_derivatives(scene, derivatives);
  require_walks(scene, false);
  const auto of = std::make_shared<const FluxDerivatives>(FluxDerivatives{scene, derivatives});
  PathJob job;
  job.entries = exits * scene.request.lights.size();
  job.all = [](double samples, std::span<const Complex> sums) {
    return sample_mean(samples, sums);
  };
  job.field.batches.size = job.entries * (1 + derivatives.size());
  job.field.batches.samples_per_batch = static_cast<double>(derivative_walks_per_batch);
  job.field.batches.relative_error = relative_error_of(job.all);
  with_scattering(scene, phase_of(scene), [&](const auto& scattering) {
    job.field.batches.run = batches(of, scattering, seed);
  });
  return job;
}

}  // namespace flatspeckle::mc
