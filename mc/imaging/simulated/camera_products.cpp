#include "mc/imaging/simulated/camera_products.h"

#include <algorithm>
#include <cmath>

#include "core/numbers/blas.h"

namespace flatspeckle::mc {

namespace {

constexpr std::size_t ends_of_block = 128;

std::vector<Endpoint> pixel_endpoints(const FarCamera& camera) {
  std::vector<Endpoint> endpoints;
  for (const View& view : camera.views()) endpoints.push_back({false, view.direction(), {}, 1, {}});
  return endpoints;
}

}  // namespace

CameraProducts::CameraProducts(const PathWalks& walks, const FarCamera& camera, std::size_t lights,
                               std::size_t changes)
    : walks_(walks),
      endpoints_(pixel_endpoints(camera)),
      lights_(lights),
      blocks_(changes) {
  for (Block& block : blocks_) {
    block.factors.resize(ends_of_block * lights);
    block.pixels.resize(ends_of_block * endpoints_.size());
  }
}

EndpointFactors& CameraProducts::pixels(int wave) {
  const auto number = static_cast<std::size_t>(wave);
  if (number >= pixels_.size()) pixels_.resize(number + 1);
  auto& factors = pixels_[number];
  if (!factors) {
    factors = walks_.factors(walks_.scene(), endpoints_, true);
    factors->choose(wave);
  }
  return *factors;
}

void CameraProducts::add(const PathEnd& end, std::span<const Complex> factors, std::size_t change,
                         std::span<Complex> out) {
  Block& block = blocks_[change];
  EndpointFactors& pixels = this->pixels(end.wave);
  const std::size_t size = pixels.size();
  std::ranges::copy(factors, block.factors.begin() + static_cast<long>(block.ends * lights_));
  const auto row = std::span(block.pixels).subspan(block.ends * size, size);
  pixels.attenuate(end.x, row);
  walks_.towards(end.x, end.arrival, pixels.directions(), row);
  if (const Vec move = end.place - end.x; move != Vec{})
    for (std::size_t p = 0; p < size; ++p)
      row[p] =
          product(row[p], std::polar(1.0, -walks_.scene().k * dot(pixels.direction(p), move)));
  if (++block.ends == ends_of_block) flush(change, out);
}

void CameraProducts::flush(std::size_t change, std::span<Complex> out) {
  Block& block = blocks_[change];
  const std::size_t size = endpoints_.size();
  const Complex one = 1;
  if (block.ends > 0)
    cblas_zgemm(CblasRowMajor, CblasTrans, CblasNoTrans, blas_size(lights_), blas_size(size),
                blas_size(block.ends), &one, block.factors.data(), blas_size(lights_),
                block.pixels.data(), blas_size(size), &one, &out[change * lights_ * size],
                blas_size(size));
  block.ends = 0;
}

void CameraProducts::finish(std::span<Complex> out) {
  for (std::size_t change = 0; change < blocks_.size(); ++change) flush(change, out);
}

}  // namespace flatspeckle::mc
