// Error against run time of light transport: path, light and bidirectional tracing and the photon
// map at several radii, on one thread, against a long bidirectional run. The error is the RMS over
// the pixels relative to the RMS of the picture, bias included, less what the reference itself is
// off by. CSV on standard output; plots/render_error_time.py reads it.
//
//   bench_render [seconds of a run] [CPU seconds of a reference] [runs of each] [scene]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "bench/scenes/render_scenes.h"
#include "core/run/stopwatch.h"
#include "grin/render/methods/photon_map.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;

namespace {

struct Reference {
  std::vector<double> value;
  double mean_square = 0, error_square = 0;  ///< means over the pixels
};

struct Contestant {
  std::string method;
  RenderRequest request;
};

Reference reference_of(const RenderScene& scene, double cpu_seconds) {
  const RenderJob job = render_job(scene, {RenderMethod::bidirectional}, 1000);
  RunState state{GroupedSums(job.batches.size), {}};
  RunOptions options;
  for (double samples = 1024; state.cpu_s < cpu_seconds; samples *= 2) {
    options.stop.samples = static_cast<std::uint64_t>(samples * job.batches.samples_per_batch);
    run_batches(job.batches, options, state);
  }
  const Estimate steady = rendered_picture(job, state.sums).steady;
  Reference reference;
  const auto pixels = static_cast<double>(steady.value.size());
  for (std::size_t i = 0; i < steady.value.size(); ++i) {
    const double value = steady.value[i].real();
    reference.value.push_back(value);
    reference.mean_square += value * value / pixels;
    reference.error_square += steady.error[i] * steady.error[i] / pixels;
  }
  return reference;
}

double relative_error(const Reference& reference, std::span<const Complex> sums, double samples) {
  double square = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double off = sums[i].real() / samples - reference.value[i];
    square += off * off / static_cast<double>(sums.size());
  }
  return std::sqrt(std::max(0.0, square - reference.error_square) / reference.mean_square);
}

/// Batches in number order; a line at each doubling of the time.
void trace(const std::string& scene_name, const RenderScene& scene, const Contestant& contestant,
           const Reference& reference, std::uint64_t seed, double seconds) {
  const RenderJob job = render_job(scene, contestant.request, seed);
  std::vector<Complex> sums(job.batches.size), batch(job.batches.size);
  double spent = 0, next = seconds / 256;
  for (std::uint64_t number = 0; spent < seconds; ++number) {
    const double start = thread_cpu_seconds();
    std::fill(batch.begin(), batch.end(), 0);
    job.batches.run(number, batch);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += batch[i];
    spent += thread_cpu_seconds() - start;
    if (spent < next) continue;
    while (next <= spent) next *= 2;
    const double samples = static_cast<double>(number + 1) * job.batches.samples_per_batch;
    std::printf("%s,%s,%.4g,%llu,%.4g,%.0f,%.5g\n", scene_name.c_str(), contestant.method.c_str(),
                contestant.request.photon_radius, static_cast<unsigned long long>(seed), spent,
                samples, relative_error(reference, std::span(sums).first(job.pictures), samples));
    std::fflush(stdout);
  }
}

std::vector<Contestant> contestants(const RenderScene& scene) {
  std::vector<Contestant> all{{"bidirectional", {RenderMethod::bidirectional}},
                              {"light", {RenderMethod::light}},
                              {"path", {RenderMethod::path}}};
  const double radius = default_photon_radius(scene.stage);
  all.push_back({"photon_map_default", {RenderMethod::photon_map, 0, radius}});
  for (const double factor : {0.25, 0.5, 2.0, 4.0, 8.0})
    all.push_back({"photon_map", {RenderMethod::photon_map, 0, factor * radius}});
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 30;
  const double reference_seconds = argc > 2 ? std::atof(argv[2]) : 1200;
  const int runs = argc > 3 ? std::atoi(argv[3]) : 3;
  std::printf("scene,method,photon_radius,seed,cpu_s,samples,relative_error\n");
  for (const bench::NamedRender& named : bench::render_scenes()) {
    if (argc > 4 && named.name != argv[4]) continue;
    const Reference reference = reference_of(named.scene, reference_seconds);
    std::printf("# %s: reference off by %.2g\n", named.name.c_str(),
                std::sqrt(reference.error_square / reference.mean_square));
    for (int run = 1; run <= runs; ++run)
      for (const Contestant& contestant : contestants(named.scene))
        trace(named.name, named.scene, contestant, reference, run, seconds);
  }
  return 0;
}
