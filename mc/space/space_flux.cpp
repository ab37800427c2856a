#include "mc/space/space_flux.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numbers/blas.h"
#include "mc/space/azimuthal_modes.h"

namespace flatspeckle::mc {

namespace {

/// {reflected, transmitted}: without momentum, of the mode m = 0 alone.
std::pair<double, double> leaving(const SpaceSlab& slab, double angle, int order) {
  const PolarMatricesOf<double> polar({{angle, slab.law.width()}}, order, slab.law, slab.albedo);
  const AzimuthalModesOf<double> modes(polar, slab, 0);
  const Eigen::Vector3d light(std::sin(angle), 0, std::cos(angle));
  const auto [lights, views] = modes.ends({1, 0}, {{light, light}}, {});
  const auto response = layer_response(modes.transport(0, modes.parts(0).front()),
                                       slab.optical_depth(), lights, views);
  const auto share = [&](const Rows& rows) { return (rows.real() * modes.power())(0) / light.z(); };
  return {share(response.up), share(response.down)};
}

}  // namespace

SpaceFlux space_flux(const SpaceSlab& slab, double angle, const Refinement& refinement) {
  blas_single_thread();
  int order = refinement.first_order();
  for (auto before = leaving(slab, angle, order);;) {
    order = Refinement::next_order(order);
    const auto [up, down] = leaving(slab, angle, order);
    const double change = std::max(std::abs(up - before.first), std::abs(down - before.second));
    if (change <= refinement.tolerance || 2 * order > refinement.most_ordinates)
      return {up, down, change};
    before = {up, down};
  }
}

}  // namespace flatspeckle::mc
