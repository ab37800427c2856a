#include "mc/theory/detector_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

PixelSpeckle pixel_speckle(double area) {
  // The correlation is the product of those along x and y. Each is the second difference of F,
  // whose second derivative is exp(-pi area x^2).
  const double root = std::sqrt(area);
  const auto f = [&](double x) {
    return x * std::erf(std::sqrt(pi) * root * x) / (2 * root) +
           std::exp(-pi * area * x * x) / (2 * pi * area);
  };
  const auto difference = [&](double x) { return f(x + 1) - 2 * f(x) + f(x - 1); };
  const double own = difference(0);
  const int reach = 2 + static_cast<int>(3 / root);  // beyond, the correlation is below 1e-12
  double square = 1;
  for (int pixel = 1; pixel <= reach; ++pixel) square += 2 * std::pow(difference(pixel) / own, 2);
  return {1 / (own * own), square * square};
}

double successive_exposures(const Decay& square, double exposure, double contrast, double frames) {
  static const QuadratureRule rule = gauss_legendre(16);
  constexpr int most_single = 16;
  const int single = static_cast<int>(std::min(frames - 1, double{most_single}));
  double sum = 1;
  for (int frame = 1; frame <= single; ++frame) {
    double correlation = 0;
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double x = rule.node[n], from = x * x;  // decays are smooth in the root of the delay
      correlation += rule.weight[n] * ((1 - x) * square((frame + x) * exposure) +
                                       2 * x * from * square((frame - 1 + from) * exposure));
    }
    sum += 2 * (1 - frame / frames) * std::pow(correlation / contrast, 2);
  }
  constexpr double least = 1e-8;
  for (double from = single + 0.5; from < frames && square(from * exposure) > least; from *= 2) {
    const double width = std::min(2 * from, frames) - from;
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double frame = from + width * rule.node[n];
      sum += 2 * width * rule.weight[n] * (1 - frame / frames) *
             std::pow(square(frame * exposure) / contrast, 2);
    }
  }
  return sum;
}

double contrast_variance(const CountedSpeckle& light) {
  // Conventions, C67: the derivatives by variance and mean, and cumulants of the counts up to the
  // fourth. Those of pairs of pixels follow from the moments of circular Gaussian fields.
  const double shot = 1 / light.photons, dark = std::pow(light.read_noise * shot, 2),
               square = light.contrast, others = light.squares - 1;
  return 2 * std::pow(square + shot + dark, 2) + 2 * square * std::pow(square + shot, 2) +
         dark * std::pow(2 * square + shot, 2) + 2 * square * square * (1 + square) * others;
}

CorrelationNoise::CorrelationNoise(double rate, double beta, Decay field, double shortest,
                                   double longest)
    : rate_(rate), beta_(beta), field_(std::move(field)) {
  static const QuadratureRule rule = gauss_legendre(4);
  constexpr double ratio = 1.5, below = 4;
  double from = 0;
  for (double to = shortest / below; from < longest; to *= ratio) {
    to = std::min(to, longest);
    for (std::size_t n = 0; n < rule.node.size(); ++n)
      for (const double sign : {-1.0, 1.0}) {
        time_.push_back(sign * (from + (to - from) * rule.node[n]));
        weight_.push_back((to - from) * rule.weight[n]);
      }
    from = to;
  }
}

double CorrelationNoise::covariance(double delay, double other) const {
  const auto g = [&](double time) { return field_(std::abs(time)); };
  const double a = g(delay), b = g(other), apart = g(other - delay), sum = g(delay + other);
  double pairs = 0, triples = 0, cycles = 0, whole = 0;
  for (std::size_t n = 0; n < time_.size(); ++n) {
    const double s = time_[n], at = g(s), before = g(s - delay), after = g(s + other),
                 both = g(s + other - delay);
    pairs += weight_[n] * (at * at * both * both + after * after * before * before);
    cycles += weight_[n] * (a * b * (before * after + both * at) + at * before * both * after);
    // the means of g2 at both delays, which are those of the light without delay
    triples += weight_[n] * a * b * at * (b * before + a * after);
    whole += weight_[n] * at * at;
  }
  const double beta2 = beta_ * beta_, beta3 = beta2 * beta_;
  const double waves =
      beta2 * pairs + 2 * beta3 * cycles - 4 * beta3 * triples + 4 * beta3 * a * a * b * b * whole;
  const double mixed = 2 * beta_ * (apart * apart + sum * sum) + 4 * beta2 * a * b * (apart + sum) -
                       4 * beta2 * a * a * b * b;
  return waves + mixed / rate_;
}

double CorrelationNoise::pair_noise(double delay, double bin) const {
  const double field = field_(delay);
  return (1 + beta_ * field * field) / (rate_ * rate_ * bin);
}

}  // namespace flatspeckle::mc
