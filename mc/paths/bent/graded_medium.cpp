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

/// In place, of rows of `wide` values.
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

/// Dedekind's eta(i y).
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

/// BiCGSTAB (van der Vorst 1992) for A x = b from x = b.
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
  throw std::runtime_error("the mean field of the homogenised box was not found by iteration");
}

/// A medium whose mean field is refracted: of index n = 1 + k_shift/k, with attenuation in sigma as
/// in other media of an index (C31), K^2 = k^2 n^2 + i k mu_t. Plane waves come into a slab by
/// Snell and Fresnel, to leading order in the reflection; into a box as the field of the
/// homogenised box. Flights between scatterers are straight and end at the
/// edge.
class MeanFieldMedium : public GradedMedium {
 public:
  explicit MeanFieldMedium(const Scene& scene)
      : domain_(scene.domain),
        k_(scene.k),
        mu_t_(scene.medium.mu_t),
        index_(1 + scene.medium.k_shift / scene.k) {}

  double square(Vec2) const override { return index_ * index_; }
  double inside(Vec2 x, Vec2 w) const override { return domain_.distance_to_edge(x, w) / index_; }
  std::optional<RayPlace> flown(Vec2 x, Vec2 w, double sigma) const override;

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;

  Domain domain_;
  double k_, mu_t_, index_;
};

/// Snell and Fresnel at the face that it enters by.
class RefractedWave : public Wavefront {
 public:
  RefractedWave(const Domain& slab, double index, double angle)
      : sine_(std::sin(angle)),
        cosine_(std::cos(angle)),
        face_(cosine_ > 0 ? 0 : slab.depth),
        square_(index * index - sine_ * sine_) {
    if (!(square_ > 0))
      throw InputError("light or view of angle", angle,
                       "is reflected at the face as a whole, by the index of the mean field");
  }

  std::optional<Arrival> at(Vec2 x) const override {
    const double deep = std::sqrt(square_), way = std::abs(x.z - face_),
                 n = std::hypot(deep, sine_);
    return Arrival{1 / n * Vec2{sine_, std::copysign(deep, cosine_)},
                   sine_ * x.x + cosine_ * face_ + deep * way,
                   2 * std::abs(cosine_) / (std::abs(cosine_) + deep), way / deep, 0};
  }

 private:
  double sine_, cosine_, face_, square_;
};

/// The field of a homogenised box: its part beside the plane wave by cubic convolution. It arrives
/// along the gradient of its phase.
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

  std::optional<Arrival> at(Vec2 x) const override {
    const auto here = envelope_at((x.x + half_) / cell_.x - 0.5, x.z / cell_.z - 0.5);
    if (here.value == 0.0) return Arrival{w_, 0, 0, 0, 0};
    const auto along = [&](Complex slope, double cell) {
      return std::imag(slope / here.value) / (k_ * cell);
    };
    const Vec2 v = w_ + Vec2{along(here.by_x, cell_.x), along(here.by_z, cell_.z)};
    return Arrival{1 / length(v) * v, dot(w_, x) + std::arg(here.value) / k_, std::abs(here.value),
                   0, 0};
  }

 private:
  struct Envelope {
    Complex value{}, by_x{}, by_z{};  ///< slopes per cell
  };
  using Four = std::array<double, 4>;

  Envelope envelope_at(double along, double deep) const {
    const auto i = static_cast<std::ptrdiff_t>(std::floor(along)),
               j = static_cast<std::ptrdiff_t>(std::floor(deep));
    const double s = along - static_cast<double>(i), t = deep - static_cast<double>(j);
    const Four a = weights(s), b = weights(t), da = slopes(s), db = slopes(t);
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
  static Four slopes(double t) {
    const double u = 1 - t;
    return {u * (2 * t - u) / 2, t * (9 * t - 10) / 2, u * (10 - 9 * u) / 2, t * (t - 2 * u) / 2};
  }
  static std::size_t clamped(std::ptrdiff_t i, std::size_t size) {
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(size) - 1));
  }

  Vec2 w_;
  double k_, half_;
  Vec2 cell_;
  std::size_t columns_, rows_;
  std::vector<Complex> envelope_;
};

std::optional<RayPlace> MeanFieldMedium::flown(Vec2 x, Vec2 w, double sigma) const {
  if (!(sigma < inside(x, w))) return std::nullopt;
  return RayPlace{x + index_ * sigma * w, w};
}

std::shared_ptr<const Wavefront> MeanFieldMedium::wave_from_point(Vec2) const {
  throw InputError("index_field", "mean_field", "is of plane waves and far views");
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
  if (box.area() * per * per > most_cells)
    throw InputError("index_field", "mean_field",
                     "takes boxes of up to 40000 square wavelengths; a wider one is a slab");
  columns_ = cells_along(box.width, wavelength);
  rows_ = cells_along(box.depth, wavelength);
  dx_ = box.width / static_cast<double>(columns_);
  dz_ = box.depth / static_cast<double>(rows_);
  wide_ = transform_size(2.0 * static_cast<double>(columns_));
  high_ = transform_size(2.0 * static_cast<double>(rows_));
  find_spectrum();
}

Vec2 HomogenisedBox::centre(std::size_t column, std::size_t row) const {
  return {-box_.width / 2 + (static_cast<double>(column) + 0.5) * dx_,
          (static_cast<double>(row) + 0.5) * dz_};
}

/// Midpoint rule on a lattice. The cell of the logarithm itself counts
/// ln(dx / (2 pi eta(i dz/dx)^2)) (Kronecker's limit; Duan and Rokhlin 2009 for squares).
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

/// (1 - contrast G) field
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
  const Vec2 w = direction(angle);
  std::vector<Complex> incident;
  for (std::size_t row = 0; row < rows_; ++row)
    for (std::size_t column = 0; column < columns_; ++column)
      incident.push_back(std::polar(1.0, k_ * dot(w, centre(column, row))));
  return solved_by_iteration([this](const std::vector<Complex>& x) { return applied(x); },
                             incident);
}

std::shared_ptr<const Wavefront> GradedMedium::from_point(Vec2 source) const {
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
      throw InputError("index_field", field.describe(), "is not of light paths");
    default:
      return stepped_medium(scene);
  }
}

}  // namespace flatspeckle::mc
