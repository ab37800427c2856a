#include "flatland/media/structure_factor.h"

#include <cmath>
#include <map>
#include <numbers>

#include "core/contract.h"
#include "core/result/result_group.h"

namespace flatspeckle {

namespace {

/// Returns the numerator N in d(eta Z) / d eta = N / (1 - eta)^3, with eta the packing fraction and
/// Z the compressibility factor by Henderson's equation of state.
double stiffness_numerator(double packing) {
  return 1 + packing + 3 * packing * packing / 8 - std::pow(packing, 3) / 8;
}

/// Returns the length a of Baus and Colot, in diameters, for which the integral of the direct
/// correlation function c(r) agrees with the equation of state (eta: packing fraction, stiffness =
/// d(eta Z) / d eta):
///   (2/pi) [a^2 (a^2 - 4) asin(1/a) - (a^2 + 2) sqrt(a^2 - 1)]
///     = (1 - 4 eta - 1/stiffness) / eta^2.
/// The code computes the right-hand side without cancellation.
double overlap_scale(double packing) {
  const double wanted =
      (-6.625 - 0.625 * packing + 0.5 * packing * packing) / stiffness_numerator(packing);
  const auto left = [](double a) {
    return 2 / std::numbers::pi *
           (a * a * (a * a - 4) * std::asin(1 / a) - (a * a + 2) * std::sqrt(a * a - 1));
  };
  double low = 1, high = 2.1;  // left() falls from -3 to below every possible `wanted`
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (left(middle) > wanted ? low : high) = middle;
  }
  return low;
}

/// Returns the common area of two disks of diameter 1 whose centres are x <= 1 apart, divided by
/// the area of one disk.
double overlap(double x) {
  return 2 / std::numbers::pi * (std::acos(x) - x * std::sqrt(1 - x * x));
}

/// Returns the integral of x J_0(q x) over (0, 1).
double disk_transform(double q) {
  return q < 1e-4 ? 0.5 : ::j1(q) / q;
}

/// Returns the integral of x overlap(x / scale) J_0(q x) over (0, 1), scale > 1, by Simpson's rule
/// to 1e-6.
double overlap_transform(double q, double scale) {
  const int intervals = 2 * (32 + static_cast<int>(4 * q));
  double sum = 0;
  for (int i = 1; i <= intervals; ++i) {
    const double x = static_cast<double>(i) / intervals;
    const int weight = i == intervals ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * x * overlap(x / scale) * ::j0(q * x);
  }
  return sum / (3 * intervals);
}

/// Values of cos(i phase) and sin(i phase) for i = first .. last.
struct Phasors {
  std::vector<double> cosine, sine;
  Phasors(double phase, std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t i = first; i <= last; ++i) {
      cosine.push_back(std::cos(static_cast<double>(i) * phase));
      sine.push_back(std::sin(static_cast<double>(i) * phase));
    }
  }
};

}  // namespace

HardDiskFluid::HardDiskFluid(double packing, double diameter)
    : packing_(packing),
      diameter_(diameter),
      stiffness_(stiffness_numerator(packing) / std::pow(1 - packing, 3)),
      scale_(overlap_scale(packing)) {
  FS_EXPECT(packing >= 0 && packing <= 0.7 && diameter > 0);
}

double HardDiskFluid::contact_value() const {
  // (Z - 1) / (2 eta), without cancellation.
  return (1 - 7 * packing_ / 16) / std::pow(1 - packing_, 2);
}

// S = 1 / (1 - rho c(q)), with rho the number density and c(q) the Fourier transform of c(r) =
// -stiffness [1 - a^2 eta + a^2 eta overlap(r / a)] for r < 1, and 0 beyond; r is in diameters, a =
// scale_.
double HardDiskFluid::structure_factor(double q) const {
  const double x = q * diameter_, weight = scale_ * scale_ * packing_;
  const double transform = (1 - weight) * disk_transform(x) + weight * overlap_transform(x, scale_);
  return 1 / (1 + 8 * packing_ * stiffness_ * transform);
}

MeasuredStructureFactor::MeasuredStructureFactor(const Domain& box, double q_max,
                                                 double shell_width)
    : box_(box),
      most_n_(static_cast<std::size_t>(q_max * box.width / (2 * std::numbers::pi))),
      most_m_(static_cast<std::size_t>(q_max * box.depth / (2 * std::numbers::pi))) {
  std::map<std::size_t, std::vector<Wavevector>> shells;
  for (std::size_t n = 0; n <= most_n_; ++n) {
    const double q_x = 2 * std::numbers::pi * static_cast<double>(n) / box.width;
    // Half of all wavevectors suffice, because S(-q) = S(q).
    for (std::size_t j = n == 0 ? most_m_ + 1 : 0; j <= 2 * most_m_; ++j) {
      const double m = static_cast<double>(j) - static_cast<double>(most_m_);
      const double q = std::hypot(q_x, 2 * std::numbers::pi * m / box.depth);
      if (q <= q_max)
        shells[static_cast<std::size_t>(q / shell_width)].push_back(
            {n * (2 * most_m_ + 1) + j, q, 0});
    }
  }
  for (auto& [number, members] : shells) {
    for (Wavevector& each : members) each.shell = members_.size();
    wavevectors_.insert(wavevectors_.end(), members.begin(), members.end());
    members_.push_back(static_cast<double>(members.size()));
  }
  mean_.resize(members_.size());
  squares_.resize(members_.size());
}

/// Returns |sum_j exp(i q.r_j)|^2, with r_j the centres, for q = (2 pi n / width, 2 pi m / depth):
/// [n][m + most_m].
std::vector<double> MeasuredStructureFactor::density_waves(std::span<const Vec> centres) const {
  const std::size_t columns = 2 * most_m_ + 1;
  const auto m = static_cast<std::ptrdiff_t>(most_m_);
  std::vector<double> real((most_n_ + 1) * columns), imaginary(real.size());
  for (const Vec& centre : centres) {
    const Phasors x(2 * std::numbers::pi * centre.x / box_.width, 0,
                    static_cast<std::ptrdiff_t>(most_n_));
    const Phasors z(2 * std::numbers::pi * centre.z / box_.depth, -m, m);
    for (std::size_t n = 0; n <= most_n_; ++n) {
      const double c = x.cosine[n], s = x.sine[n];
      double *const re = &real[n * columns], *const im = &imaginary[n * columns];
      for (std::size_t j = 0; j < columns; ++j) {
        re[j] += c * z.cosine[j] - s * z.sine[j];
        im[j] += c * z.sine[j] + s * z.cosine[j];
      }
    }
  }
  for (std::size_t i = 0; i < real.size(); ++i)
    real[i] = real[i] * real[i] + imaginary[i] * imaginary[i];
  return real;
}

void MeasuredStructureFactor::add(std::span<const Vec> centres) {
  const auto waves = density_waves(centres);
  const auto number = static_cast<double>(centres.size());
  std::vector<double> found(members_.size());
  for (const auto& [index, q, shell] : wavevectors_)
    found[shell] += waves[index] / number / members_[shell];
  ++realizations_;
  for (std::size_t shell = 0; shell < mean_.size(); ++shell) {
    const double deviation = found[shell] - mean_[shell];
    mean_[shell] += deviation / static_cast<double>(realizations_);
    squares_[shell] += deviation * (found[shell] - mean_[shell]);
  }
}

std::vector<double> MeasuredStructureFactor::shell_means(
    const std::function<double(double)>& f) const {
  std::vector<double> means(members_.size());
  for (const Wavevector& each : wavevectors_) means[each.shell] += f(each.q) / members_[each.shell];
  return means;
}

std::vector<double> MeasuredStructureFactor::values() const {
  return mean_;
}

std::vector<double> MeasuredStructureFactor::errors() const {
  FS_EXPECT(realizations_ >= 2);
  const auto n = static_cast<double>(realizations_);
  std::vector<double> errors;
  for (double squares : squares_) errors.push_back(std::sqrt(squares / (n * (n - 1))));
  return errors;
}

const DatasetTable structure_factor_table{
    "structure factor",
    {{"q", Data::scale, "", "1/length",
      "wavenumber q, mean over a shell of the wavevectors that fit the box"},
     {"structure_factor", Data::estimate, "q", "1", "structure factor S(q)"},
     {"structure_factor_theory", Data::real, "q", "1",
      "S(q) of the equilibrium fluid, Baus and Colot 1987"}}};

void write_structure(ResultFile& file, const MeasuredStructureFactor& measured,
                     const HardDiskFluid* fluid) {
  const ResultGroup root(file, structure_factor_table);
  root.put("q", measured.shell_means([](double q) { return q; }));
  root.put("structure_factor", measured.values(), measured.errors());
  if (fluid != nullptr)
    root.put("structure_factor_theory",
             measured.shell_means([&](double q) { return fluid->structure_factor(q); }));
}

}  // namespace flatspeckle
