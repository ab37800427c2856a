#include "mc/paths/speckle/lens_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/blas.h"

namespace flatspeckle::mc {

namespace {

/// Returns the share of a pixel of the pupil that is inside a circle of radius 1. x, y: middle of
/// the pixel, of side `side`.
double share_in_circle(double x, double y, double side) {
  constexpr int samples = 16;
  const double distance = std::hypot(x, y);
  if (distance < 1 - side) return 1;
  if (distance > 1 + side) return 0;
  int inside = 0;
  for (int i = 0; i < samples; ++i)
    for (int j = 0; j < samples; ++j)
      inside += std::hypot(x + side * ((i + 0.5) / samples - 0.5),
                           y + side * ((j + 0.5) / samples - 0.5)) < 1;
  return inside / static_cast<double>(samples * samples);
}

}  // namespace

FarCamera pupil_of(const FarCamera& lens, const LensPlane& image, const Domain& box,
                   double wavelength) {
  // A step dv of direction cosines repeats the image at a distance wavelength / dv, which must
  // exceed the blurred image of the box. Twice as many pixels as this requires are taken.
  constexpr double spare = 2, fewest = 64;
  const double x = std::abs(lens.axis.x) + lens.aperture, y = std::abs(lens.axis.y) + lens.aperture,
               least_z = std::sqrt(std::max(1e-3, 1 - x * x - y * y)),
               out_of_focus = std::max(std::abs(image.focus), std::abs(box.depth - image.focus)),
               range = (std::max(box.width, box.height) + image.width) / 2 +
                       out_of_focus * std::hypot(x, y) / least_z;
  FarCamera pupil = lens;
  pupil.pixels = static_cast<std::size_t>(
      std::ceil(std::max(fewest, spare * 2 * lens.aperture * range / wavelength)));
  return pupil;
}

LensImage::LensImage(const FarCamera& pupil, const LensPlane& image, double k)
    : across_(pupil.pixels), pixels_(image.pixels) {
  const double step = 2 * pupil.aperture / static_cast<double>(across_);
  for (std::size_t row = 0; row < across_; ++row)
    for (std::size_t column = 0; column < across_; ++column) {
      const double x = pupil.cosine(pupil.axis.x, column), y = pupil.cosine(pupil.axis.y, row),
                   z = std::sqrt(1 - x * x - y * y),
                   share =
                       share_in_circle((x - pupil.axis.x) / pupil.aperture,
                                       (y - pupil.axis.y) / pupil.aperture, step / pupil.aperture);
      weights_.push_back(Complex(0, k / (2 * std::numbers::pi)) * share * step * step / z *
                         std::polar(1.0, k * std::copysign(z, pupil.axis.z) * image.focus));
    }
  for (std::size_t i = 0; i < pixels_; ++i)
    for (std::size_t j = 0; j < across_; ++j) {
      x_.push_back(std::polar(1.0, k * pupil.cosine(pupil.axis.x, j) * image.coordinate(i)));
      y_.push_back(std::polar(1.0, k * pupil.cosine(pupil.axis.y, j) * image.coordinate(i)));
    }
}

void LensImage::form(std::span<const Complex> far, std::span<Complex> out) const {
  std::vector<Complex> weighted(weights_.size()), half(pixels_ * across_);
  for (std::size_t i = 0; i < weighted.size(); ++i) weighted[i] = product(far[i], weights_[i]);
  const Complex one = 1, zero = 0;
  const blasint n = blas_size(pixels_), m = blas_size(across_);
  cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n, m, m, &one, y_.data(), m,
              weighted.data(), m, &zero, half.data(), m);
  cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasTrans, n, n, m, &one, half.data(), m, x_.data(), m,
              &zero, out.data(), n);
}

FieldDraw images_of(FieldDraw draw, const LensImage& lens, std::size_t fields,
                    std::size_t pupil_pixels) {
  return [draw = std::move(draw), lens, fields, pupil_pixels](
             std::uint64_t number, std::span<Complex> image, std::span<double> intensity) {
    std::vector<Complex> far(fields * pupil_pixels);
    std::vector<double> far_intensity(far.size());
    draw(number, far, far_intensity);
    const std::size_t pixels = image.size() / fields;
    for (std::size_t f = 0; f < fields; ++f)
      lens.form(std::span(far).subspan(f * pupil_pixels, pupil_pixels),
                image.subspan(f * pixels, pixels));
    std::ranges::transform(image, intensity.begin(), [](Complex u) { return std::norm(u); });
  };
}

}  // namespace flatspeckle::mc
