#include "mc/paths/speckle/camera_sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/numbers/blas.h"

namespace flatspeckle::mc {

namespace {

/// Number of ends that wait until they are spread together.
constexpr std::size_t ends_at_once = 4096;

/// Returns the least and largest |v_z| on a camera.
std::pair<double, double> range_of_z(const CameraBox& box) {
  const FarCamera& camera = box.camera();
  double low = 1, high = 0;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0}) {
      const double z = std::abs(
          box.towards(camera.axis.x + camera.aperture * x, camera.axis.y + camera.aperture * y).z);
      low = std::min(low, z);
      high = std::max(high, z);
    }
  if (std::hypot(camera.axis.x, camera.axis.y) < camera.aperture) high = 1;
  return {low, high};
}

}  // namespace

CameraSum::Grid::Grid(const CameraBox& box, const CameraResolution& resolution) {
  const int width = resolution.width;
  const Vec margin = resolution.margin;
  const auto [low, high] = range_of_z(box);
  const Domain& domain = box.box();
  const double across = 2 * box.k() * box.camera().aperture;
  z_middle = std::copysign((low + high) / 2, box.camera().axis.z);
  const double half_x = domain.width / 2 + margin.x, half_y = domain.height / 2 + margin.y;
  x = {-half_x, half_x, across, width};
  y = {-half_y, half_y, across, width};
  z = {-margin.z, domain.depth + margin.z, box.k() * (high - low), width};
}

CameraSum::CameraSum(const PathWalks& walks, const FarCamera& camera,
                     const CameraResolution& resolution, std::size_t fields)
    : box_(walks, camera),
      fields_(fields),
      node_(chebyshev_nodes(resolution.nodes)),
      node_directions_(box_.square(node_)),
      grid_(box_, resolution),
      values_(node_directions_.size()),
      scaled_(values_.size()),
      spread_(fields * grid_.size() * values_.size()),
      sides_(box_, resolution, fields) {
  waiting_factors_.reserve(ends_at_once * fields);
}

double CameraSum::bytes(const CameraBox& box, const CameraResolution& resolution) {
  const Grid grid(box, resolution);
  const auto nodes = static_cast<double>(resolution.nodes * resolution.nodes),
             lines = static_cast<double>(box.camera().pixels * (grid.x.size() + grid.y.size()) *
                                         resolution.side_nodes);
  return sizeof(Complex) * (static_cast<double>(grid.size()) * nodes + lines);
}

void CameraSum::add(const PathEnd& end, std::span<const Complex> factors, std::size_t field) {
  const std::size_t first = waiting_factors_.size();
  waiting_factors_.insert(waiting_factors_.end(), factors.begin(), factors.end());
  waiting_.push_back({end, field, std::span(waiting_factors_).subspan(first)});
  if (waiting_.size() == ends_at_once) flush();
}

void CameraSum::flush() {
  // Blocks of the grid that are as large as the kernel
  const auto block = [&](const SpreadingAxis& axis, double at) {
    return static_cast<int>((at - axis.at(0)) / (axis.at(1) - axis.at(0)) / axis.width());
  };
  std::vector<std::tuple<int, int, int, std::size_t>> order;
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    const Vec x = waiting_[i].end.place;
    order.emplace_back(block(grid_.y, x.y), block(grid_.x, x.x), block(grid_.z, x.z), i);
  }
  std::ranges::sort(order);
  for (const auto& [y, x, z, i] : order) spread(waiting_[i]);
  sides_.add(waiting_);
  waiting_.clear();
  waiting_factors_.clear();
}

void CameraSum::spread(const WeightedEnd& weighted) {
  const PathEnd& end = weighted.end;
  const Vec x = end.place, axis = box_.camera().axis;
  const double depth = box_.depth_of(end.x);
  const Complex middle =
      std::polar(1.0, -box_.k() * (axis.x * x.x + axis.y * x.y + grid_.z_middle * x.z));
  for (std::size_t j = 0; j < values_.size(); ++j)
    values_[j] = std::exp(-box_.mu_t() * depth / std::abs(node_directions_.z[j]) / 2) * middle;
  box_.walks().towards(end.x, end.arrival, node_directions_, values_);
  std::array<double, SpreadingAxis::widest> wx, wy, wz;
  const std::size_t ix = grid_.x.spread(x.x, wx), iy = grid_.y.spread(x.y, wy),
                    iz = grid_.z.spread(x.z, wz);
  const std::size_t many = values_.size(), row = grid_.x.size() * many,
                    plane = grid_.y.size() * row;
  const auto width = static_cast<std::size_t>(grid_.x.width());
  for (std::size_t f = 0; f < weighted.factors.size(); ++f) {
    for (std::size_t j = 0; j < many; ++j) scaled_[j] = product(weighted.factors[f], values_[j]);
    const auto* source = reinterpret_cast<const double*>(scaled_.data());
    for (std::size_t z = 0; z < width; ++z)
      for (std::size_t y = 0; y < width; ++y) {
        const double weight = wz[z] * wy[y];
        auto* to = reinterpret_cast<double*>(
            &spread_[((weighted.field + f) * grid_.z.size() + iz + z) * plane + (iy + y) * row +
                     ix * many]);
        for (std::size_t i = 0; i < width; ++i, to += 2 * many) {
          const double w = weight * wx[i];
          for (std::size_t j = 0; j < 2 * many; ++j) to[j] += w * source[j];
        }
      }
  }
}

void CameraSum::finish(std::span<Complex> out) {
  flush();
  const FarCamera& camera = box_.camera();
  const std::size_t pixels = camera.pixels, nodes = node_.size(), across = nodes * grid_.x.size(),
                    down = nodes * grid_.y.size();
  const auto of_x = grid_.x.to_pixels(camera, camera.axis.x, box_.k(), node_),
             of_y = grid_.y.to_pixels(camera, camera.axis.y, box_.k(), node_);
  std::vector<double> off, scale;
  for (std::size_t row = 0; row < pixels; ++row)
    for (std::size_t column = 0; column < pixels; ++column) {
      off.push_back(box_.k() * (box_.pixel(row, column).z - grid_.z_middle));
      scale.push_back(1 / grid_.z.transform(off.back()));
    }
  std::vector<Complex> plane(down * across), half(pixels * across), image(pixels * pixels);
  const Complex one = 1, zero = 0;
  const auto n = [](std::size_t size) { return blas_size(size); };
  for (std::size_t f = 0; f < fields_; ++f)
    for (std::size_t z = 0; z < grid_.z.size(); ++z) {
      // From [y][x][node y][node x] to [y][node y][x][node x]
      const Complex* from = &spread_[(f * grid_.z.size() + z) * plane.size()];
      for (std::size_t y = 0; y < grid_.y.size(); ++y)
        for (std::size_t x = 0; x < grid_.x.size(); ++x)
          for (std::size_t b = 0; b < nodes; ++b, from += nodes)
            std::copy_n(from, nodes, &plane[((y * nodes + b) * grid_.x.size() + x) * nodes]);
      cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n(pixels), n(across), n(down), &one,
                  of_y.data(), n(down), plane.data(), n(across), &zero, half.data(), n(across));
      cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasTrans, n(pixels), n(pixels), n(across), &one,
                  half.data(), n(across), of_x.data(), n(across), &zero, image.data(), n(pixels));
      for (std::size_t i = 0; i < image.size(); ++i)
        out[f * image.size() + i] +=
            product(image[i], std::polar(scale[i], -off[i] * grid_.z.at(z)));
    }
  sides_.finish(out);
}

DirectCameraSum::DirectCameraSum(const PathWalks& walks, const FarCamera& camera) : walks_(walks) {
  std::vector<Endpoint> endpoints;
  for (const View& view : camera.views()) endpoints.push_back({false, view.direction(), {}, 1, {}});
  pixels_ = walks.factors(walks.scene(), endpoints, true);
  values_.resize(pixels_->size());
}

void DirectCameraSum::add(const PathEnd& end, Complex c, std::span<Complex> out) {
  pixels_->attenuate(end.x, values_);
  walks_.towards(end.x, end.arrival, pixels_->directions(), values_);
  for (std::size_t i = 0; i < values_.size(); ++i) out[i] += product(c, values_[i]);
}

}  // namespace flatspeckle::mc
