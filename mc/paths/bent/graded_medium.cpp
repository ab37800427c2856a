#include "mc/paths/bent/graded_medium.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "mc/paths/bent/homogenised_box.h"
#include "mc/paths/bent/linear_medium.h"

namespace flatspeckle::mc {

namespace {

/// A medium whose mean field is refracted: of index n = 1 + k_shift/k, with attenuation in sigma as
/// in other media of an index (C31), K^2 = k^2 n^2 + i k mu_t. Plane waves come into a slab by
/// Snell and Fresnel, to leading order in the reflection; into a box as the field of the
/// homogenised box (homogenised_box.h). Flights between scatterers are straight and end at the
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
