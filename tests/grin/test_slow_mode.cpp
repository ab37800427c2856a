#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/media/scattering/diffusion_rate.h"
#include "grin/media/scattering/free_flight.h"
#include "grin/media/scattering/phase_function.h"

// The discrete (Case) eigenmode and biased free flights: both conserve means.

namespace flatspeckle::grin::test_slow_mode {

namespace {

/// Returns the mean of f(u) over the unit interval, by the midpoint rule.
template <class Function>
double mean(int points, const Function& f) {
  double sum = 0;
  for (int i = 0; i < points; ++i) sum += f((i + 0.5) / points);
  return sum / points;
}

}  // namespace

TEST_CASE("Case eigenmode: scattering conserves its mean") {
  for (const double albedo : {0.6, 0.9, 0.9999, 1.0})
    for (const double g : {-0.3, 0.0, 0.5, 0.9}) {
      CAPTURE(albedo);
      CAPTURE(g);
      const CaseMode mode(albedo, g);
      const double growth = 1.7;
      for (const double mu : {-0.9, 0.1, 0.7}) {
        const double after = mean(2000, [&](double u) {
          const double turn = HenyeyGreenstein<3>{g}.sample_one_minus_cosine(u);
          const double across = std::sqrt(turn * (2 - turn) * (1 - mu * mu));
          return mean(32, [&](double v) {
            return mode.departing(growth,
                                  (1 - turn) * mu + across * std::cos(2 * std::numbers::pi * v));
          });
        });
        CHECK(albedo * after == doctest::Approx(mode.arriving(growth, mu)).epsilon(2e-5));
      }
    }
}

TEST_CASE("Case eigenmode: free flights conserve its mean, also bounded ones") {
  const double longest = 3;
  for (const double albedo : {0.6, 0.99, 1.0}) {
    const CaseMode mode(albedo, 0.7);
    for (const double mu : {-1.0, -0.2, 0.4, 1.0}) {
      CAPTURE(albedo);
      CAPTURE(mu);
      const double collided = mean(20000, [&](double share) {
        const double s = longest * share;
        return longest * std::exp(-s) * mode.arriving(mode.growth(2 + mu * s), mu);
      });
      const double out = std::exp(-longest) * mode.departing(mode.growth(2 + mu * longest), mu);
      CHECK(collided + out == doctest::Approx(mode.departing(mode.growth(2), mu)).epsilon(1e-6));
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
