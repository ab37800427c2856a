// Special functions, phases and sums, compared with 50 digits where double precision may not
// suffice.

#include <algorithm>
#include <cmath>

#include "bench/oracles/multiprecision.h"
#include "bench/stability/extreme_rows.h"
#include "core/numbers/bessel.h"
#include "core/numbers/hankel_array.h"
#include "core/numbers/phasor.h"
#include "core/numbers/random.h"
#include "core/numbers/statistics.h"

namespace flatspeckle::bench {

namespace {

using namespace oracles;

/// Compares H_n relative to |H_n|, and J_n relative to |J_n|, because for orders n > x J_n is
/// negligible in H_n.
Finding cylinder_row(double x, const std::vector<int>& orders) {
  const int last = *std::max_element(orders.begin(), orders.end());
  const auto h = scaled_hankel(last, x);
  const auto j = scaled_bessel_j(last, x);
  return worst_of(orders, 1e-14, [&](int n) {
    const auto exact = bessel_oracle(n, x);
    const Wide size = exact.size(), j_size = n > x ? abs(exact.j) : size;
    const Wide off_h = abs(wide(h[n]) - WideComplex(exact.j, exact.y)) / size,
               off_j = abs(wide(j[n]) - exact.j) / j_size;
    return larger({static_cast<double>(off_h), static_cast<double>(off_j)});
  });
}

/// Compares the vectorised Hankel functions for arguments of all magnitudes in one call.
Finding hankel_sets_row() {
  const std::vector<double> x{1e-300, 1e-100, 1e-8, 3.999999, 4, 4.000001, 8388608, 1e9, 1e15};
  constexpr int order = 8;
  std::vector<double> re(x.size() * (order + 1)), im(re.size());
  hankel_sets(x, order, re.data(), im.data());
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int n = 0; n <= order; ++n) {
      const auto [j, y] = bessel_oracle(n, x[i]);
      if (abs(y) > 1e300) continue;
      const Wide size = BesselOracle{j, y}.size();
      const double at_re = re[n * x.size() + i], at_im = im[n * x.size() + i];
      worst = larger({worst, error(at_re, j, size), error(at_im, y, size)});
    }
  return {worst, 2e-15};  // (1 + n/8) 1e-15 of |H_n|
}

Finding ratio_row(ExtendedComplex z) {
  constexpr int order = 200;
  const auto found = bessel_ratios(order, z);
  const auto exact = wide_bessel_ratios(order, wide(z));
  double worst = 0;
  for (int n = 0; n <= order; ++n) worst = larger(worst, relative_error(wide(found[n]), exact[n]));
  return {worst, 1e-15};
}

/// Compares phases of large arguments: over 1e8 wavelengths, the largest box, they reach 6e8.
Finding phasor_row() {
  std::vector<double> phase, none;
  for (double p = 1e-300; p < 1e300; p *= 1.7e7) phase.insert(phase.end(), {p, -p});
  for (int i = 0; i < 1000; ++i) phase.push_back(6.3e8 + 0.7 * i);
  std::erase_if(phase, [](double p) { return std::abs(p) > 1e12; });
  none.resize(phase.size());
  std::vector<Complex> found(phase.size());
  damped_phasors(phase, none, found);
  double worst = 0;
  for (std::size_t i = 0; i < phase.size(); ++i) {
    const long double p = phase[i];
    const ExtendedComplex exact(std::cos(p), std::sin(p));
    worst = larger(worst, static_cast<double>(std::abs(ExtendedComplex(found[i]) - exact)));
  }
  return {worst, 1e-15};
}

/// Checks that damping underflows to 0 and does not give NaN.
Finding damping_row() {
  std::vector<double> log_magnitude, found;
  for (double d = 1e-300; d < 1e300; d *= 1.9e3) log_magnitude.push_back(-d);
  for (double d = 690; d < 760; d += 0.37) log_magnitude.push_back(-d);
  found.resize(log_magnitude.size());
  damping(log_magnitude, found);
  double worst = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double exact = std::exp(log_magnitude[i]);
    worst = larger(worst, exact > 0x1p-1022 ? std::abs(found[i] / exact - 1) : found[i]);
  }
  return {worst, 1e-15};
}

/// Compares the standard error for a mean of 1e8 and a spread of 1 with that for mean 0. The sum of
/// 1e12 is rounded to 1e-4.
Finding jackknife_row() {
  const auto error_with = [](double offset) {
    GroupedSums sums(1);
    RandomStream random(1, 0, 0);
    for (int batch = 0; batch < 1000; ++batch) {
      const std::vector<Complex> sum{10 * offset + random.uniform()};
      sums.add(10, sum);
    }
    return jackknife(sums, sample_mean).error[0];
  };
  return {std::abs(error_with(1e8) / error_with(0) - 1), 1e-4};
}

/// Checks that uniform numbers are strictly between 0 and 1; 1 would give an infinite free flight.
Finding uniform_row() {
  const double least = RandomStream::uniform(0), most = RandomStream::uniform(~std::uint64_t{0});
  return yes(least > 0 && most < 1);
}

std::vector<int> orders_to(int last) {
  std::vector<int> orders;
  for (int n = 0; n < last; n = n < 3 ? n + 1 : 3 * n / 2) orders.push_back(n);
  orders.push_back(last);
  return orders;
}

}  // namespace

void function_extremes(ExtremeRows& rows) {
  const std::string digits = "against 50 digits";
  for (const auto& [x, order] :
       {std::pair(1e-300, 60), {1e-8, 60}, {1e-4, 4000}, {1e6, 60}, {1e15, 60}})
    rows.add("J_n, H_n, argument " + short_number(x) + ", orders to " + std::to_string(order),
             digits, cylinder_row, x, orders_to(order));
  rows.add("J_n, H_n, argument 1000, at the turning point n = 990 .. 1030", digits, cylinder_row,
           1000, std::vector{990, 998, 999, 1000, 1001, 1002, 1010, 1030});
  rows.add("H_n of arrays, arguments 1e-300 to 1e15", digits, hankel_sets_row);
  rows.add("J_{n+1}/J_n, argument 10 + 1000i, orders to 200", digits, ratio_row,
           ExtendedComplex(10, 1000));
  rows.add("J_{n+1}/J_n, argument 1e-8 (1 + i), orders to 200", digits, ratio_row,
           ExtendedComplex(1e-8L, 1e-8L));
  rows.add("phases up to 1e12, also next to 0", "against long double", phasor_row);
  rows.add("damping exp(-x), x from 1e-300 to 1e300", "against libm", damping_row);
  rows.add("error bar where the mean is 1e8 spreads", "as without the mean", jackknife_row);
  rows.add("uniform numbers of the least and largest bits", "within (0, 1)", uniform_row);
}

}  // namespace flatspeckle::bench
