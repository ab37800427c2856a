// Free flights and phase functions at the limits of their ranges; densities of high contrast.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <boost/math/quadrature/gauss.hpp>

#include "bench/oracles/multiprecision.h"
#include "bench/stability/extreme_rows.h"
#include "grin/media/scattering/free_flight.h"
#include "grin/media/scattering/phase_function.h"
#include "grin/render/flights/space.h"
#include "mc/paths/walk/first_scatterer.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using namespace oracles;
using std::numbers::pi;
/// Uniform numbers, including the smallest and largest of RandomStream.
constexpr double uniforms[] = {0x1p-54, 1e-9, 0.25,     0.5 - 0x1p-53,
                               0.5,     0.75, 1 - 1e-9, 1 - 0x1p-53};

/// Checks that the distribution function of the sampled distance equals the uniform number u,
/// relative to u; compares the density with 50 digits.
Finding bounded_flight(double optical_depth) {
  using boost::multiprecision::expm1;
  const double longest = 3;
  const BoundedFlight flight{optical_depth / longest, longest};
  const Wide mu_t(flight.mu_t), all = -expm1(-mu_t * longest);
  double worst = 0;
  for (const double u : uniforms) {
    const double s = flight.sample(u);
    if (!(s >= 0 && s <= longest * (1 + 1e-15))) return {1, 1e-15};
    const Wide share = optical_depth == 0 ? Wide(s) / longest : Wide(-expm1(-mu_t * s) / all);
    worst = larger(worst, static_cast<double>(abs(share / u - 1)));
    const Wide density = optical_depth == 0 ? Wide(1) / longest : Wide(mu_t * exp(-mu_t * s) / all);
    if (density >
        1e-280)  // an exponent of 1e4 has a relative error of 1e-16, its exponential one of 1e-12
      worst = larger(worst, 1e-3 * static_cast<double>(abs(flight.density(s) / density - 1)));
  }
  return {worst, 1e-15};
}

/// Checks that the mean weight of biased flights is the probability of a collision, over 1e5
/// strata.
Finding biased_flight(double optical_depth) {
  const mc::BoundedBiasedFlight flight(optical_depth, 1, 0.9);
  constexpr int count = 100'000;
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += flight.weight(flight.sample((i + 0.5) / count)) / count;
  return {std::abs(sum / -std::expm1(-optical_depth) - 1), 1e-4};
}

/// Checks that the distribution function of the sampled angle equals the uniform number u. Near pi
/// an angle is rounded by 4e-16, which a density of 318 (g = -0.999) amplifies to 1.4e-13.
Finding flat_inverse(double g) {
  return worst_of(uniforms, g < 0 ? 2e-13 : 1e-15, [&](double u) {
    const Wide half = Wide(HenyeyGreenstein<2>{g}.sample(u)) / 2;
    const Wide share = Wide(0.5) + atan2((1 + Wide(g)) * sin(half), (1 - Wide(g)) * cos(half)) /
                                       boost::math::constants::pi<Wide>();
    return static_cast<double>(abs(share - u));
  });
}

/// Checks the distribution function of the scattering angle in 3D, in terms of 1 - cos. Near 2 this
/// is rounded by 4e-16, and its density there is 1e6 (g = -0.999).
Finding space_inverse(double g) {
  return worst_of(uniforms, g < 0 ? 5e-10 : 1e-15, [&](double u) {
    const Wide gap(HenyeyGreenstein<3>{g}.sample_one_minus_cosine(u)), wide_g(g);
    const Wide rest = 1 - wide_g, root = sqrt(rest * rest + 2 * wide_g * gap);
    // (1 - g^2) / (2 g) [1/root - 1/(1 + g)], without dividing by g
    const Wide share =
        g == 0 ? Wide(1 - gap / 2) : Wide(rest * (2 - gap) / (root * (1 + wide_g + root)));
    return static_cast<double>(abs(share - u));
  });
}

/// Checks that the integral over all directions is 1 and the mean cosine is g. Near the backward
/// direction, 1 - cos is about 2 and rounded by 4e-16, which matters relative to (1 + g)^2 = 1e-6.
template <int dimension>
Finding normalisation(double g) {
  const HenyeyGreenstein<dimension> phase{g};
  double sum = 0, cosine = 0;
  for (double low = 0, high = 1e-6; low < pi; low = high, high = std::min(2 * high, pi)) {
    const auto moment = [&](auto weight) {
      const auto both = [&](double t) {
        const auto at = [&](double angle) {
          const double ring = dimension == 2 ? 2 : 2 * pi * std::sin(angle);
          return ring * phase.density(angle) * weight(angle);
        };
        return at(t) + at(pi - t);
      };
      // the angles are refined towards both ends, because the lobe may be at either end
      const double a = std::min(low, pi / 2), b = std::min(high, pi / 2);
      return boost::math::quadrature::gauss<double, 30>::integrate(both, a, b);
    };
    sum += moment([](double) { return 1.0; });
    cosine += moment([](double angle) { return std::cos(angle); });
  }
  return {larger(std::abs(sum - 1), std::abs(cosine - g)), g < 0 ? 1e-9 : 1e-12};
}

/// Checks that directions stay unit vectors after a million scatterings.
Finding long_walk() {
  const SpacePhaseFunction phase{HgPhase{0.999}};
  double worst = 0;
  for (Vec3 d : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0.6, 0, -0.8)}) {
    RandomStream random(1, 82, 0);
    for (int i = 0; i < 300'000; ++i) d = phase.sample(d, random);
    worst = larger(worst, std::abs(d.norm() - 1));
  }
  return {worst, 1e-14};
}

/// The box [0, 4] x [0, 1]^2 with density 1 at x = 0 and 1, 1e6 at 2, 1 at 3 and 4, linear in
/// between. The integral along x is 1e6 + 2.
Stage spike(double mu_s) {
  const FieldGrid grid{Vec3::Zero(), Vec3::Ones(), {5, 2, 2}};
  std::vector<double> density(grid.size(), 1);
  for (int i = 8; i < 12; ++i) density[i] = 1e6;
  return {Box{Vec3::Zero(), Vec3(4, 1, 1)},
          {.mu_s = mu_s, .density = std::make_shared<const DensityGrid>(grid, density)}};
}

/// Checks the fraction of flights that pass the spike, whose optical depth is 1.
Finding through_spike(const Space& space) {
  RandomStream random(4, 90, 0);
  constexpr int count = 20'000;
  double left = 0;
  for (int i = 0; i < count; ++i)
    left += space.fly({Vec3(0, 0.4, 0.6)}, Vec3::UnitX(), random).end == Flight::End::boundary;
  const double share = left / count, expected = std::exp(-(1e6 + 2) * 1e-6);
  return in_errors(share, std::sqrt(expected * (1 - expected) / count), expected, 0.02);
}

/// Checks the transmittance by ratio tracking along x = 0.5, where the density is 1. Next to the
/// spike there are 1e6 tentative collisions per real one.
Finding beside_spike() {
  const Space space(Homogeneous{0}, spike(0.3));
  RandomStream random(5, 90, 0);
  ConnectionStatistics statistics;
  const PathPoint from{Vec3(0.5, 0.01, 0.5)}, to{Vec3(0.5, 0.99, 0.5)};
  return mean_in_errors(
      25, [&](int) { return space.connect(from, to, random, statistics)->transmittance; },
      std::exp(-0.3 * 0.98), 0.01);
}

Finding through_vacuum() {
  const FieldGrid grid{Vec3::Zero(), Vec3::Ones(), {5, 2, 2}};
  const auto empty = std::make_shared<const DensityGrid>(grid, std::vector<double>(grid.size()));
  const Space space(Homogeneous{0},
                    {Box{Vec3::Zero(), Vec3(4, 1, 1)}, {.mu_s = 1e6, .density = empty}});
  RandomStream random(6, 90, 0);
  const Flight flight = space.fly({Vec3(0, 0.4, 0.6)}, Vec3::UnitX(), random);
  return {flight.end == Flight::End::boundary ? std::abs(flight.arc_length - 4) : 1, 1e-14};
}

void add_flights(ExtremeRows& rows) {
  rows.add_each("free flight within OD ", {0.0, 1e-280, 1e-12, 1.0, 40.0, 1e4}, "",
                "distribution, density in 50 digits", bounded_flight);
  for (const double depth : {1e-12, 1e4})
    rows.add("stretched flight within OD " + short_number(depth), "mean weight", biased_flight,
             depth);
}

void add_phases(ExtremeRows& rows) {
  for (const double g : {-0.999, 0.0, 1e-300, 0.999}) {
    const std::string name = "Henyey-Greenstein, g " + short_number(g);
    rows.add(name + ", flatland, u to 2^-54", "inverse of its distribution, 50 digits",
             flat_inverse, g);
    rows.add(name + ", space, u to 2^-54", "inverse of its distribution, 50 digits", space_inverse,
             g);
    rows.add(name + ", both", "integral 1, mean cosine g",
             [=] { return worse(normalisation<2>(g), normalisation<3>(g)); });
  }
  rows.add("Henyey-Greenstein, g 0.999, 3e5 turns in space", "length 1", long_walk);
}

}  // namespace

void flight_extremes(ExtremeRows& rows) {
  add_flights(rows);
  add_phases(rows);
  rows.add("density of contrast 1e6, through its spike", "exp(-OD), in errors",
           [] { return through_spike(Space(Homogeneous{0}, spike(1e-6))); });
  rows.add("density of contrast 1e6, curved, n - 1 = 1e-6", "exp(-OD), in errors", [] {
    // a deflection of 4e-6 changes the optical depth by the same amount
    const auto space = make_space(LinearRamp{0, 1e-6 * Vec3::UnitY()}, spike(1e-6), {0.5, 8});
    return through_spike(*space);
  });
  rows.add("density of contrast 1e6, beside its spike", "exp(-OD), in errors", beside_spike);
  rows.add("density 0 everywhere, mu_s 1e6", "flies through", through_vacuum);
}

}  // namespace flatspeckle::bench
