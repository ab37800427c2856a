#include "bench/oracles/guided_beam.h"

#include <cmath>
#include <utility>

#include "bench/oracles/quadrature.h"

namespace flatspeckle::oracles {

namespace {

template <class Function>
double integral(const Function& of, double from, double to) {
  GaussPanels points;
  points.add(from, to, 4);
  double sum = 0;
  for (std::size_t i = 0; i < points.node.size(); ++i) sum += points.weight[i] * of(points.node[i]);
  return sum;
}

}  // namespace

double GuidedBeam::landing(double rho) const {
  return rho * std::cos(alpha * length / std::sqrt(2.25 - alpha * alpha * rho * rho));
}

double GuidedBeam::arc_length(double rho) const {
  const auto index = [&](double sigma) {
    const double x = rho * alpha * std::cos(alpha * sigma);
    return std::sqrt(2.25 - x * x);
  };
  return integral(index, 0, length / std::sqrt(2.25 - alpha * alpha * rho * rho));
}

double GuidedBeam::power(double radius) const {
  double low = 0, high = 1;  // bounds of the starting height of the ray that lands there
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (std::abs(landing(middle)) < radius ? low : high) = middle;
  }
  const auto light = [&](double rho) { return 2 * rho * std::exp(-mu_a * arc_length(rho)); };
  return integral(light, 0, low);
}

grin::RenderValues guided_values(const GuidedBeam& beam, std::vector<double> radii, double mu_s,
                                 double g) {
  grin::RenderValues values;
  values.field.field = {grin::ParabolicValues::word};
  values.field.of<grin::ParabolicValues>().index = 1.5;
  values.field.of<grin::ParabolicValues>().alpha = beam.alpha;
  values.step = 0.05;
  values.stage.stage_box = {-4, -4, 0, 4, 4, beam.length};
  if (mu_s > 0) values.stage.medium.mu_s = mu_s;
  if (beam.mu_a > 0) values.stage.medium.mu_a = beam.mu_a;
  if (g != 0) {
    values.stage.medium.phase = grin::HgPhase::word;
    values.stage.medium.of<grin::HgPhase>().g = g;
  }
  values.lights.beam_light = {0, 0, 0, 0, 0, 1, 1, 1};
  values.sensors.sensor = {grin::RadialValues::word};
  values.sensors.of<grin::RadialValues>().sensor_at = {0, 0, beam.length};
  values.sensors.of<grin::RadialValues>().radii = std::move(radii);
  return values;
}

double GuidedBeam::by_alpha(double radius) const {
  const double apart = 1e-4 * alpha;
  GuidedBeam less = *this, more = *this;
  less.alpha -= apart;
  more.alpha += apart;
  return (more.power(radius) - less.power(radius)) / (2 * apart);
}

}  // namespace flatspeckle::oracles
