#include "grin/design/goals/picture_goal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "grin/media/index/cubic_splines.h"

namespace flatspeckle::grin::design {

namespace {

using Numbers = std::vector<double>;

/// The four cubic splines that are there along an axis: the first pixel, values and derivatives.
struct PixelShares {
  int first;
  std::array<double, 4> w, d;
};
PixelShares spread(const ScreenPicture& screen, double x) {
  const double pixel = screen.width / screen.pixels;
  const double at = x / pixel + 0.5 * screen.pixels - 0.5;  // a pixel's number at its middle
  const double cell = std::floor(std::clamp(at, -1e6, 1e6));
  const CubicSplines splines{at - cell};
  return {static_cast<int>(cell) - 1, splines.values(), splines.slopes(1 / pixel)};
}

/// use(number of a pixel, weight, its derivatives by x and y) of those that a hit falls on.
template <class Use>
void each_pixel(const ScreenPicture& screen, const double* hit, const Use& use) {
  const PixelShares x = spread(screen, hit[0]), y = spread(screen, -hit[1]);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const int column = x.first + i, row = y.first + j;
      if (column < 0 || row < 0 || column >= screen.pixels || row >= screen.pixels) continue;
      use(static_cast<std::size_t>(row) * screen.pixels + column, x.w[i] * y.w[j], x.d[i] * y.w[j],
          -x.w[i] * y.d[j]);
    }
}

class PictureGoal : public Goal {
 public:
  explicit PictureGoal(std::vector<Beam> beams) : beams_(std::move(beams)) {
    for (const Beam& beam : beams_) {
      pixels_ += beam.picture.values.size();
      rays_ += beam.power.size();
    }
    for (const Beam& beam : beams_) scales_.push_back(scale_of(beam));
  }

  Numbers residuals(std::span<const double> readings) override {
    hits_.assign(readings.begin(), readings.end());
    Numbers all;
    each_beam([&](const Beam& beam, double scale, std::span<const double> hits, std::size_t) {
      const Numbers light = irradiance_of(beam.picture, hits, beam.power);
      for (std::size_t p = 0; p < light.size(); ++p)
        all.push_back(scale * (light[p] - beam.picture.values[p]));
    });
    return all;
  }
  Numbers times(std::span<const double> readings) const override {
    Numbers all(pixels_, 0.0);
    each_ray([&](const Beam& beam, std::size_t ray, std::size_t first, double power) {
      each_pixel(beam.picture, &hits_[2 * ray], [&](std::size_t p, double, double dx, double dy) {
        all[first + p] += power * (dx * readings[2 * ray] + dy * readings[2 * ray + 1]);
      });
    });
    return all;
  }
  Numbers transposed(std::span<const double> residuals) const override {
    Numbers all(hits_.size(), 0.0);
    each_ray([&](const Beam& beam, std::size_t ray, std::size_t first, double power) {
      each_pixel(beam.picture, &hits_[2 * ray], [&](std::size_t p, double, double dx, double dy) {
        all[2 * ray] += power * dx * residuals[first + p];
        all[2 * ray + 1] += power * dy * residuals[first + p];
      });
    });
    return all;
  }
  Numbers weights() const override {
    Numbers all(hits_.size(), 0.0);
    each_ray([&](const Beam& beam, std::size_t ray, std::size_t, double power) {
      each_pixel(beam.picture, &hits_[2 * ray], [&](std::size_t, double, double dx, double dy) {
        all[2 * ray] += power * dx * power * dx;
        all[2 * ray + 1] += power * dy * power * dy;
      });
    });
    for (double& w : all) w = std::sqrt(w);
    return all;
  }

 private:
  /// The loss is a mean over rays, of which there are other numbers than of pixels.
  double scale_of(const Beam& beam) const {
    const double largest = std::ranges::max(beam.picture.values);
    return std::sqrt(static_cast<double>(rays_) / static_cast<double>(pixels_)) / largest;
  }
  /// use(beam, its scale, its hits, its first pixel)
  template <class Use>
  void each_beam(const Use& use) const {
    std::size_t ray = 0, pixel = 0;
    for (std::size_t b = 0; b < beams_.size(); ++b) {
      const Beam& beam = beams_[b];
      use(beam, scales_[b], std::span(hits_).subspan(2 * ray, 2 * beam.power.size()), pixel);
      ray += beam.power.size();
      pixel += beam.picture.values.size();
    }
  }
  /// use(beam, number of the ray, first pixel, its power times the scale)
  template <class Use>
  void each_ray(const Use& use) const {
    std::size_t ray = 0;
    each_beam([&](const Beam& beam, double scale, std::span<const double>, std::size_t first) {
      for (const double power : beam.power) use(beam, ray++, first, power * scale);
    });
  }

  std::vector<Beam> beams_;
  std::size_t pixels_ = 0, rays_ = 0;
  Numbers scales_;  ///< of each beam
  Numbers hits_;
};

/// Along rows of a square: what lies beyond is dark.
Numbers blurred(const Numbers& values, int pixels, std::size_t stride, std::size_t across) {
  Numbers blurred(values.size());
  for (int j = 0; j < pixels; ++j)
    for (int i = 0; i < pixels; ++i) {
      const std::size_t at = i * stride + j * across;
      const double before = i > 0 ? values[at - stride] : 0;
      const double after = i + 1 < pixels ? values[at + stride] : 0;
      blurred[at] = (before + 6 * values[at] + after) / 8;
    }
  return blurred;
}

}  // namespace

Numbers irradiance_of(const ScreenPicture& screen, std::span<const double> hits,
                      std::span<const double> power) {
  Numbers light(static_cast<std::size_t>(screen.pixels) * screen.pixels, 0.0);
  for (std::size_t ray = 0; ray < power.size(); ++ray)
    each_pixel(screen, &hits[2 * ray],
               [&](std::size_t p, double w, double, double) { light[p] += power[ray] * w; });
  return light;
}

ScreenPicture shown(const ScreenPicture& picture) {
  const auto side = static_cast<std::size_t>(picture.pixels);
  ScreenPicture shown = picture;
  shown.values = blurred(blurred(picture.values, picture.pixels, 1, side), picture.pixels, side, 1);
  const double sum = std::accumulate(shown.values.begin(), shown.values.end(), 0.0);
  for (double& v : shown.values) v /= sum;
  return shown;
}

std::unique_ptr<Goal> make_picture_goal(std::vector<Beam> beams) {
  return std::make_unique<PictureGoal>(std::move(beams));
}

}  // namespace flatspeckle::grin::design
