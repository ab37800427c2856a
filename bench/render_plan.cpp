// What each thing that a plan leaves out saves in light transport: the general kernel against the
// specialised one on the same batches, in turn on one thread; medians of the time per path. Where
// both draw the same random numbers the pictures agree to rounding; where they cannot, within 4
// standard errors. Else the exit status is 1.
//
//   bench_render_plan [rounds]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "bench/render_scenes.h"
#include "core/stopwatch.h"
#include "grin/path_kernels.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;

namespace {

constexpr int paths_per_batch = 1024;

/// A kernel as the benchmark sees it.
struct Contestant {
  PathKernel kernel;
  GroupedSums sums;
  std::vector<double> seconds_per_path = {};

  void run(std::uint64_t batches, const TimeBins& bins, int pixels) {
    std::vector<Complex> out(sums.size());
    const double start = thread_cpu_seconds();
    for (std::uint64_t b = 0; b < batches; ++b) {
      std::fill(out.begin(), out.end(), 0);
      Film film(pixels, bins, out);
      RandomStream random(1, static_cast<std::uint64_t>(Stream::render), sums.batches());
      TransportCounts counts;
      kernel(paths_per_batch, random, film, counts, nullptr);
      sums.add(paths_per_batch, out);
    }
    seconds_per_path.push_back((thread_cpu_seconds() - start) /
                               static_cast<double>(batches * paths_per_batch));
  }

  double time() const {
    std::vector<double> sorted = seconds_per_path;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// The picture, whatever its bins.
Estimate steady(const GroupedSums& sums, int pixels) {
  const std::size_t bins = sums.size() / pixels;
  return jackknife(sums, [=](double samples, std::span<const Complex> total) {
    std::vector<Complex> picture(pixels);
    for (std::size_t i = 0; i < total.size(); ++i) picture[i / bins] += total[i] / samples;
    return picture;
  });
}

struct Comparison {
  std::string left_out;
  RenderScene scene;  ///< that has no need of it
  std::function<void(RenderPlan&)> generalise;
};

std::shared_ptr<Transport> transport_in(const RenderScene& scene) {
  const double excess = std::get<Homogeneous>(scene.field).n_excess;
  const double around = scene.stage.body ? scene.stage.excess_around : excess;
  const auto index = [=](const PathPoint& p) {
    return 1 + (p.part == Part::body ? excess : around);
  };
  return std::make_shared<Transport>(Transport{.stage = scene.stage,
                                               .lights = Lights(scene.lights, scene.stage, index),
                                               .sensor = SensorEnd(scene.sensor, scene.stage)});
}

/// A kernel for straight rays, or one that solves for rays in a field that happens to be constant.
PathKernel kernel_of(const RenderPlan& plan, const std::shared_ptr<Transport>& transport,
                     const RenderScene& scene) {
  const double excess = std::get<Homogeneous>(scene.field).n_excess;
  if (!plan.curved) return straight_kernel(plan, transport, excess);
  std::shared_ptr<const CurvedSpace> space =
      make_curved_space(ParabolicGuide({excess, 0}), scene.stage, {scene.step, scene.max_length});
  return curved_kernel(plan, transport, space, false);
}

/// Largest difference: of the pictures, relative; and in standard errors.
struct Difference {
  double relative = 0, in_errors = 0;
};
Difference difference(const Estimate& a, const Estimate& b) {
  double largest = 0;
  for (const Complex& value : a.value) largest = std::max(largest, std::abs(value));
  Difference result;
  for (std::size_t i = 0; i < a.value.size(); ++i) {
    const double off = std::abs(a.value[i] - b.value[i]);
    const double error = std::hypot(a.error[i], b.error[i]);
    result.relative = std::max(result.relative, off / largest);
    if (off > 0) result.in_errors = std::max(result.in_errors, off / error);
  }
  return result;
}

bool compare(const Comparison& c, int rounds) {
  RenderPlan general = render_plan(c.scene);
  const RenderPlan special = general;
  c.generalise(general);
  const auto transport = transport_in(c.scene);
  transport->join_level = 1e-3;
  const int pixels = transport->sensor.pixels().count();
  const TimeBins one, many{0, 20, 50};
  const TimeBins& general_bins = general.timed ? many : one;
  Contestant slow{kernel_of(general, transport, c.scene),
                  GroupedSums(static_cast<std::size_t>(pixels) * general_bins.count)};
  Contestant fast{kernel_of(special, transport, c.scene), GroupedSums(pixels)};
  for (int round = 0; round < rounds; ++round) {
    slow.run(8, general_bins, pixels);
    fast.run(8, one, pixels);
  }
  const Difference d = difference(steady(slow.sums, pixels), steady(fast.sums, pixels));
  const bool same = d.relative < 1e-9;
  std::printf("%-16s %10.3f %10.3f %8.2f   %s %.1e\n", c.left_out.c_str(), 1e6 * slow.time(),
              1e6 * fast.time(), slow.time() / fast.time(),
              same ? "same to" : "differ, standard errors:", same ? d.relative : d.in_errors);
  return same || d.in_errors < 4;
}

std::vector<Comparison> comparisons() {
  RenderScene fog = bench::foggy_ball();
  fog.sensor = AreaDetector{{0, 0, 3}, {0, 1, 0}, 6, 6, {4, 4}, 1.5};
  RenderScene clear = fog, alone = fog;
  clear.stage.medium = clear.stage.body->medium = {};
  alone.stage.body = {};
  alone.stage.medium.mu_s = 1;
  return {{"curved rays", alone,
           [](RenderPlan& p) {
             p = RenderPlan{};
             p.timed = false;
           }},
          {"scattering", clear, [](RenderPlan& p) { p.scatters = p.absorbs = true; }},
          {"absorption", alone, [](RenderPlan& p) { p.absorbs = true; }},
          {"density grid", alone, [](RenderPlan& p) { p.gridded = p.absorbs = true; }},
          {"body", alone, [](RenderPlan& p) { p.body = true; }},
          {"time bins", alone, [](RenderPlan& p) { p.timed = true; }},
          {"all but curves", alone, [](RenderPlan& p) {
             p = RenderPlan{};
             p.curved = false;
           }}};
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 15;
  std::printf("%-16s %10s %10s %8s   %s\n", "left out", "general us", "special us", "ratio",
              "pictures");
  bool good = true;
  for (const Comparison& c : comparisons()) good &= compare(c, rounds);
  return good ? 0 : 1;
}
