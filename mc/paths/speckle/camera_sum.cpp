#include "mc/paths/speckle/camera_sum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/blas.h"
#include "core/numbers/gauss.h"
#include "core/numbers/phasor.h"
#include "core/numbers/random.h"
#include "mc/paths/estimators/path_endpoints.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

constexpr int widest = 12;

/// Kernel of exponential of a semicircle, 1 at 0 and nearly 0 at t = 1.
double kernel(double t, int width) {
  return std::exp(2.3 * width * (std::sqrt(std::max(0.0, 1 - t * t)) - 1));
}

/// Returns the endpoints of far views, and their factors for the medium of the walks.
std::unique_ptr<EndpointFactors> factors_of(const PathWalks& walks,
                                            const std::vector<View>& views) {
  std::vector<Endpoint> endpoints;
  for (const View& view : views) endpoints.push_back({false, view.direction(), {}, 1, {}});
  return walks.factors(walks.scene(), endpoints, true);
}

/// Returns the view with these direction cosines, on the side of the camera.
View view_at(const FarCamera& camera, double x, double y) {
  const double z = std::copysign(std::sqrt(1 - x * x - y * y), camera.axis.z);
  return far_view(std::atan2(std::hypot(x, y), z), std::atan2(y, x));
}

/// Returns the values of the Lagrange polynomials of Chebyshev nodes at t, by the barycentric
/// formula.
std::vector<double> lagrange(const std::vector<double>& node, double t) {
  std::vector<double> value;
  double sum = 0;
  for (std::size_t a = 0; a < node.size(); ++a) {
    const double angle =
                     (2 * static_cast<double>(a) + 1) / (2 * static_cast<double>(node.size())) * pi,
                 distance = t - node[a];
    if (distance == 0) {
      std::vector<double> one(node.size());
      one[a] = 1;
      return one;
    }
    value.push_back((a % 2 == 0 ? 1 : -1) * std::sin(angle) / distance);
    sum += value.back();
  }
  for (double& v : value) v /= sum;
  return value;
}

}  // namespace

Scene on_coarse_camera(Scene scene) {
  constexpr std::size_t few = 8;
  CovarianceRequest& request = scene.request;
  FarCamera camera = request.camera.value();
  camera.pixels = std::min(few, camera.pixels);
  const auto kind = request.kind;
  request = intensity_request(request.lights, camera.views());
  request.kind = kind;
  if (kind == CovarianceRequest::Kind::full) request.entries.clear();
  request.camera = camera;
  return scene;
}

CameraSum::Axis::Axis(double low, double high, double bandwidth, int kernel_width)
    : width(kernel_width) {
  // Twice as many points as the bandwidth requires
  const double longest = std::max(high - low, 1e-6);
  step = std::min(pi / bandwidth, 4 * longest);
  origin = low - step * width / 2.0;
  size = static_cast<std::size_t>(std::ceil(longest / step)) + static_cast<std::size_t>(width) + 1;
}

std::size_t CameraSum::Axis::spread(double x, std::span<double> weights) const {
  const double position = (x - origin) / step, first = std::ceil(position - width / 2.0);
  for (int i = 0; i < width; ++i)
    weights[static_cast<std::size_t>(i)] = kernel(2 * (first + i - position) / width, width);
  return static_cast<std::size_t>(std::max(0.0, first));
}

double CameraSum::Axis::transform(double wavenumber) const {
  static const QuadratureRule rule = gauss_legendre(40);  // on [0, 1]
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i)
    sum += width * rule.weight[i] * kernel(rule.node[i], width) *
           std::cos(wavenumber * step * rule.node[i] * width / 2);
  return sum;
}

CameraSum::CameraSum(const PathWalks& walks, const FarCamera& camera,
                     const CameraResolution& resolution, std::size_t fields)
    : walks_(walks),
      camera_(camera),
      box_(walks.scene().domain),
      k_(walks.scene().k),
      mu_t_(walks.scene().medium.mu_t),
      nodes_(resolution.nodes),
      fields_(fields),
      node_directions_(nodes_ * nodes_),
      values_(nodes_ * nodes_),
      side_field_(fields * camera.pixels * camera.pixels) {
  for (std::size_t a = 0; a < nodes_; ++a)
    node_.push_back(
        std::cos((2 * static_cast<double>(a) + 1) / (2 * static_cast<double>(nodes_)) * pi));
  const auto towards = [&](double x, double y) {
    return view_at(camera, camera.axis.x + camera.aperture * x, camera.axis.y + camera.aperture * y)
        .direction();
  };
  for (std::size_t b = 0; b < nodes_; ++b)
    for (std::size_t a = 0; a < nodes_; ++a)
      node_directions_.set(b * nodes_ + a, towards(node_[a], node_[b]));
  for (const View& view : camera.views()) pixel_directions_.push_back(view.direction());
  double low = 1, high = 0;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0}) {
      const double z = std::abs(towards(x, y).z);
      low = std::min(low, z);
      high = std::max(high, z);
    }
  if (std::hypot(camera.axis.x, camera.axis.y) < camera.aperture) high = 1;
  least_z_ = low;
  z_middle_ = std::copysign((low + high) / 2, camera.axis.z);
  x_ = {-box_.width / 2, box_.width / 2, 2 * k_ * camera.aperture, resolution.width};
  y_ = {-box_.height / 2, box_.height / 2, 2 * k_ * camera.aperture, resolution.width};
  z_ = {0, box_.depth, k_ * (high - low), resolution.width};
  grid_.resize(fields * x_.size * y_.size * z_.size * values_.size());
}

void CameraSum::add(Vec x, Vec arrival, std::span<const Complex> c) {
  const Complex middle =
      std::polar(1.0, -k_ * (camera_.axis.x * x.x + camera_.axis.y * x.y + z_middle_ * x.z));
  const double depth = depth_of(x);
  for (std::size_t j = 0; j < values_.size(); ++j)
    values_[j] = std::exp(-mu_t_ * depth / std::abs(node_directions_.z[j]) / 2) * middle;
  walks_.towards(x, arrival, node_directions_, values_);
  std::array<double, widest> wx, wy, wz;
  const std::size_t ix = x_.spread(x.x, wx), iy = y_.spread(x.y, wy), iz = z_.spread(x.z, wz);
  const std::size_t many = values_.size(), row = x_.size * many, plane = y_.size * row;
  std::vector<Complex> scaled(many);
  for (std::size_t f = 0; f < fields_; ++f) {
    for (std::size_t j = 0; j < many; ++j) scaled[j] = product(c[f], values_[j]);
    const auto* source = reinterpret_cast<const double*>(scaled.data());
    for (int z = 0; z < z_.width; ++z)
      for (int y = 0; y < y_.width; ++y) {
        const double weight = wz[static_cast<std::size_t>(z)] * wy[static_cast<std::size_t>(y)];
        auto* to = reinterpret_cast<double*>(
            &grid_[(f * z_.size + iz + static_cast<std::size_t>(z)) * plane +
                   (iy + static_cast<std::size_t>(y)) * row + ix * many]);
        for (int i = 0; i < x_.width; ++i, to += 2 * many) {
          const double w = weight * wx[static_cast<std::size_t>(i)];
          for (std::size_t j = 0; j < 2 * many; ++j) to[j] += w * source[j];
        }
      }
  }
  correct_sides(x, arrival, c);
}

void CameraSum::select_side_pixels(Vec x) {
  side_pixels_.clear();
  const double depth = depth_of(x);
  // Whether the ray along w leaves through a side before it has crossed the remaining depth
  const auto leaves = [&](Vec w) {
    const double z = std::abs(w.z);
    return depth * std::abs(w.x) > (box_.width / 2 - std::copysign(x.x, x.x * w.x)) * z ||
           depth * std::abs(w.y) > (box_.height / 2 - std::copysign(x.y, x.y * w.y)) * z;
  };
  const auto may_leave = [&](double half, double at, double cosine) {
    return depth * std::abs(cosine) > (half - std::copysign(at, at * cosine)) * least_z_;
  };
  const std::size_t pixels = camera_.pixels;
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < pixels; ++i)
    if (may_leave(box_.width / 2, x.x, camera_.cosine(camera_.axis.x, i))) columns.push_back(i);
  const auto select = [&](std::size_t pixel) {
    if (leaves(pixel_directions_[pixel])) side_pixels_.push_back(pixel);
  };
  for (std::size_t row = 0; row < pixels; ++row)
    if (may_leave(box_.height / 2, x.y, camera_.cosine(camera_.axis.y, row)))
      for (std::size_t column = 0; column < pixels; ++column) select(row * pixels + column);
    else
      for (const std::size_t column : columns) select(row * pixels + column);
}

void CameraSum::correct_sides(Vec x, Vec arrival, std::span<const Complex> c) {
  const double depth = depth_of(x), most_x = std::abs(camera_.axis.x) + camera_.aperture,
               most_y = std::abs(camera_.axis.y) + camera_.aperture;
  if (depth * most_x <= (box_.width / 2 - std::abs(x.x)) * least_z_ &&
      depth * most_y <= (box_.height / 2 - std::abs(x.y)) * least_z_)
    return;
  select_side_pixels(x);
  const std::size_t count = side_pixels_.size();
  if (count == 0) return;
  Directions directions(count);
  std::vector<double> phase(count), by_side(count), by_face(count), zero(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec w = pixel_directions_[side_pixels_[i]];
    directions.x[i] = w.x, directions.y[i] = w.y, directions.z[i] = w.z;
    phase[i] = -k_ * dot(w, x);
    by_side[i] = -mu_t_ * box_.distance_to_side(x, w) / 2;
    by_face[i] = -mu_t_ * depth / std::abs(w.z) / 2;
  }
  std::vector<Complex> field(count);
  damped_phasors(phase, zero, field);
  damping(by_side, by_side);
  damping(by_face, by_face);
  for (std::size_t i = 0; i < count; ++i) field[i] *= by_side[i] - by_face[i];
  walks_.towards(x, arrival, directions, field);
  for (std::size_t f = 0; f < fields_; ++f) {
    Complex* const to = &side_field_[f * camera_.pixels * camera_.pixels];
    for (std::size_t i = 0; i < count; ++i) to[side_pixels_[i]] += product(c[f], field[i]);
  }
}

std::vector<Complex> CameraSum::to_pixels(const Axis& axis, double axis_cosine) const {
  std::vector<Complex> all;
  all.reserve(camera_.pixels * nodes_ * axis.size);
  for (std::size_t p = 0; p < camera_.pixels; ++p) {
    const double off = camera_.cosine(axis_cosine, p) - axis_cosine,
                 scale = 1 / axis.transform(k_ * off);
    const auto at = lagrange(node_, off / camera_.aperture);
    for (const double interpolated : at)
      for (std::size_t i = 0; i < axis.size; ++i)
        all.push_back(std::polar(scale * interpolated, -k_ * off * axis.at(i)));
  }
  return all;
}

void CameraSum::finish(std::span<Complex> out) const {
  const std::size_t pixels = camera_.pixels, across = nodes_ * x_.size, down = nodes_ * y_.size;
  const auto of_x = to_pixels(x_, camera_.axis.x), of_y = to_pixels(y_, camera_.axis.y);
  std::vector<double> off, scale;
  for (const Vec w : pixel_directions_) {
    off.push_back(k_ * (w.z - z_middle_));
    scale.push_back(1 / z_.transform(off.back()));
  }
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += side_field_[i];
  std::vector<Complex> plane(across * down), half(pixels * across), image(off.size());
  const Complex one = 1, zero = 0;
  const auto n = [](std::size_t size) { return blas_size(size); };
  for (std::size_t f = 0; f < fields_; ++f)
    for (std::size_t z = 0; z < z_.size; ++z) {
      const Complex* const from = &grid_[(f * z_.size + z) * y_.size * x_.size * values_.size()];
      for (std::size_t y = 0; y < y_.size; ++y)
        for (std::size_t x = 0; x < x_.size; ++x)
          for (std::size_t b = 0; b < nodes_; ++b)
            for (std::size_t a = 0; a < nodes_; ++a)
              plane[(b * y_.size + y) * across + a * x_.size + x] =
                  from[((y * x_.size + x) * nodes_ + b) * nodes_ + a];
      cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n(pixels), n(across), n(down), &one,
                  of_y.data(), n(down), plane.data(), n(across), &zero, half.data(), n(across));
      cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasTrans, n(pixels), n(pixels), n(across), &one,
                  half.data(), n(across), of_x.data(), n(across), &zero, image.data(), n(pixels));
      for (std::size_t i = 0; i < image.size(); ++i)
        out[f * image.size() + i] += product(image[i], std::polar(scale[i], -off[i] * z_.at(z)));
    }
}

DirectCameraSum::DirectCameraSum(const PathWalks& walks, const FarCamera& camera)
    : walks_(walks), pixels_(factors_of(walks, camera.views())), values_(pixels_->size()) {}

void DirectCameraSum::add(Vec x, Vec arrival, Complex c, std::span<Complex> out) {
  pixels_->attenuate(x, values_);
  walks_.towards(x, arrival, pixels_->directions(), values_);
  for (std::size_t i = 0; i < values_.size(); ++i) out[i] += product(c, values_[i]);
}

namespace {

/// Error of a resolution: rms over the pixels of a coarse camera and over random ends, relative to
/// the rms of direct sums.
class CameraTrial {
 public:
  explicit CameraTrial(const PathWalks& walks)
      : walks_(walks), camera_(*walks.scene().request.camera), direct_(size()) {
    camera_.pixels = side;
    DirectCameraSum sum(walks, camera_);
    each_end([&](Vec x, Vec w, Complex c) { sum.add(x, w, c, direct_); });
  }

  double error(const CameraResolution& resolution) const {
    CameraSum sum(walks_, camera_, resolution, 1);
    each_end([&](Vec x, Vec w, Complex c) { sum.add(x, w, std::span(&c, 1)); });
    std::vector<Complex> found(size());
    sum.finish(found);
    double difference = 0, all = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      difference += std::norm(found[i] - direct_[i]);
      all += std::norm(direct_[i]);
    }
    return std::sqrt(difference / all);
  }

 private:
  static constexpr std::size_t side = 12;
  static constexpr std::size_t size() { return side * side; }

  template <typename F>
  void each_end(F f) const {
    constexpr int ends = 100;
    RandomStream random(1, static_cast<std::uint64_t>(Stream::fields), 0);
    const Domain& box = walks_.scene().domain;
    for (int i = 0; i < ends; ++i) {
      const Vec x{(random.uniform() - 0.5) * box.width, random.uniform() * box.depth,
                  (random.uniform() - 0.5) * box.height};
      const double cosine = 2 * random.uniform() - 1, azimuth = 2 * pi * random.uniform();
      f(x, direction(std::acos(cosine), azimuth), std::polar(1.0, 2 * pi * random.uniform()));
    }
  }

  const PathWalks& walks_;
  FarCamera camera_;
  std::vector<Complex> direct_;
};

}  // namespace

CameraResolution camera_resolution(const PathWalks& walks, double tolerance) {
  const CameraTrial trial(walks);
  CameraResolution found{1, widest};
  for (const std::size_t nodes : {1, 2, 3, 4, 5, 7, 9, 12, 16}) {
    found.nodes = nodes;
    found.error = trial.error(found);
    if (found.error < 0.7 * tolerance) break;
  }
  for (int width = 4; width < widest && found.error < tolerance; width += 2) {
    const CameraResolution narrower{found.nodes, width};
    if (const double error = trial.error(narrower); error <= tolerance)
      return {found.nodes, width, error};
  }
  return found;
}

}  // namespace flatspeckle::mc
