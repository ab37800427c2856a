#include "mc/imaging/simulated/picture_prediction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/numbers/fourier.h"
#include "core/numbers/normal.h"
#include "core/run/runner.h"
#include "mc/imaging/imaging.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/spreading_axis.h"

namespace flatspeckle::mc {

namespace {

constexpr std::size_t separations = 8;   ///< beside 0
constexpr std::size_t light_nodes = 12;  ///< along each side of the camera

/// Returns a far view in front of the camera, by the direction cosines from its axis.
View view_of(const FarCamera& camera, double x, double y) {
  const double vx = camera.axis.x + x, vy = camera.axis.y + y;
  const double angle = std::asin(std::min(1.0, std::hypot(vx, vy)));
  return far_view(camera.axis.z > 0 ? angle : std::numbers::pi - angle, std::atan2(vy, vx));
}

/// Collects entries for pairs of channels: their covariance and their two intensities.
class PairRequest {
 public:
  explicit PairRequest(const PictureScene& scene) : scene_(scene) {
    request_.kind = CovarianceRequest::Kind::pairs;
  }
  /// Adds a pair of points and a pair of pixels; places are relative to the middle of the camera.
  void add(Vec a, PixelPlace at_a, Vec b, PixelPlace at_b) {
    const std::uint32_t first = channel(a, at_a), second = channel(b, at_b);
    request_.entries.insert(request_.entries.end(),
                            {{first, second}, {first, first}, {second, second}});
  }
  CovarianceRequest request() const { return request_; }

 private:
  std::uint32_t channel(Vec place, PixelPlace pixel) {
    const FarCamera& camera = scene_.camera();
    const double step = pixel_step(camera);
    request_.channels.push_back({static_cast<std::uint32_t>(request_.lights.size()),
                                 static_cast<std::uint32_t>(request_.views.size())});
    request_.lights.push_back(light_of(scene_.object, place));
    request_.views.push_back(view_of(camera, step * pixel.x, step * pixel.y));
    return static_cast<std::uint32_t>(request_.channels.size() - 1);
  }

  const PictureScene& scene_;
  CovarianceRequest request_;
};

/// Places on the camera over which correlations are averaged.
std::array<PixelPlace, 5> places_on(const FarCamera& camera) {
  const double away = static_cast<double>(camera.pixels) / 4;
  return {{{0, 0}, {away, away}, {-away, away}, {away, -away}, {-away, -away}}};
}

/// Returns the number of lags over which the peak of a grain is computed: six grains.
std::size_t lags_of_grain(const PictureScene& scene) {
  const double step = pixel_step(scene.camera()),
               narrow = std::min(scene.scene.domain.width, scene.scene.domain.height);
  return static_cast<std::size_t>(
             std::ceil(12 * std::numbers::pi / (scene.scene.outside_k() * narrow * step))) +
         1;
}

/// Adds a pair of points at a distance along x or y, seen by pixels that are matched by the memory
/// effect and, in addition, `lag` pixels apart.
void add_pair(PairRequest& pairs, const PictureScene& scene, bool along_y, double distance,
              double lag, PixelPlace place) {
  const Vec middle = middle_of(scene.object);
  const Vec half = along_y ? Vec{0, 0, distance / 2} : Vec{distance / 2, 0, 0};
  const PixelPlace a = place_in_picture(scene, middle - half),
                   b = place_in_picture(scene, middle + half);
  // The speckle moves against the picture
  const double x = (a.x - b.x + (along_y ? 0 : lag)) / 2, y = (a.y - b.y + (along_y ? lag : 0)) / 2;
  pairs.add(middle - half, {place.x - x, place.y - y}, middle + half, {place.x + x, place.y + y});
}

/// Returns some of the points of an object, evenly in their order.
PictureObject some_points(const PictureObject& object) {
  constexpr std::size_t most = 32;
  const std::size_t stride = (object.place.size() + most - 1) / most;
  PictureObject some{{}, {}, object.far};
  for (std::size_t i = 0; i < object.place.size(); i += stride) {
    some.place.push_back(object.place[i]);
    some.brightness.push_back(object.brightness[i]);
  }
  return some;
}

/// Returns the mean light on each pixel, whose mean over the pixels is 1. It is interpolated by a
/// polynomial of the direction cosines.
std::vector<double> mean_light(const PictureScene& scene, const PictureTask& task) {
  const FarCamera& camera = scene.camera();
  const auto node = chebyshev_nodes(light_nodes);
  const PictureObject object = some_points(scene.object);
  Lights lights;
  for (const Vec& place : object.place) lights.push_back(light_of(object, place));
  std::vector<View> views;
  for (const double y : node)
    for (const double x : node)
      views.push_back(view_of(camera, camera.aperture * x, camera.aperture * y));
  Scene lit = scene.scene;
  lit.request = intensity_request(std::move(lights), std::move(views));
  const FieldJob job = covariance_job(lit, make_plan(lit, ReversedPaths::automatic), task.seed);
  RunState state;
  run_to_end(job.batches,
             {{task.prediction_paths, std::nullopt, std::nullopt}, task.threads, "mean light", {}},
             state);
  const auto entries = job.covariance(state.sums.total_samples(), state.sums.total());
  std::vector<double> at_nodes(node.size() * node.size());
  for (std::size_t i = 0; i < entries.size(); ++i)
    at_nodes[i % at_nodes.size()] += object.brightness[i / at_nodes.size()] * entries[i].real();
  std::vector<std::vector<double>> weights;
  for (std::size_t i = 0; i < camera.pixels; ++i)
    weights.push_back(lagrange(node, camera.cosine(0, i) / camera.aperture));
  std::vector<double> light;
  for (std::size_t y = 0; y < camera.pixels; ++y)
    for (std::size_t x = 0; x < camera.pixels; ++x) {
      double sum = 0;
      for (std::size_t b = 0; b < node.size(); ++b)
        for (std::size_t a = 0; a < node.size(); ++a)
          sum += weights[y][b] * weights[x][a] * at_nodes[b * node.size() + a];
      light.push_back(std::max(sum, 0.0));
    }
  const double mean = mean_of(light);
  for (double& value : light) value = mean > 0 ? value / mean : 1;
  return light;
}

/// Returns the roots of the correlations of intensities, with the signs of the covariances of
/// fields. covariances: entries of the pairs as for mean_correlations().
std::vector<double> field_correlations(std::span<const Complex> covariances,
                                       const std::vector<double>& intensities) {
  std::vector<double> fields;
  for (std::size_t pair = 0; pair < intensities.size(); ++pair) {
    double sum = 0;
    for (std::size_t i = pair; 3 * i < covariances.size(); i += intensities.size())
      sum += covariances[3 * i].real();
    fields.push_back(std::copysign(std::sqrt(std::max(0.0, intensities[pair])), sum));
  }
  return fields;
}

double decay_of_exposure(const PictureScene& scene, const PictureTask& task) {
  const auto& times = task.exposure.delays;
  if (times.empty()) return 1;
  std::vector<double> delays;
  for (const double time : times) delays.push_back(time - times.front());
  Scene one = scene.scene;
  const PixelPlace middle{};
  PairRequest pair(scene);
  pair.add(middle_of(scene.object), middle, middle_of(scene.object), middle);
  const CovarianceRequest request = pair.request();
  one.request = intensity_request({request.lights.front()}, {request.views.front()});
  const PathJob job = delay_job(one, make_plan(one, ReversedPaths::automatic), delays, task.seed,
                                task.exposure.motion);
  RunState state;
  run_to_end(job.field.batches,
             {{task.prediction_paths, std::nullopt, std::nullopt}, task.threads, "decay", {}},
             state);
  const auto found = change_estimates(one.request, job, state.sums).correlation.value;
  double sum = 0;
  for (std::size_t i = 0; i < times.size(); ++i)
    for (std::size_t j = 0; j < times.size(); ++j) sum += std::norm(found[i > j ? i - j : j - i]);
  return sum / static_cast<double>(times.size() * times.size());
}

}  // namespace

SpecklePrediction predicted_speckle(const PictureScene& scene, const PictureTask& task) {
  SpecklePrediction found;
  const auto places = places_on(scene.camera());
  const std::size_t lags = lags_of_grain(scene);
  const double longest = 1.5 * extent_of(scene.object);
  for (std::size_t i = 0; i <= separations && (i == 0 || longest > 0); ++i)
    found.separation.push_back(longest * static_cast<double>(i) / separations);
  PairRequest pairs(scene);
  // Places are those over which mean_correlations() averages; both axes are averaged too
  for (const PixelPlace& place : places)
    for (const bool along_y : {false, true}) {
      for (const double distance : found.separation)
        add_pair(pairs, scene, along_y, distance, 0, place);
    }
  const std::size_t of_separations = 3 * 2 * places.size() * found.separation.size();
  for (const PixelPlace& place : places)
    for (const bool along_y : {false, true})
      for (std::size_t lag = 0; lag < lags; ++lag)
        add_pair(pairs, scene, along_y, 0, static_cast<double>(lag), place);
  Scene paired = scene.scene;
  paired.request = pairs.request();
  const FieldJob job =
      covariance_job(paired, make_plan(paired, ReversedPaths::automatic), task.seed);
  RunState state;
  run_to_end(
      job.batches,
      {{task.prediction_paths, std::nullopt, std::nullopt}, task.threads, "correlations", {}},
      state);
  const Estimate all = jackknife(
      state.sums, [&, covariance = job.covariance](double samples, std::span<const Complex> sums) {
        const auto entries = covariance(samples, sums);
        auto mean = mean_correlations(std::span(entries).first(of_separations), 2 * places.size());
        const auto grains =
            mean_correlations(std::span(entries).subspan(of_separations), places.size());
        mean.insert(mean.end(), grains.begin(), grains.end());
        return mean;
      });
  found.correlation = part(all, 0, found.separation.size());
  const auto grains = real_parts(part(all, found.separation.size(), 2 * lags).value);
  found.grain_x.assign(grains.begin(), grains.begin() + static_cast<long>(lags));
  found.grain_y.assign(grains.begin() + static_cast<long>(lags), grains.end());
  const auto entries = job.covariance(state.sums.total_samples(), state.sums.total());
  const auto fields = field_correlations(std::span(entries).subspan(of_separations), grains);
  found.field_x.assign(fields.begin(), fields.begin() + static_cast<long>(lags));
  found.field_y.assign(fields.begin() + static_cast<long>(lags), fields.end());
  found.exposure = decay_of_exposure(scene, task);
  found.light = mean_light(scene, task);
  return found;
}

double SpecklePrediction::correlation_at(double distance) const {
  const auto after = std::ranges::lower_bound(separation, distance);
  if (after == separation.begin()) return correlation.value.front().real();
  if (after == separation.end()) return correlation.value.back().real();
  const auto i = static_cast<std::size_t>(after - separation.begin());
  const double share = (distance - separation[i - 1]) / (separation[i] - separation[i - 1]);
  return std::lerp(correlation.value[i - 1].real(), correlation.value[i].real(), share);
}

std::optional<double> SpecklePrediction::field_of_view() const {
  for (std::size_t i = 1; i < separation.size(); ++i) {
    const double before = correlation.value[i - 1].real(), after = correlation.value[i].real();
    if (before >= 0.5 && after < 0.5)
      return std::lerp(separation[i - 1], separation[i], (before - 0.5) / (before - after));
  }
  return std::nullopt;
}

double SpecklePrediction::grain() const {
  const auto width = [](const std::vector<double>& peak) {
    for (std::size_t lag = 1; lag < peak.size(); ++lag)
      if (peak[lag] < 0.5)
        return 2 * (static_cast<double>(lag) -
                    (0.5 - peak[lag]) / std::max(peak[lag - 1] - peak[lag], 1e-12));
    return 2 * static_cast<double>(peak.size());
  };
  return std::sqrt(width(grain_x) * width(grain_y));
}

namespace {

/// Random frames without media: speckle of a thin layer, convolved with the object.
class FrameModel {
 public:
  FrameModel(const PictureScene& scene, const PictureTask& task, const SpecklePrediction& speckle)
      : task_(task),
        pixels_(scene.camera().pixels),
        transform_(padded(pixels_, task.lags), padded(pixels_, task.lags)),
        light_(speckle.light),
        field_(field_filter(scene, speckle)),
        object_(object_filter(scene, speckle)) {}

  /// Draws a frame.
  std::vector<double> draw(RandomStream& random) const {
    auto speckle = squared(gaussian_field(random));
    const auto imaginary = squared(gaussian_field(random));
    for (std::size_t p = 0; p < speckle.size(); ++p)
      speckle[p] = (speckle[p] + imaginary[p]) / 2 - 1;
    filter(speckle, object_);
    std::vector<double> frame;
    for (std::size_t y = 0; y < pixels_; ++y)
      for (std::size_t x = 0; x < pixels_; ++x)
        frame.push_back(light_[y * pixels_ + x] * (1 + speckle[y * transform_.columns() + x]));
    detect(frame, task_.noise, task_.detector, random);
    return frame;
  }

 private:
  static std::size_t padded(std::size_t pixels, std::size_t lags) {
    return transform_size(static_cast<double>(pixels + 2 * lags));
  }
  static double sinc(double frequency) {
    const double x = std::numbers::pi * frequency;
    return x == 0 ? 1 : std::sin(x) / x;
  }
  static std::vector<double> squared(std::vector<double> values) {
    for (double& value : values) value *= value;
    return values;
  }
  std::size_t wrapped(long offset) const {
    const auto side = static_cast<long>(transform_.rows());
    return static_cast<std::size_t>((offset % side + side) % side);
  }
  /// Multiplies the spectrum of a picture by a filter.
  void filter(std::vector<double>& picture, const std::vector<double>& by) const {
    std::vector<Complex> spectrum(transform_.spectrum_size());
    transform_.forward(picture.data(), spectrum.data());
    for (std::size_t m = 0; m < spectrum.size(); ++m)
      spectrum[m] *= by[m] / static_cast<double>(picture.size());
    transform_.backward(spectrum.data(), picture.data());
  }
  /// Returns the filter that gives white noise this autocorrelation: the root of its spectrum.
  std::vector<double> root_of_spectrum(const std::vector<double>& autocorrelation) const {
    std::vector<Complex> spectrum(transform_.spectrum_size());
    transform_.forward(autocorrelation.data(), spectrum.data());
    std::vector<double> roots;
    for (const Complex power : spectrum) roots.push_back(std::sqrt(std::max(0.0, power.real())));
    return roots;
  }
  /// Draws one part of a circular Gaussian field of mean intensity 1, times sqrt(2).
  std::vector<double> gaussian_field(RandomStream& random) const {
    std::vector<double> values(transform_.rows() * transform_.columns());
    for (double& value : values) value = standard_normal(random);
    filter(values, field_);
    return values;
  }

  /// Returns the root of the spectrum of fields. Light leaves the box within its width and height,
  /// which limits the frequencies of the spectrum.
  std::vector<double> field_filter(const PictureScene& scene,
                                   const SpecklePrediction& speckle) const {
    std::vector<double> picture(transform_.rows() * transform_.columns());
    const auto &of_x = speckle.field_x, &of_y = speckle.field_y;
    const auto lags = static_cast<long>(of_x.size());
    for (long y = 1 - lags; y < lags; ++y)
      for (long x = 1 - lags; x < lags; ++x)
        picture[wrapped(y) * transform_.columns() + wrapped(x)] +=
            of_y[static_cast<std::size_t>(std::abs(y))] *
            of_x[static_cast<std::size_t>(std::abs(x))];
    auto roots = root_of_spectrum(picture);
    const double band =
        pixel_step(scene.camera()) * scene.scene.outside_k() / (4 * std::numbers::pi);
    double power = 0;  // of the field, which clipping of negative power has changed
    for (std::size_t m = 0; m < roots.size(); ++m) {
      const auto [fy, fx] = frequency(m);
      if (fx > band * scene.scene.domain.width || fy > band * scene.scene.domain.height)
        roots[m] = 0;
      power += (is_double(m) ? 2 : 1) * roots[m] * roots[m] / static_cast<double>(picture.size());
    }
    for (double& root : roots) root /= std::sqrt(power);
    return roots;
  }
  /// Returns the frequencies of a value of a half spectrum along y and x, in cycles per pixel.
  std::pair<double, double> frequency(std::size_t m) const {
    const auto side = static_cast<double>(transform_.rows());
    const std::size_t row = m / transform_.spectrum_columns();
    return {static_cast<double>(std::min(row, transform_.rows() - row)) / side,
            static_cast<double>(m % transform_.spectrum_columns()) / side};
  }
  /// Whether a value of a half spectrum stands for two.
  bool is_double(std::size_t m) const {
    const std::size_t column = m % transform_.spectrum_columns();
    return column > 0 && 2 * column < transform_.columns();
  }

  /// Adds a value at a place between pixels, spread by a cubic spline.
  void deposit(std::vector<double>& picture, PixelPlace at, double value) const {
    const auto weights = [](double t) {
      const double u = 1 - t;
      return std::array{u * u * u / 6, (4 - 6 * t * t + 3 * t * t * t) / 6,
                        (4 - 6 * u * u + 3 * u * u * u) / 6, t * t * t / 6};
    };
    const double x = std::floor(at.x), y = std::floor(at.y);
    const auto across = weights(at.x - x), down = weights(at.y - y);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        picture[wrapped(static_cast<long>(y) + static_cast<long>(i) - 1) * transform_.columns() +
                wrapped(static_cast<long>(x) + static_cast<long>(j) - 1)] +=
            down[i] * across[j] * value;
  }
  /// Returns the filter that turns the fluctuations of speckle into those of frames: the root of
  /// the spectrum of the sum over all pairs of points of b b' C_I at their distance in the picture.
  std::vector<double> object_filter(const PictureScene& scene,
                                    const SpecklePrediction& speckle) const {
    const auto& [place, brightness, far] = scene.object;
    std::vector<PixelPlace> at;
    for (const Vec& p : place) at.push_back(place_in_picture(scene, p));
    std::vector<double> picture(transform_.rows() * transform_.columns());
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t j = 0; j < at.size(); ++j) {
        const double distance = std::hypot(place[i].x - place[j].x, place[i].y - place[j].y);
        deposit(picture, {at[i].x - at[j].x, at[i].y - at[j].y},
                brightness[i] * brightness[j] * speckle.correlation_at(distance));
      }
    auto roots = root_of_spectrum(picture);
    const double all = std::reduce(brightness.begin(), brightness.end());
    for (std::size_t m = 0; m < roots.size(); ++m) {
      const auto [fy, fx] = frequency(m);
      const double spline = std::pow(sinc(fx) * sinc(fy), 2);
      roots[m] *= std::sqrt(speckle.exposure) / (all * spline);
    }
    return roots;
  }

  const PictureTask& task_;
  std::size_t pixels_;
  PlaneTransform transform_;
  const std::vector<double>& light_;
  std::vector<double> field_, object_;
};

}  // namespace

PicturePrediction predicted_pictures(const PictureScene& scene, const PictureTask& task,
                                     const SpecklePrediction& speckle,
                                     const std::vector<double>& truth) {
  constexpr std::uint64_t first_draw = std::uint64_t{1} << 62;
  const FrameModel model(scene, task, speckle);
  std::vector<double> similarity(task.draws);
  BatchJob job;
  job.size = 1;
  job.run = [&](std::uint64_t number, std::span<Complex>) {
    if (number >= task.draws) return;
    RandomStream random(task.seed, static_cast<std::uint64_t>(Stream::camera), first_draw + number);
    Frames frames{scene.camera().pixels, scene.camera().pixels, {}, 0};
    for (std::uint64_t i = 0; i < task.average; ++i) {
      const auto frame = model.draw(random);
      frames.values.insert(frames.values.end(), frame.begin(), frame.end());
    }
    const auto statistics = picture_statistics(frames, 0, task.average, task.lags, task.detected());
    const auto found = retrieved_picture(statistics.autocorrelation, task.size(), task.phases);
    similarity[number] =
        picture_score(truth, found.picture, task.size(), point_width_of(speckle.grain()))
            .similarity;
  };
  RunState state;
  run_to_end(job, {{task.draws, std::nullopt, std::nullopt}, task.threads, "prediction", {}},
             state);
  PicturePrediction found;
  const auto count = static_cast<double>(task.draws);
  double squares = 0;
  for (const double value : similarity) {
    found.similarity += value / count;
    squares += value * value / count;
    if (value > task.least_similarity) found.success += 1 / count;
  }
  found.similarity_error = std::sqrt(std::max(0.0, squares - found.similarity * found.similarity) /
                                     std::max(1.0, count - 1));
  return found;
}

}  // namespace flatspeckle::mc
