#include "grin/trace/image_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/QR>

namespace flatspeckle::grin {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;
constexpr int order = 8, terms = (order + 1) * (order + 2) / 2;

/// Direction of a ray relative to the mean direction, in units of the numerical aperture, and its
/// path difference in wavelengths.
struct PupilPoint {
  Eigen::Vector2d at;
  double difference;
};

/// Returns products of Legendre polynomials of total order up to 8, which span the same functions
/// as the Zernike polynomials.
std::array<double, terms> polynomials(const Eigen::Vector2d& at) {
  std::array<std::array<double, order + 1>, 2> legendre{};
  for (int axis = 0; axis < 2; ++axis) {
    auto& p = legendre[axis];
    p[0] = 1;
    p[1] = at[axis];
    for (int n = 1; n < order; ++n)
      p[n + 1] = ((2 * n + 1) * at[axis] * p[n] - n * p[n - 1]) / (n + 1);
  }
  std::array<double, terms> values{};
  int term = 0;
  for (int i = 0; i <= order; ++i)
    for (int j = 0; i + j <= order; ++j) values[term++] = legendre[0][i] * legendre[1][j];
  return values;
}

double numerical_aperture(const RayImage& image, const std::vector<TracedRay>& rays,
                          std::vector<PupilPoint>& pupil, double wavelength) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& ray : image.rays) {
    const Eigen::Vector2d across = image.axes.transpose() * rays[ray.number].end.v;
    pupil.push_back({across, ray.path_difference / wavelength});
    middle += across / static_cast<double>(image.rays.size());
  }
  double aperture = 0;
  for (PupilPoint& point : pupil) {
    point.at -= middle;
    aperture = std::max(aperture, point.at.norm());
  }
  for (PupilPoint& point : pupil) point.at /= aperture;
  return aperture;
}

double strehl_ratio(const RayImage& image, double RayImage::Ray::*difference, double wavelength) {
  std::complex<double> sum = 0;
  for (const auto& ray : image.rays)
    sum += std::polar(1.0 / static_cast<double>(image.rays.size()),
                      two_pi * (ray.*difference) / wavelength);
  return std::norm(sum);
}

/// Fits polynomials to path differences, in wavelengths. Returns nullopt if the rays do not fill
/// the pupil, or if the fit misses them by 0.05 (rms).
std::optional<Eigen::VectorXd> fitted(const std::vector<PupilPoint>& pupil) {
  constexpr std::size_t least_rays = 100;
  constexpr double worst = 0.05;
  if (pupil.size() < least_rays) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(pupil.size());
  Eigen::MatrixXd matrix(count, terms);
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [at, difference] = pupil[static_cast<std::size_t>(i)];
    const auto row = polynomials(at);
    matrix.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), terms);
    values[i] = difference;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(matrix);
  if (solver.rank() < terms) return std::nullopt;
  Eigen::VectorXd coefficients = solver.solve(values);
  const double rms =
      (matrix * coefficients - values).norm() / std::sqrt(static_cast<double>(count));
  return rms < worst ? std::optional(std::move(coefficients)) : std::nullopt;
}

/// Pupil function on a square of nodes over the unit disk.
class Pupil {
 public:
  static constexpr int half = 100, side = 2 * half + 1, frequencies = 20;

  explicit Pupil(const Eigen::VectorXd& coefficients) : values_(side * side, 0) {
    for (int i = -half; i <= half; ++i)
      for (int j = -half; j <= half; ++j) {
        const Eigen::Vector2d at = Eigen::Vector2d(i, j) / half;
        if (at.squaredNorm() > 1) continue;
        const auto row = polynomials(at);
        const double difference =
            coefficients.dot(Eigen::Map<const Eigen::VectorXd>(row.data(), terms));
        values_[number(i, j)] = std::polar(1.0, two_pi * difference);
      }
  }

  /// Returns the modulus of the sum over all nodes of the product of the values at two nodes that
  /// are this far apart.
  double correlation(int apart, bool along_x, bool of_ideal) const {
    std::complex<double> sum = 0;
    const int di = along_x ? apart : 0, dj = apart - di;
    for (int i = -half; i + di <= half; ++i)
      for (int j = -half; j + dj <= half; ++j) {
        const auto product = values_[number(i + di, j + dj)] * std::conj(values_[number(i, j)]);
        sum += of_ideal ? std::abs(product) : product;
      }
    return std::abs(sum);
  }

 private:
  static std::size_t number(int i, int j) {
    return static_cast<std::size_t>((i + half) * side + j + half);
  }
  std::vector<std::complex<double>> values_;
};

Modulation modulation_of(const Eigen::VectorXd& coefficients, double cutoff) {
  const Pupil pupil(coefficients);
  const double all = pupil.correlation(0, true, true);
  Modulation found;
  for (int f = 0; f <= Pupil::frequencies; ++f) {
    const int apart = 2 * Pupil::half * f / Pupil::frequencies;
    found.frequency.push_back(cutoff * f / Pupil::frequencies);
    found.along_x.push_back(pupil.correlation(apart, true, false) / all);
    found.along_y.push_back(pupil.correlation(apart, false, false) / all);
    found.of_ideal.push_back(pupil.correlation(apart, true, true) / all);
  }
  return found;
}

}  // namespace

std::optional<ImageQuality> image_quality(const RayImage& image, const std::vector<TracedRay>& rays,
                                          double wavelength) {
  if (!image.focus) return std::nullopt;
  std::vector<PupilPoint> pupil;
  ImageQuality quality{};
  quality.wavelength = wavelength;
  quality.aperture = numerical_aperture(image, rays, pupil, wavelength);
  quality.strehl = strehl_ratio(image, &RayImage::Ray::path_difference, wavelength);
  quality.best_strehl = strehl_ratio(image, &RayImage::Ray::least_path_difference, wavelength);
  if (const auto coefficients = fitted(pupil))
    quality.modulation = modulation_of(*coefficients, 2 * quality.aperture / wavelength);
  return quality;
}

}  // namespace flatspeckle::grin
