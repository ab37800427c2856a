#include "grating_oracle.h"

#include <cmath>
#include <numbers>

#include "core/numbers/bessel.h"
#include "core/numbers/blas.h"

namespace flatspeckle::wave {

namespace {

struct Oracle {
  Oracle(const Scatterer& cylinder, double wavenumber, const Period& given)
      : k(wavenumber), period(given), height(given.width / 4 + cylinder.radius / 2) {
    reach = k * std::hypot(period.width / 2, height);
    const double ratio = (period.width - cylinder.radius) * k / reach;
    order = static_cast<int>(reach + 34 / std::log(ratio) + 6);
    t = t_matrix(cylinder, k, order + 1);
    scale = bessel_j(order + 1, reach);
    const double decay = 34 / (height - cylinder.radius);
    evanescent = static_cast<int>(std::hypot(k, decay) * period.width / (2 * std::numbers::pi)) + 2;
  }

  // Size of wave n at the corners of the cell.
  long double size(int n) const { return std::abs(n) < reach ? 1 : std::abs(scale[std::abs(n)]); }

  // Adds the values and the derivatives along x or z, divided by k, of all waves to two rows.
  void add(Vec r, double alpha, Complex factor, Complex* value, Complex* derivative,
           std::size_t rows) const {
    const auto j = bessel_j(order + 1, k * length(r));
    const auto h = hankel(order + 1, k * length(r));
    const double angle = std::atan2(r.x, r.z);
    // J_m + T_n H_m, which is regular at the origin except for the waves scattered by the cylinder
    const auto wave = [&](int m, int n) {
      const ExtendedComplex value =
          ExtendedComplex(j[std::abs(m)]) + t[std::abs(n)] * h[std::abs(m)];
      return (m < 0 && m % 2 != 0 ? -value : value) * ExtendedComplex(std::polar(1.0, m * angle));
    };
    for (int n = -order; n <= order; ++n) {
      const std::size_t column = n + order;
      const ExtendedComplex along =
          0.5L * (wave(n - 1, n) * ExtendedComplex(std::polar(1.0, alpha)) -
                  wave(n + 1, n) * ExtendedComplex(std::polar(1.0, -alpha)));
      value[column * rows] += factor * Complex(wave(n, n) / size(n));
      derivative[column * rows] += factor * Complex(along / size(n));
    }
  }

  double k;
  Period period;
  double height, reach = 0;
  int order = 0, evanescent = 0;
  std::vector<ExtendedComplex> t;
  std::vector<long double> scale;
};

}  // namespace

GratingField grating_oracle(const Scatterer& cylinder, double k, const Period& period,
                            const CellChannel& light) {
  const Oracle oracle(cylinder, k, period);
  const int waves = 2 * oracle.order + 1, channels = 2 * oracle.evanescent + 1;
  const int columns = waves + 2 * channels, sides = columns, lines = columns;
  const std::size_t rows = 2 * sides + 4 * lines;
  std::vector<Complex> matrix(rows * columns), rhs(rows);
  for (int i = 0; i < sides; ++i) {
    const double z = -oracle.height * std::cos((i + 0.5) * std::numbers::pi / sides);
    Complex* const value = &matrix[2 * i];
    for (const int side : {-1, 1})
      oracle.add({side * period.width / 2, z}, std::numbers::pi / 2,
                 side < 0 ? -std::polar(1.0, period.phase) : Complex(1), value, value + 1, rows);
  }
  for (int i = 0; i < lines; ++i) {
    const double x = -period.width / 2 * std::cos((i + 0.5) * std::numbers::pi / lines);
    for (const int side : {-1, 1}) {
      const std::size_t row = 2 * sides + 4 * i + (side < 0 ? 0 : 2);
      oracle.add({x, side * oracle.height}, 0, 1, &matrix[row], &matrix[row + 1], rows);
      for (int m = -oracle.evanescent; m <= oracle.evanescent; ++m) {
        const double sine = (2 * std::numbers::pi * m + period.phase) / (k * period.width);
        const Complex cosine = std::sqrt(Complex((1 - sine) * (1 + sine)));
        const std::size_t column = waves + (side < 0 ? 0 : channels) + m + oracle.evanescent;
        const Complex wave = std::polar(1.0, k * sine * x);
        matrix[row + rows * column] = -wave;
        matrix[row + 1 + rows * column] = -wave * Complex(0, side) * cosine;
      }
      if (side > 0) continue;
      rhs[row] = std::polar(1.0, k * (light.sine * x - light.cosine * oracle.height));
      rhs[row + 1] = Complex(0, light.cosine) * rhs[row];
    }
  }
  const auto m = static_cast<lapack_int>(rows);
  LAPACKE_zgels(LAPACK_COL_MAJOR, 'N', m, columns, 1, matrix.data(), m, rhs.data(), m);
  GratingField field;
  for (std::size_t i = columns; i < rows; ++i)
    field.misfit = std::hypot(field.misfit, std::abs(rhs[i]));
  for (const CellChannel& channel : channels_of(k, period)) {
    const std::size_t column = waves + channel.number + oracle.evanescent;
    const Complex to_origin = std::polar(1.0, -k * channel.cosine * oracle.height);
    field.reflected.push_back(rhs[column] * to_origin);
    field.transmitted.push_back(rhs[column + channels] * to_origin);
  }
  return field;
}

}  // namespace flatspeckle::wave
