#include <algorithm>
#include <cmath>
#include <fftw3.h>
#include <numbers>

#include "core/numbers/fourier.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/slab/adding/plane.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// Returns the integrals of p cos(m theta) over the circle for m = 0 .. intervals, by the
/// trapezoidal rule.
std::vector<double> cosine_modes(const std::function<double(double)>& p, int intervals) {
  std::vector<double> line(static_cast<std::size_t>(intervals) + 1);
  for (int i = 0; i <= intervals; ++i) line[i] = p(pi * i / intervals) * pi / intervals;
  fftw_plan plan;
  {
    const std::lock_guard lock(fourier_planning());
    plan = fftw_plan_r2r_1d(intervals + 1, line.data(), line.data(), FFTW_REDFT00,
                            FFTW_ESTIMATE | FFTW_UNALIGNED);
  }
  fftw_execute(plan);
  const std::lock_guard lock(fourier_planning());
  fftw_destroy_plan(plan);
  return line;
}

constexpr int most_cosine_moments = 4096;

}  // namespace

ScatteringLaw::ScatteringLaw(const Scene& scene, double delay) : delay_(delay) {
  const Scatterer& scatterer = scene.scatterer;
  if (scatterer.kind == Scatterer::Kind::hg) g_ = scatterer.g;
  if (scatterer.kind == Scatterer::Kind::point) g_ = 0;
  if (scatterer.kind == Scatterer::Kind::hg)
    density_ = [g = scatterer.g](double theta) { return henyey_greenstein(g, theta); };
  else if (scatterer.kind == Scatterer::Kind::point)
    density_ = [](double) { return 1 / (2 * pi); };
  else if (scene.medium.phase.density)
    density_ = scene.medium.phase.density;
  else
    tabulate(scene);
  moments_ = {[law = *this](int count) { return law.first_moments(count); }, most_cosine_moments};
  width_ = moments_.kept().width;
  if (has_sharp_peak()) {
    const auto p = [this](double theta) { return std::norm(amplitude(theta)); };
    width_ = std::min(width_, peak_width(p));
  }
  const auto large = [](double moment) { return std::abs(moment) > 0.01; };
  const auto lobes =
      std::find_if(moments().rbegin(), moments().rend(), large).base() - moments().begin();
  if (!is_peaked()) least_order_ = static_cast<int>(std::min<std::ptrdiff_t>(lobes / 2, 16));
}

std::vector<double> ScatteringLaw::first_moments(int count) const {
  if (g_ && delay_ == 0) return henyey_greenstein_moments(*g_, count);
  const auto p = [this](double theta) { return std::norm(amplitude(theta)); };
  const auto decay = [this](double theta) { return this->decay(theta); };
  if (density_) return mc::first_moments(2, p, decay, count);
  int intervals = 64;
  while (intervals < 2 * count) intervals *= 4;
  const double all = cosine_modes(p, intervals).front();
  auto modes = cosine_modes([&](double theta) { return p(theta) * decay(theta); }, intervals);
  modes.resize(static_cast<std::size_t>(count));
  for (double& mode : modes) mode /= all;
  return modes;
}

ScatteringLaw ScatteringLaw::truncated(int count) const {
  ScatteringLaw law = *this;
  law.moments_ = moments_.truncated(count);
  law.width_ = law.moments_.kept().width;
  return law;
}

double ScatteringLaw::pair_derivative(double g, double a, double b, double theta) const {
  const auto by_g = [g](double angle) {
    const double half = std::sin(angle / 2);
    return henyey_greenstein_derivative(g, 2 * half * half);
  };
  return (by_g(theta - a) + by_g(theta - b)) / 2;
}

void ScatteringLaw::tabulate(const Scene& scene) {
  const std::size_t steps_per_order = 2048;
  table_ = normalised_amplitudes(scene.medium, scene.k,
                                 steps_per_order * (scene.medium.t_matrix.size() + 1));
}

/// Interpolates the table by the cubic Lagrange polynomial through the four nearest nodes. Nodes
/// beyond 0 and pi follow from symmetry: A is even about both angles.
Complex ScatteringLaw::amplitude(double angle) const {
  const double theta = std::abs(angle - 2 * pi * std::rint(angle / (2 * pi)));
  if (density_) return std::sqrt(density_(theta));
  const auto last = static_cast<std::ptrdiff_t>(table_.size()) - 1;
  const double position = theta / pi * static_cast<double>(last);
  const auto i = std::min(static_cast<std::ptrdiff_t>(position), last - 1);
  const double t = position - static_cast<double>(i);
  const auto at = [&](std::ptrdiff_t node) {
    return table_[static_cast<std::size_t>(node > last ? 2 * last - node : std::abs(node))];
  };
  return t * (t - 1) * ((2 - t) / 6 * at(i - 1) + (1 + t) / 6 * at(i + 2)) +
         (1 + t) * (2 - t) / 2 * ((1 - t) * at(i) + t * at(i + 1));
}

}  // namespace flatspeckle::mc
