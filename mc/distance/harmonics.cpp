#include "mc/distance/harmonics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/contract.h"
#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// Calls f(cosine, weight) for the nodes of a quadrature over cosines in [0, 1] that has the
/// critical angle and the limits of detection at ends of panels. Square roots at the critical angle
/// are integrated exactly, by nodes that are quadratic in the distance from it.
template <typename F>
void each_cosine(std::initializer_list<double> ends, double critical, const F& f) {
  static const QuadratureRule rule = gauss_legendre(40);
  std::vector<double> sorted(ends);
  std::ranges::sort(sorted);
  for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
    const double from = sorted[i], length = sorted[i + 1] - from;
    if (length == 0) continue;
    for (std::size_t j = 0; j < rule.node.size(); ++j) {
      const double t = rule.node[j];
      if (from == critical)
        f(from + length * t * t, 2 * t * length * rule.weight[j]);
      else
        f(from + length * t, length * rule.weight[j]);
    }
  }
}

double root_of_binomial(int n, int k) {
  return std::exp(0.5 * (std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1)));
}

/// Legendre polynomials of 2 cosine - 1 of degrees 0 .. count - 1, times sin(theta)^m.
std::vector<double> half_range_functions(int m, std::size_t count, double cosine) {
  std::vector<double> functions(count);
  const double x = 2 * cosine - 1, edge = std::pow(1 - cosine * cosine, 0.5 * m);
  double before = 0, value = 1;
  for (std::size_t j = 0; j < count; ++j) {
    functions[j] = edge * value;
    const double n = static_cast<double>(j);
    before = std::exchange(value, ((2 * n + 1) * x * value - n * before) / (n + 1));
  }
  return functions;
}

}  // namespace

std::vector<double> legendre_functions(int m, int last, double cosine) {
  std::vector<double> p(static_cast<std::size_t>(last - m) + 1);
  double value = std::sqrt(0.5), before = 0;
  for (int i = 1; i <= m; ++i) value *= std::sqrt((2 * i + 1) / (2.0 * i) * (1 - cosine * cosine));
  for (int l = m; l <= last; ++l) {
    p[static_cast<std::size_t>(l - m)] = value;
    const double below = l > m ? RadianceHarmonics::coupling(l - 1, m) : 0;
    before =
        std::exchange(value, (cosine * value - below * before) / RadianceHarmonics::coupling(l, m));
  }
  return p;
}

RadianceHarmonics::RadianceHarmonics(int order)
    : order_(order), position_(static_cast<std::size_t>((order + 1) * (order + 1))) {
  FS_EXPECT(order % 2 == 1);
  for (int m = 0; m <= order; ++m)
    for (int l = m; l <= order; ++l) {
      auto& list = (l + m) % 2 == 0 ? even_ : odd_;
      position_[static_cast<std::size_t>(m * (order + 1) + l)] = list.size();
      list.push_back({l, m});
    }
}

double RadianceHarmonics::coupling(int l, int m) {
  return std::sqrt(((l + 1.0) * (l + 1.0) - m * m) / ((2.0 * l + 1) * (2.0 * l + 3)));
}

Eigen::VectorXcd RadianceHarmonics::flow(const Eigen::VectorXcd& even) const {
  Eigen::VectorXcd flow(odd_.size());
  for (std::size_t i = 0; i < odd_.size(); ++i) {
    const auto [l, m] = odd_[i];
    flow[i] = coupling(l - 1, m) * even[position({l - 1, m})];
    if (l < order_) flow[i] += coupling(l, m) * even[position({l + 1, m})];
  }
  return flow;
}

Rows RadianceHarmonics::transport(Complex q, double decay) const {
  const auto size = static_cast<Eigen::Index>(even_.size() + odd_.size());
  const auto row = [&](Index at) {
    return static_cast<Eigen::Index>(position(at) + ((at.l + at.m) % 2 == 0 ? 0 : even_.size()));
  };
  Rows matrix = Rows::Zero(size, size);
  const auto couple = [&](Index a, Index b, Complex value) {
    matrix(row(a), row(b)) = matrix(row(b), row(a)) = value;
  };
  for (int m = 0; m <= order_; ++m)
    for (int l = m; l <= order_; ++l) {
      if (l < order_) couple({l, m}, {l + 1, m}, -decay * coupling(l, m));
      const Complex half = Complex(0, 1) * q * (m == 0 ? std::sqrt(0.5) : 0.5);
      if (l < order_)
        couple({l, m}, {l + 1, m + 1},
               half * std::sqrt((l + m + 1.0) * (l + m + 2) / ((2.0 * l + 1) * (2 * l + 3))));
      if (l > m + 1)
        couple({l, m}, {l - 1, m + 1},
               -half * std::sqrt((l - m) * (l - m - 1.0) / ((2.0 * l - 1) * (2 * l + 1))));
    }
  return matrix;
}

FaceConditions RadianceHarmonics::face(const Face& face, double sine_limit) const {
  const double ratio = face.to / face.from, critical = ratio < 1 ? std::sqrt(1 - ratio * ratio) : 0,
               limit = std::sqrt(std::max(0.0, 1 - sine_limit * sine_limit));
  const auto size = static_cast<Eigen::Index>(odd_.size());
  FaceConditions found{Matrix::Zero(size, size), Eigen::VectorXd::Zero(size)};
  Eigen::Index first = 0;
  for (int m = 0; m < order_; ++m) {
    const auto count = static_cast<std::size_t>((order_ - m + 1) / 2);
    const auto n = static_cast<Eigen::Index>(count);
    Matrix odd = Matrix::Zero(n, n), flow = Matrix::Zero(n, n);
    Eigen::VectorXd exit = Eigen::VectorXd::Zero(n);
    each_cosine({0, critical, limit, 1}, critical, [&](double cosine, double weight) {
      const double reflectance = face.reflectance(cosine);
      const auto all = legendre_functions(m, order_, cosine);
      const auto half = half_range_functions(m, count, cosine);
      for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < n; ++i) {
          const double both = weight * all[static_cast<std::size_t>(2 * i + 1)] * half[j];
          odd(i, j) += (1 - reflectance) * both;
          flow(i, j) += (1 + reflectance) * cosine * both;
        }
        if (m == 0 && cosine > limit)
          exit[j] += std::sqrt(2 * pi) * weight * (1 - reflectance) * cosine * half[j];
      }
    });
    const FactorsOf<Matrix> factors(flow.transpose());
    found.admittance.block(first, first, n, n) = factors.before(odd.transpose()).transpose();
    if (m == 0) found.exit.head(n) = factors.before(exit);
    first += n;
  }
  return found;
}

HarmonicRotation::HarmonicRotation(const RadianceHarmonics& harmonics)
    : harmonics_(harmonics), order_(harmonics.order()) {
  for (int m = 0; m <= order_; ++m)
    for (int n = -order_; n <= order_; ++n) columns_.push_back(made_column(m, n, order_));
}

HarmonicRotation::Column HarmonicRotation::made_column(int m, int n, int order) {
  const int lowest = std::max(m, std::abs(n));
  Column column{root_of_binomial(2 * lowest, std::abs(m + n)), {}};
  for (int l = lowest; l < order; ++l) {
    if (l == 0) {
      column.steps.push_back({1, 0, 0});
      continue;
    }
    const double here = std::sqrt(double(l * l - m * m) * (l * l - n * n)),
                 above = std::sqrt(double((l + 1) * (l + 1) - m * m) * ((l + 1) * (l + 1) - n * n));
    column.steps.push_back({(2 * l + 1) * (l + 1) / above, double(m * n) / (l * (l + 1)),
                            (l + 1) * here / (l * above)});
  }
  return column;
}

template <typename F>
void HarmonicRotation::each(int m, int n, Complex cosine, const std::vector<Complex>& cosines,
                            const std::vector<Complex>& sines, const F& f) const {
  const Column& column = this->column(m, n);
  const double sign = n > m || (m - n) % 2 == 0 ? 1 : -1;
  Complex before = 0,
          value = sign * column.first * product(cosines[std::abs(m + n)], sines[std::abs(m - n)]);
  int l = std::max(m, std::abs(n));
  f(l, value);
  for (const Step& step : column.steps) {
    const Complex next =
        step.scale * product(cosine - step.shift, value) - step.previous_scale * before;
    before = value;
    value = next;
    f(++l, value);
  }
}

HarmonicRotation::Rotated HarmonicRotation::operator()(int azimuth,
                                                       std::span<const double> coefficients,
                                                       Complex cosine, Complex sine) const {
  const Complex half_cosine = std::sqrt((1.0 + cosine) / 2.0),
                half_sine = sine / (2.0 * half_cosine);
  std::vector<Complex> cosines{1}, sines{1};
  for (int i = 0; i < 2 * order_; ++i) {
    cosines.push_back(product(cosines.back(), half_cosine));
    sines.push_back(product(sines.back(), half_sine));
  }
  Rotated found{Eigen::VectorXcd::Zero(harmonics_.even().size()),
                Eigen::VectorXcd::Zero(harmonics_.odd().size())};
  for (int m = 0; m <= order_; ++m) {
    const double sign = (m + azimuth) % 2 == 0 ? 1 : -1;
    const double factor = m == 0 && azimuth == 0   ? 1
                          : m == 0 || azimuth == 0 ? sign * std::numbers::sqrt2
                                                   : sign;
    const auto add = [&](double scale) {
      return [&, scale](int l, Complex d) {
        auto& list = (l + m) % 2 == 0 ? found.even : found.odd;
        list[harmonics_.position({l, m})] +=
            scale * coefficients[static_cast<std::size_t>(l - azimuth)] * d;
      };
    };
    each(m, azimuth, cosine, cosines, sines, add(factor));
    if (m > 0 && azimuth > 0)
      each(m, -azimuth, cosine, cosines, sines, add(azimuth % 2 == 0 ? factor : -factor));
  }
  return found;
}

}  // namespace flatspeckle::mc
