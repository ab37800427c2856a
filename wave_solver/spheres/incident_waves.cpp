#include "wave_solver/spheres/incident_waves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/gauss.h"

namespace flatspeckle::wave {

namespace {

// Returns the highest order of Bessel functions of the argument x that is not negligible.
int highest_bessel(double x) {
  return static_cast<int>(std::ceil(x + 10 * std::cbrt(x) + 20));
}

}  // namespace

std::vector<BeamWave> beam_waves(const Light& beam, double k, double reach, double tolerance) {
  const Vec axis = beam.direction();
  const Vec aside = std::abs(axis.z) < 0.9 ? Vec{0, 1} : Vec{1, 0};
  const Vec across = cross(axis, aside), u = (1 / length(across)) * across, v = cross(axis, u);
  const double width = k * beam.waist / 2,
               widest = std::asin(std::min(1.0, std::sqrt(std::log(1e3 / tolerance)) / width)),
               phase = k * reach * std::sin(widest);
  const auto polar = gauss_legendre(highest_bessel(phase / 2));
  const int turns = highest_bessel(phase);
  const double power = k * k * beam.waist * beam.waist / (4 * std::numbers::pi);
  std::vector<BeamWave> waves;
  for (std::size_t i = 0; i < polar.node.size(); ++i) {
    const double angle = widest * polar.node[i], sine = std::sin(angle), cosine = std::cos(angle);
    const double size = power * cosine * std::exp(-width * width * sine * sine) * sine *
                        (widest * polar.weight[i]) * (2 * std::numbers::pi / turns);
    for (int n = 0; n < turns; ++n) {
      const double azimuth = 2 * std::numbers::pi * n / turns;
      const Vec w = cosine * axis + (sine * std::cos(azimuth)) * u + (sine * std::sin(azimuth)) * v;
      waves.push_back({w, std::polar(size, -k * dot(w, beam.point))});
    }
  }
  return waves;
}

void add_incident(double k, std::span<const SphereSet> sets, const Light& light, double tolerance,
                  Complex factor, std::span<Complex> out) {
  if (light.kind == Light::Kind::plane)
    return add_plane_wave(k, sets, light.direction(), factor, out);
  if (light.kind == Light::Kind::point)  // i k h_l R_lm, because G = i k h_0 / (4 pi)
    return add_outgoing(k, sets, light.point, Complex(0, k) * factor, out);
  double reach = 0;
  for (const SphereSet& set : sets)  // waves of degree l reach to about l / k from the centre
    reach = std::max(reach, length(set.centre - light.point) + set.order / k);
  for (const auto& [w, weight] : beam_waves(light, k, reach, tolerance))
    add_plane_wave(k, sets, w, factor * weight, out);
}

void add_outgoing(double k, std::span<const SphereSet> sets, Vec point, Complex factor,
                  std::span<Complex> out) {
  std::vector<Complex> row;
  std::size_t at = 0;
  for (const SphereSet& set : sets) {
    row.resize(harmonics_up_to(set.order));
    field_at(k, {&point, 1}, set, {row.data(), 1});
    for (const Complex& value : row) out[at++] += factor * value;
  }
}

}  // namespace flatspeckle::wave
