#include "grin/media/index/bessel_profile.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <mutex>
#include <numbers>

#include "core/error.h"
#include "core/numbers/bessel.h"

namespace flatspeckle::grin {

namespace {

/// g_m(x^2), x > 0.
long double profile(int order, double x) {
  return bessel_j(order, x)[order] / std::pow(static_cast<long double>(x), order);
}

}  // namespace

BesselProfile::BesselProfile(int order, double reach)
    : order_(order), reach_(reach), cells_(std::ceil(reach * cells_per_unit)) {
  assert(order >= 0 && order <= max_order);
  if (!(reach > 0 && reach <= 1e4))
    throw InputError("reach of the sound wave in radians", reach, "must be from 0 to 1e4");
  table_ = table_of(order, static_cast<std::size_t>(cells_) + 1);
}

/// The longest that has been made, or a longer one.
std::shared_ptr<const BesselProfile::Table> BesselProfile::table_of(int order, std::size_t cells) {
  static std::mutex mutex;
  static std::array<std::shared_ptr<const Table>, max_order + 1> longest;
  const std::lock_guard lock(mutex);
  auto& made = longest[static_cast<std::size_t>(order)];
  if (made && made->size() >= cells) return made;
  auto longer = std::make_shared<Table>(made ? *made : Table());
  while (longer->size() < cells) longer->push_back(fit(order, static_cast<double>(longer->size())));
  return made = longer;
}

/// Newton's interpolation in Chebyshev nodes, expanded in powers of u - centre.
BesselProfile::Cell BesselProfile::fit(int order, double cell) {
  constexpr int count = degree + 1;
  const long double middle = centre(cell);
  const long double half = std::max(cell + 0.25, 0.5) / (cells_per_unit * cells_per_unit);
  std::array<long double, count> t, f;
  for (int i = 0; i < count; ++i) {
    const long double node = std::cos(std::numbers::pi_v<long double> * (i + 0.5L) / count);
    const double x = static_cast<double>(std::sqrt(middle + half * node));  // exact from here on
    t[i] = (static_cast<long double>(x) * x - middle) / half;
    f[i] = profile(order, x);
  }
  for (int level = 1; level < count; ++level)
    for (int i = count - 1; i >= level; --i) f[i] = (f[i] - f[i - 1]) / (t[i] - t[i - level]);
  std::array<long double, count> power{};
  for (int i = count - 1; i >= 0; --i) {
    for (int k = degree; k > 0; --k) power[k] = power[k - 1] - t[i] * power[k];
    power[0] = f[i] - t[i] * power[0];
  }
  Cell result;
  for (int k = 0; k < count; ++k) result.c[k] = static_cast<double>(power[k] / std::pow(half, k));
  return result;
}

/// By the C library's, good to rounding.
BesselProfile::Jet BesselProfile::far_jet(double u) const {
  const double x = std::sqrt(u);
  if (!std::isfinite(x)) return {u, u};
  const double scale = std::pow(x, -order_);
  return {::jn(order_, x) * scale, -::jn(order_ + 1, x) * scale / (2 * x)};
}

}  // namespace flatspeckle::grin
