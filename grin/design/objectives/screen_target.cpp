#include "grin/design/objectives/screen_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "core/error.h"
#include "core/frames/frames.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "grin/design/objectives/even_points.h"
#include "grin/design/objectives/solid_hull.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/media/index/cubic_splines.h"

namespace flatspeckle::grin::design {

namespace {

using Numbers = std::vector<double>;

/// The four pixels along an axis over which cubic splines distribute the light of a ray: number of
/// the first pixel, spline values and derivatives.
struct PixelShares {
  int first;
  std::array<double, 4> w, d;
};
PixelShares spread(const ScreenPicture& screen, double x) {
  const double pixel = screen.width / screen.pixels;
  // Position in pixels from the centre of the first pixel
  const double at = x / pixel + 0.5 * screen.pixels - 0.5;
  const double cell = std::floor(std::clamp(at, -1e6, 1e6));
  const CubicSplines splines{at - cell};
  return {static_cast<int>(cell) - 1, splines.values(), splines.derivatives(1 / pixel)};
}

/// Calls use(pixel number, weight, derivatives of the weight with respect to x and y) for each
/// pixel that receives light from a ray that hits the screen at `hit`.
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

class PictureObjective : public DesignObjective {
 public:
  explicit PictureObjective(std::vector<Beam> beams) : beams_(std::move(beams)) {
    for (const Beam& beam : beams_) {
      pixels_ += beam.picture.values.size();
      rays_ += beam.power.size();
    }
    for (const Beam& beam : beams_) scales_.push_back(scale_of(beam));
  }

  Numbers residuals(std::span<const double> measurements) override {
    hits_.assign(measurements.begin(), measurements.end());
    Numbers all;
    each_beam([&](const Beam& beam, double scale, std::span<const double> hits, std::size_t) {
      const Numbers light = irradiance_of(beam.picture, hits, beam.power);
      for (std::size_t p = 0; p < light.size(); ++p)
        all.push_back(scale * (light[p] - beam.picture.values[p]));
    });
    return all;
  }
  Numbers times(std::span<const double> measurements) const override {
    Numbers all(pixels_, 0.0);
    each_ray([&](const Beam& beam, std::size_t ray, std::size_t first, double power) {
      each_pixel(beam.picture, &hits_[2 * ray], [&](std::size_t p, double, double dx, double dy) {
        all[first + p] += power * (dx * measurements[2 * ray] + dy * measurements[2 * ray + 1]);
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
  /// Returns the factor by which residuals are multiplied, so that the loss is a mean over pixels
  /// instead of rays and is relative to the largest value of the picture.
  double scale_of(const Beam& beam) const {
    const double largest = std::ranges::max(beam.picture.values);
    return std::sqrt(static_cast<double>(rays_) / static_cast<double>(pixels_)) / largest;
  }
  /// Calls use(beam, scale, hits, number of the first pixel of the beam) for each beam.
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
  /// Calls use(beam, ray number, number of the beam's first pixel, ray power * scale) for each ray.
  template <class Use>
  void each_ray(const Use& use) const {
    std::size_t ray = 0;
    each_beam([&](const Beam& beam, double scale, std::span<const double>, std::size_t first) {
      for (const double power : beam.power) use(beam, ray++, first, power * scale);
    });
  }

  std::vector<Beam> beams_;
  std::size_t pixels_ = 0, rays_ = 0;
  Numbers scales_;  ///< for each beam, the factor by which its residuals are multiplied
  Numbers hits_;
};

/// Blurs a square picture along one axis; values outside the picture count as 0.
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

/// Returns the pixels of a picture (also one for display), or of a text file of numbers, one line
/// per row.
Frames pixels_of(const std::string& path) {
  if (!is_text_frames(path)) return read_frames("pictures", path, {.allows_display = true});
  try {
    const auto rows = read_rows(path);
    Frames pixels{rows.size(), rows.empty() ? 0 : rows.front().size(), {}};
    for (const auto& row : rows) pixels.values.insert(pixels.values.end(), row.begin(), row.end());
    return pixels;
  } catch (const InputError& error) {
    throw InputError(std::string("pictures = ") + error.what());
  }
}

/// Reads a picture. Throws InputError if it is not square, has fewer than 4 rows, contains only
/// zeros, or contains anything other than numbers from 0 to 1e50.
ScreenPicture read_picture(const std::string& path, double width) {
  const Frames pixels = pixels_of(path);
  const std::size_t columns = pixels.columns;
  if (pixels.rows != columns || columns < 4 || columns > 4096 ||
      pixels.values.size() != columns * columns)
    throw InputError("pictures", path,
                     "must be a square of 4 to 4096 rows of numbers; has " +
                         std::to_string(pixels.rows) + " rows of " + std::to_string(columns));
  ScreenPicture picture{width, static_cast<int>(columns), pixels.values};
  for (const double value : picture.values)
    if (!(value >= 0 && value <= most_input))
      throw InputError("pictures", path,
                       "has the number " + number_text(value) + ": must be from 0 to 1e50");
  if (!(std::ranges::max(picture.values) > 0))
    throw InputError("pictures", path, "must have a value above 0");
  return picture;
}

/// Returns the directions to the right and upwards on a screen that is viewed along the light. y
/// points upwards; for light along y, x points to the right.
Frame upright(const Vec3& along) {
  Vec3 right = along.cross(Vec3::UnitY());
  if (right.norm() < 1e-6) right = Vec3::UnitX();
  right.normalize();
  Frame frame;
  frame << right, right.cross(along);
  return frame;
}

/// Returns the centre of the i-th of `count` equal cells that divide the interval from -1/2 to 1/2.
double in_cell(int i, int count) {
  return even_share(i, count) - 0.5;
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

std::unique_ptr<DesignObjective> make_picture_objective(std::vector<Beam> beams) {
  return std::make_unique<PictureObjective>(std::move(beams));
}

double ScreenTarget::rays() const {
  return static_cast<double>(views_.size()) * light_.rays_across * light_.rays_across;
}

/// Returns the powers of the rays of a beam, one row of rays after the other. Their sum is 1.
std::vector<double> ScreenTarget::powers(int across) const {
  std::vector<double> powers;
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < across; ++i) {
      const double x = light_.beam_width * in_cell(i, across);
      const double y = light_.beam_width * in_cell(j, across);
      const double waist = light_.beam_waist;
      powers.push_back(waist > 0 ? std::exp(-2 * (x * x + y * y) / (waist * waist)) : 1);
    }
  const double sum = std::accumulate(powers.begin(), powers.end(), 0.0);
  for (double& power : powers) power /= sum;
  return powers;
}

DesignTask ScreenTarget::task(const RayWalk& walk, bool held_out) const {
  const int across = this->across(held_out);
  std::vector<DesignRay> rays;
  std::vector<ScreenMeasurement> measurements;
  std::vector<Beam> beams;
  for (const View& view : views_) {
    const Frame frame = upright(view.direction);
    const ScreenMeasurement screen{centre_ + light_.screen_distance * view.direction,
                                   view.direction, frame};
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i) {
        const Eigen::Vector2d in_beam(in_cell(i, across), in_cell(j, across));
        const Vec3 x = centre_ + light_.beam_width * (frame * in_beam);
        const auto crossing = entry_and_exit(hull_, x, view.direction);
        rays.push_back({x + crossing->first * view.direction, view.direction, hull_});
        measurements.push_back(screen);
      }
    beams.push_back({shown(view.picture), powers(across)});
  }
  return {make_ray_system(std::move(rays), std::move(measurements), walk),
          make_picture_objective(std::move(beams))};
}

std::vector<ScreenPicture> ScreenTarget::shown_by(std::span<const double> measurements,
                                                  bool held_out) const {
  const auto power = powers(across(held_out));
  std::vector<ScreenPicture> pictures;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    ScreenPicture picture = views_[v].picture;
    picture.values =
        irradiance_of(picture, measurements.subspan(2 * power.size() * v, 2 * power.size()), power);
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

void add_keys(Keys& keys, ScreenValues& values) {
  keys.add("pictures", values.pictures,
           "Square pictures, one per direction: PNG, TIFF, NPY, or a file of numbers with one line "
           "per row, from the top")
      .file();
  keys.add("view_directions", values.view_directions,
           "Directions of the parallel beams, one for each picture")
      .each_of(3, "a direction");
  keys.add("beam_width", values.beam_width,
           "Side of the square beams, which are centred on the field (default: 1.2 times the "
           "radius)")
      .positive()
      .unit("length");
  keys.add("beam_waist", values.beam_waist,
           "1/e^2 radius of Gaussian beams, truncated by the square of beam_width (default: "
           "uniform)")
      .positive()
      .unit("length");
  keys.add("screen_width", values.screen_width, "Side of the pictures (default: beam_width)")
      .positive()
      .unit("length");
  keys.add("screen_distance", values.screen_distance,
           "Distance of the screens from the centre of the field (default: 8 times the radius)")
      .positive()
      .unit("length");
  keys.add("rays_across", values.rays_across, "Number of rays along a side of each square beam")
      .from(4, 2000);
}

namespace {

std::vector<ScreenTarget::View> views_of(const Keys& keys, const ScreenValues& values,
                                         double width) {
  std::vector<ScreenTarget::View> views;
  const auto directions = parts_of(keys.read(values.view_directions), 3);
  for (const std::string& path : keys.required(values.pictures)) {
    if (views.size() == directions.size()) break;
    views.push_back({unit_direction("view_directions", vector_of(directions[views.size()])),
                     read_picture(path, width)});
    if (const int pixels = views.back().picture.pixels; pixels != views.front().picture.pixels)
      throw InputError("pictures", path,
                       "has " + std::to_string(pixels) +
                           " rows; must have as many as the first picture, " +
                           std::to_string(views.front().picture.pixels));
  }
  if (values.pictures.size() != directions.size())
    throw InputError("pictures", values.pictures.size(),
                     "must be as many as view_directions, " + std::to_string(directions.size()));
  return views;
}

}  // namespace

std::unique_ptr<DesignTarget> make_target(const Keys& keys, const ScreenValues& values,
                                          const FieldForm& form) {
  const SolidHull hull = solid_hull(form, ScreenValues::word);
  const double width = keys.read(values.beam_width).value_or(1.2 * hull.radius);
  const double most = std::holds_alternative<Sphere>(hull.surface) ? 1.4 : 2.0;
  if (width > most * hull.radius)
    throw InputError(
        "beam_width", width,
        "does not fit into the field; must be at most " + std::to_string(most * hull.radius));
  const ScreenTarget::Light light{width, keys.read(values.beam_waist).value_or(0),
                                  keys.read(values.screen_distance).value_or(8 * hull.radius),
                                  static_cast<int>(keys.read(values.rays_across))};
  if (light.screen_distance < 2 * hull.radius)
    throw InputError("screen_distance", light.screen_distance,
                     "must be at least twice the radius, so that the screens are behind the field");
  const double side = keys.read(values.screen_width).value_or(width);
  return std::make_unique<ScreenTarget>(hull.surface, hull.centre, light,
                                        views_of(keys, values, side));
}

}  // namespace flatspeckle::grin::design
