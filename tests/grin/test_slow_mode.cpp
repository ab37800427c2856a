#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/media/scattering/case_modes.h"
#include "grin/media/scattering/free_flight.h"
#include "grin/media/scattering/phase_function.h"

// The discrete (Case) eigenmodes and biased free flights: both conserve means.

namespace flatspeckle::grin::test_slow_mode {

namespace {

/// Returns the mean of f(u) over the unit interval, by the midpoint rule.
template <class Function>
auto mean(int points, const Function& f) {
  decltype(f(0.5)) sum = f(0.5 / points);
  for (int i = 1; i < points; ++i) sum += f((i + 0.5) / points);
  return decltype(sum)(sum / points);
}

}  // namespace

TEST_CASE("Case eigenmodes: scattering conserves their means") {
  for (const double albedo : {0.6, 0.9, 0.9999, 1.0})
    for (const double g : {-0.3, 0.0, 0.5, 0.9}) {
      CAPTURE(albedo);
      CAPTURE(g);
      const CaseModes modes(albedo, g);
      const CaseModes::Values growth = modes.growth(0.3);
      for (const double mu : {-0.9, 0.1, 0.7}) {
        // 1 - cosine is 2 s^2, which resolves the forward peak
        const CaseModes::Values after = mean(2000, [&](double s) -> CaseModes::Values {
          const double turn = 2 * s * s, across = std::sqrt(turn * (2 - turn) * (1 - mu * mu));
          const double density = HenyeyGreenstein<3>{g}.density_beside(turn);
          return 8 * std::numbers::pi * s * density * mean(64, [&](double v) {
                   const double cosine =
                       (1 - turn) * mu + across * std::cos(2 * std::numbers::pi * v);
                   return modes.departing(growth, modes.angle(cosine));
                 });
        });
        const CaseModes::Values before = modes.arriving(growth, modes.angle(mu));
        for (Eigen::Index mode = 0; mode < before.size(); ++mode) {
          CAPTURE(mode);
          CHECK(albedo * after[mode] == doctest::Approx(before[mode]).epsilon(2e-5));
        }
      }
    }
}

TEST_CASE("Case eigenmodes: free flights conserve their means, also bounded ones") {
  const double longest = 3;
  for (const double albedo : {0.6, 0.99, 1.0}) {
    const CaseModes modes(albedo, 0.9);
    REQUIRE(modes.rates().size() > (albedo > 0.9 ? 3 : 1));
    for (const double mu : {-1.0, -0.2, 0.4, 1.0}) {
      CAPTURE(albedo);
      CAPTURE(mu);
      const CaseModes::Angle along = modes.angle(mu);
      const CaseModes::Values collided = mean(20000, [&](double share) -> CaseModes::Values {
        const double s = longest * share;
        return longest * std::exp(-s) * modes.arriving(modes.growth(2 + mu * s), along);
      });
      const CaseModes::Values out = std::exp(-longest) *
                                    modes.departing(modes.growth(2 + mu * longest), along),
                              before = modes.departing(modes.growth(2), along);
      for (Eigen::Index mode = 0; mode < before.size(); ++mode) {
        CAPTURE(mode);
        CHECK(collided[mode] + out[mode] == doctest::Approx(before[mode]).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("biased free flights: weighted means agree with unbiased flights") {
  const double mu_t = 1.3, longest = 2;
  for (const double bias : {0.1, 0.7, 0.95}) {
    CAPTURE(bias);
    const BiasedFlight flight(mu_t, bias);
    double beyond = 0, square = 0;
    const int points = 1'000'000;
    for (int i = 0; i < points; ++i) {
      const double s = flight.sample((i + 0.5) / points);
      beyond += s >= longest ? flight.weight_beyond(longest) / points : 0;
      square += s < longest ? s * s * flight.weight(s) / points : 0;
    }
    const double x = mu_t * longest, mean_square = (2 - std::exp(-x) * (2 + x * (2 + x)));
    CHECK(beyond == doctest::Approx(std::exp(-x)).epsilon(1e-4));
    CHECK(square == doctest::Approx(mean_square / (mu_t * mu_t)).epsilon(1e-4));
  }
}

}  // namespace flatspeckle::grin::test_slow_mode
