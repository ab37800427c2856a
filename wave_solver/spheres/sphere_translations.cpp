#include "wave_solver/spheres/sphere_translations.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include "core/numbers/gauss.h"

namespace flatspeckle::wave {

namespace {

// Values of N_lm (Harmonics) at the nodes in cos(theta) of a Gauss-Legendre rule over [0, 1]:
// [l, m][node].
class NodeValues {
 public:
  NodeValues(const Harmonics& harmonics, const std::vector<double>& nodes)
      : nodes_(nodes.size()), values_(at(harmonics.order() + 1, 0)) {
    for (std::size_t i = 0; i < nodes_; ++i) {
      const double cosine = nodes[i], sine = std::sqrt((1 - cosine) * (1 + cosine));
      double power = 1;
      for (int m = 0; m <= harmonics.order(); ++m, power *= sine) {
        double before = 0, here = power * harmonics.diagonal(m);
        for (int l = m; l <= harmonics.order(); ++l) {
          if (l > m) {
            const double next =
                harmonics.rise(l, m) * (cosine * here - harmonics.fall(l, m) * before);
            before = here;
            here = next;
          }
          values_[at(l, m) + i] = here;
        }
      }
    }
  }

  const double* of(int l, int m) const { return &values_[at(l, m)]; }

 private:
  std::size_t at(int l, int m) const {
    return static_cast<std::size_t>(l * (l + 1) / 2 + m) * nodes_;
  }

  std::size_t nodes_;
  std::vector<double> values_;
};

}  // namespace

// The integrand of three N is even in cos(theta), because l + l' + L and m + m' + M are even, and a
// polynomial of degree at most 2 (l + l'). In the factor 4 pi i^(l + L - l') / 2 int cos^2(M phi),
// the power of i is real.
SphereTranslations::SphereTranslations(int order)
    : harmonics_(2 * order), rows_(row(order + 1, 0)) {
  const auto rule = gauss_legendre(2 * order + 1);
  const std::size_t nodes = rule.node.size();
  const NodeValues values(harmonics_, rule.node);
  std::vector<double> product(nodes);
  start_.push_back(0);
  for (int l = 0; l <= order; ++l)
    for (int m = 0; m <= l; ++m)
      for (int other_l = 0; other_l <= order; ++other_l)
        for (int other_m = 0; other_m <= other_l; ++other_m) {
          for (std::size_t i = 0; i < nodes; ++i)
            product[i] = 2 * rule.weight[i] * values.of(l, m)[i] * values.of(other_l, other_m)[i];
          for (const bool sum : {false, true}) {
            const int big_m = sum ? m + other_m : std::abs(m - other_m);
            int first = std::abs(l - other_l);
            while (first < big_m) first += 2;
            first_.push_back(first);
            for (int big_l = first; big_l <= l + other_l; big_l += 2) {
              double integral = 0;
              for (std::size_t i = 0; i < nodes; ++i)
                integral += product[i] * values.of(big_l, big_m)[i];
              const bool minus = ((l + big_l - other_l) / 2) % 2 != 0;
              const double turns = big_m == 0 ? 2 * std::numbers::pi : std::numbers::pi;
              values_.push_back((minus ? -1 : 1) * 2 * std::numbers::pi * turns * integral);
            }
            start_.push_back(values_.size());
          }
        }
}

std::shared_ptr<const SphereTranslations> sphere_translations(int order) {
  static std::mutex mutex;
  static std::shared_ptr<const SphereTranslations> known;
  const std::lock_guard lock(mutex);
  if (!known || known->order() < order) known = std::make_shared<SphereTranslations>(order);
  return known;
}

}  // namespace flatspeckle::wave
