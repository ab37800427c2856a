#include "mc/paths/bent/graded_medium.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/error.h"
#include "core/numbers/fourier.h"
#include "mc/paths/bent/linear_medium.h"

namespace flatspeckle::mc {

namespace {

constexpr double cells_per_wavelength = 10;

std::size_t cells_along(double extent, double wavelength) {
  constexpr double fewest = 8;
  return static_cast<std::size_t>(
      std::ceil(std::max(fewest, cells_per_wavelength * extent / wavelength)));
}

/// Fourier-transforms a grid of `high` rows of `wide` values in place.
void transform(std::vector<Complex>& grid, std::size_t wide, std::size_t high,
               LineTransform::Direction direction) {
  const LineTransform along(wide, direction), across(high, direction);
  for (std::size_t row = 0; row < high; ++row) along(&grid[row * wide]);
  std::vector<Complex> line(high);
  for (std::size_t column = 0; column < wide; ++column) {
    for (std::size_t row = 0; row < high; ++row) line[row] = grid[row * wide + column];
    across(line.data());
    for (std::size_t row = 0; row < high; ++row) grid[row * wide + column] = line[row];
  }
}

Complex hankel_order_0(double x) {
  return {::j0(x), ::y0(x)};
}

/// Returns Dedekind's eta function at i y.
double eta(double y) {
  using std::numbers::pi;
  double product = std::exp(-pi * y / 12);
  for (int n = 1; n * y < 7; ++n) product *= -std::expm1(-2 * pi * n * y);
  return product;
}

Complex hermitian_product(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  Complex sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::conj(a[i]) * b[i];
  return sum;
}

double norm_of(const std::vector<Complex>& a) {
  return std::sqrt(hermitian_product(a, a).real());
}

/// Solves A x = b by BiCGSTAB [vandervorst1992], beginning with x = b.
template <typename Apply>
std::vector<Complex> solved_by_iteration(const Apply& apply, const std::vector<Complex>& b) {
  constexpr int most_steps = 2000;
  constexpr double tolerance = 1e-6;
  std::vector<Complex> x = b, r = apply(x);
  for (std::size_t i = 0; i < b.size(); ++i) r[i] = b[i] - r[i];
  const std::vector<Complex> shadow = r;
  std::vector<Complex> p = r;
  Complex rho = hermitian_product(shadow, r);
  const double size = norm_of(b);
  for (int step = 0; step < most_steps; ++step) {
    if (norm_of(r) <= tolerance * size) return x;
    const auto v = apply(p);
    const Complex alpha = rho / hermitian_product(shadow, v);
    for (std::size_t i = 0; i < b.size(); ++i) r[i] -= alpha * v[i];
    const auto t = apply(r);
    const Complex omega = hermitian_product(t, r) / hermitian_product(t, t);
    for (std::size_t i = 0; i < b.size(); ++i) {
      x[i] += alpha * p[i] + omega * r[i];
      r[i] -= omega * t[i];
    }
    const Complex next = hermitian_product(shadow, r), beta = next / rho * alpha / omega;
    rho = next;
    for (std::size_t i = 0; i < b.size(); ++i) p[i] = r[i] + beta * (p[i] - omega * v[i]);
  }
  throw std::runtime_error("mean field of the homogenised box: the iteration did not converge");
}

/// Medium whose mean field is refracted by the effective index n = 1 + k_shift/k. Attenuation is
/// exponential in sigma, as in media with an index field (C31), so that K^2 = k^2 n^2 + i k mu_t.
/// In a slab a plane wave is refracted by the laws of Snell and Fresnel, to leading order in the
/// reflection; in a box the mean field is computed by HomogenisedBox. Free flights between
/// scatterers are straight and end at the edge of the medium.
class MeanFieldMedium : public GradedMedium {
 public:
  explicit MeanFieldMedium(const Scene& scene)
      : domain_(scene.domain),
        k_(scene.k),
        mu_t_(scene.medium.mu_t),
        index_(1 + scene.medium.k_shift / scene.k) {}

  double square(Vec) const override { return index_ * index_; }
  double inside(Vec x, Vec w) const override { return domain_.distance_to_edge(x, w) / index_; }
  std::optional<RayPlace> after_flight(Vec x, Vec w, double sigma) const override;

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;

  Domain domain_;
  double k_, mu_t_, index_;
};

/// Plane wave refracted by the laws of Snell and Fresnel at the face through which it enters.
class RefractedWave : public Wavefront {
 public:
  RefractedWave(const Domain& slab, double index, double angle)
      : sine_(std::sin(angle)),
        cosine_(std::cos(angle)),
        face_(cosine_ > 0 ? 0 : slab.depth),
        square_(index * index - sine_ * sine_) {
    if (!(square_ > 0))
      throw InputError("light or view of angle", angle,
                       "is totally reflected at the face, by the index of the mean field");
  }

  std::optional<Arrival> at(Vec x) const override {
    const double deep = std::sqrt(square_), distance = std::abs(x.z - face_),
                 n = std::hypot(deep, sine_);
    return Arrival{1 / n * Vec{sine_, std::copysign(deep, cosine_)},
                   sine_ * x.x + cosine_ * face_ + deep * distance,
                   2 * std::abs(cosine_) / (std::abs(cosine_) + deep), distance / deep, 0};
  }

 private:
  double sine_, cosine_, face_, square_;
};

/// Field of a plane wave in a homogenised box. The ratio of the field to the incident plane wave
/// (the envelope) is interpolated by cubic convolution. The direction of arrival is the gradient of
/// the phase of the field.
class BoxWave : public Wavefront {
 public:
  BoxWave(const HomogenisedBox& box, const Domain& domain, double k, double angle)
      : w_(flatspeckle::direction(angle)),
        k_(k),
        half_(domain.width / 2),
        cell_(box.cell()),
        columns_(box.columns()),
        rows_(box.rows()),
        envelope_(box.field(angle)) {
    for (std::size_t row = 0; row < rows_; ++row)
      for (std::size_t column = 0; column < columns_; ++column)
        envelope_[row * columns_ + column] *=
            std::polar(1.0, -k * dot(w_, box.centre(column, row)));
  }

  std::optional<Arrival> at(Vec x) const override {
    const auto here = envelope_at((x.x + half_) / cell_.x - 0.5, x.z / cell_.z - 0.5);
    if (here.value == 0.0) return Arrival{w_, 0, 0, 0, 0};
    const auto along = [&](Complex derivative, double cell) {
      return std::imag(derivative / here.value) / (k_ * cell);
    };
    const Vec v = w_ + Vec{along(here.by_x, cell_.x), along(here.by_z, cell_.z)};
    return Arrival{1 / length(v) * v, dot(w_, x) + std::arg(here.value) / k_, std::abs(here.value),
                   0, 0};
  }

 private:
  struct Envelope {
    /// Value of the envelope, and its changes per cell along x and z
    Complex value{}, by_x{}, by_z{};
  };
  using Four = std::array<double, 4>;

  Envelope envelope_at(double along, double deep) const {
    const auto i = static_cast<std::ptrdiff_t>(std::floor(along)),
               j = static_cast<std::ptrdiff_t>(std::floor(deep));
    const double s = along - static_cast<double>(i), t = deep - static_cast<double>(j);
    const Four a = weights(s), b = weights(t), da = derivative_weights(s),
               db = derivative_weights(t);
    Envelope sum;
    for (std::size_t n = 0; n < 4; ++n)
      for (std::size_t m = 0; m < 4; ++m) {
        const Complex node =
            envelope_[clamped(j + static_cast<std::ptrdiff_t>(n) - 1, rows_) * columns_ +
                      clamped(i + static_cast<std::ptrdiff_t>(m) - 1, columns_)];
        sum.value += a[m] * b[n] * node;
        sum.by_x += da[m] * b[n] * node;
        sum.by_z += a[m] * db[n] * node;
      }
    return sum;
  }
  static Four weights(double t) {
    const double u = 1 - t;
    return {-t * u * u / 2, (2 - 5 * t * t + 3 * t * t * t) / 2,
            (2 - 5 * u * u + 3 * u * u * u) / 2, -t * t * u / 2};
  }
  static Four derivative_weights(double t) {
    const double u = 1 - t;
    return {u * (2 * t - u) / 2, t * (9 * t - 10) / 2, u * (10 - 9 * u) / 2, t * (t - 2 * u) / 2};
  }
  static std::size_t clamped(std::ptrdiff_t i, std::size_t size) {
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(size) - 1));
  }

  Vec w_;
  double k_, half_;
  Vec cell_;
  std::size_t columns_, rows_;
  std::vector<Complex> envelope_;
};

std::optional<RayPlace> MeanFieldMedium::after_flight(Vec x, Vec w, double sigma) const {
  if (!(sigma < inside(x, w))) return std::nullopt;
  return RayPlace{x + index_ * sigma * w, w};
}

std::shared_ptr<const Wavefront> MeanFieldMedium::wave_from_point(Vec) const {
  throw InputError("index_field", "mean_field", "requires plane waves and far views");
}

std::shared_ptr<const Wavefront> MeanFieldMedium::wave_from_afar(double angle) const {
  if (domain_.kind == Domain::Kind::slab)
    return std::make_shared<RefractedWave>(domain_, index_, angle);
  const HomogenisedBox box(domain_, k_, k_ * std::sqrt(Complex(square({}), mu_t_ / k_)));
  return std::make_shared<BoxWave>(box, domain_, k_, angle);
}

}  // namespace

HomogenisedBox::HomogenisedBox(const Domain& box, double k, Complex inside)
    : box_(box), k_(k), contrast_(inside * inside - k * k) {
  constexpr double most_cells = 4e6;
  const double wavelength = 2 * std::numbers::pi / k, per = cells_per_wavelength / wavelength;
  if (box.content() * per * per > most_cells)
    throw InputError("index_field", "mean_field",
                     "requires a box of at most 40000 square wavelengths; take a slab instead");
  columns_ = cells_along(box.width, wavelength);
  rows_ = cells_along(box.depth, wavelength);
  dx_ = box.width / static_cast<double>(columns_);
  dz_ = box.depth / static_cast<double>(rows_);
  wide_ = transform_size(2.0 * static_cast<double>(columns_));
  high_ = transform_size(2.0 * static_cast<double>(rows_));
  find_spectrum();
}

Vec HomogenisedBox::centre(std::size_t column, std::size_t row) const {
  return {-box_.width / 2 + (static_cast<double>(column) + 0.5) * dx_,
          (static_cast<double>(row) + 0.5) * dz_};
}

/// Computes the spectrum of the Green function by the midpoint rule on the lattice of cells. In the
/// cell at r = 0 the logarithm ln r of the Green function is replaced by ln(dx / (2 pi eta(i
/// dz/dx)^2)) (Kronecker's limit formula; Duan and Rokhlin [duan2009] for square cells).
void HomogenisedBox::find_spectrum() {
  using std::numbers::pi;
  const double log_of_cell = std::log(dx_ / (2 * pi * std::pow(eta(dz_ / dx_), 2)));
  const Complex cell(0, dx_ * dz_ / 4),
      own = cell * Complex(1, 2 / pi * (std::numbers::egamma + std::log(k_ / 2) + log_of_cell));
  spectrum_.assign(wide_ * high_, 0);
  for (std::size_t row = 0; row < high_; ++row)
    for (std::size_t column = 0; column < wide_; ++column) {
      const auto away = [](std::size_t i, std::size_t size) {
        return static_cast<double>(std::min(i, size - i));
      };
      const double r = std::hypot(dx_ * away(column, wide_), dz_ * away(row, high_));
      spectrum_[row * wide_ + column] = r == 0 ? own : cell * hankel_order_0(k_ * r);
    }
  transform(spectrum_, wide_, high_, LineTransform::Direction::forward);
  for (Complex& value : spectrum_) value /= static_cast<double>(wide_ * high_);
}

/// Returns (1 - (K^2 - k^2) G) field, where G is the convolution with the Green function.
std::vector<Complex> HomogenisedBox::applied(const std::vector<Complex>& field) const {
  std::vector<Complex> grid(wide_ * high_);
  for (std::size_t row = 0; row < rows_; ++row)
    std::copy_n(&field[row * columns_], columns_, &grid[row * wide_]);
  transform(grid, wide_, high_, LineTransform::Direction::forward);
  for (std::size_t i = 0; i < grid.size(); ++i) grid[i] = product(grid[i], spectrum_[i]);
  transform(grid, wide_, high_, LineTransform::Direction::backward);
  std::vector<Complex> result(field.size());
  for (std::size_t row = 0; row < rows_; ++row)
    for (std::size_t column = 0; column < columns_; ++column)
      result[row * columns_ + column] =
          field[row * columns_ + column] - contrast_ * grid[row * wide_ + column];
  return result;
}

std::vector<Complex> HomogenisedBox::field(double angle) const {
  const Vec w = direction(angle);
  std::vector<Complex> incident;
  for (std::size_t row = 0; row < rows_; ++row)
    for (std::size_t column = 0; column < columns_; ++column)
      incident.push_back(std::polar(1.0, k_ * dot(w, centre(column, row))));
  return solved_by_iteration([this](const std::vector<Complex>& x) { return applied(x); },
                             incident);
}

std::shared_ptr<const Wavefront> GradedMedium::from_point(Vec source) const {
  const std::scoped_lock lock(making_);
  auto& wave = from_points_[source];
  if (!wave) wave = wave_from_point(source);
  return wave;
}

std::shared_ptr<const Wavefront> GradedMedium::from_afar(double angle) const {
  const std::scoped_lock lock(making_);
  auto& wave = from_afar_[angle];
  if (!wave) wave = wave_from_afar(angle);
  return wave;
}

std::shared_ptr<const GradedMedium> graded_medium(const Scene& scene) {
  const IndexField& field = *scene.index;
  switch (field.kind) {
    case IndexField::Kind::linear:
      return std::make_shared<const LinearMedium>(scene.domain, field);
    case IndexField::Kind::mean_field:
      return std::make_shared<const MeanFieldMedium>(scene);
    case IndexField::Kind::homogeneous:
      throw InputError("index_field", field.describe(), "is not supported by light paths");
    default:
      return stepped_medium(scene);
  }
}

}  // namespace flatspeckle::mc
