#include <variant>

#include "grin/rays/connections/connection_solver.h"
#include "grin/render/curved/fisheye_rays.h"
#include "grin/render/curved/luneburg_rays.h"
#include "grin/render/curved/parabolic_rays.h"

namespace flatspeckle::grin {

namespace {

/// Straight rays in a homogeneous field, without steps.
class StraightRays final : public RayFieldOf<Homogeneous> {
 public:
  explicit StraightRays(const Homogeneous& field) : RayFieldOf(field), field_(field) {}

  ConnectionEstimate connect(const CurveEndpoints& ends, const ConnectionOptions& options,
                             RandomStream& random,
                             ConnectionStatistics& statistics) const override {
    return grin::connect(Trial(field_, ends.region, ends.from, ends.to, options), random,
                         statistics);
  }
  std::vector<FoundConnection> connections(const CurveEndpoints& ends,
                                           const ConnectionOptions& options, std::uint64_t trials,
                                           RandomStream& random,
                                           ConnectionStatistics& statistics) const override {
    const Trial trial(field_, ends.region, ends.from, ends.to, options);
    return all_connections(trial, trials, random, statistics);
  }

 private:
  using Trial = ConnectionTrial<Homogeneous, Sides>;

  Homogeneous field_;
};

/// Makes the rays of a field in the region that the surfaces bound. The field is continued smoothly
/// beyond the outer surface, since numerical steps may extend past it.
template <IndexField F>
std::unique_ptr<const RayField> ray_field_within(const F& field, std::span<const Surface> surfaces,
                                                 bool leapfrogs) {
  if constexpr (HomogeneousField<F>) return std::make_unique<StraightRays>(field);
  if constexpr (goes_by_leapfrog<F>)
    if (leapfrogs) return std::make_unique<RayFieldOf<F, Leapfrog>>(field);
  if constexpr (std::same_as<F, ParabolicGuide>)
    if (!surfaces.empty() && bends_within(field, surfaces[0]))
      return std::make_unique<ParabolicRays>(field, surfaces[0]);
  if constexpr (requires { smooth_within(field, Sphere()); })
    if (const Sphere* sphere = surfaces.empty() ? nullptr : std::get_if<Sphere>(&surfaces[0])) {
      const F smooth = smooth_within(field, *sphere);
      if (surfaces.size() == 1)
        if (auto closed = closed_form_within(smooth, *sphere)) return closed;
      return std::make_unique<RayFieldOf<F>>(smooth);
    }
  return std::make_unique<RayFieldOf<F>>(field);
}

}  // namespace

std::unique_ptr<const RayField> make_ray_field(const AnyIndexField& field,
                                               std::span<const Surface> surfaces, bool leapfrogs) {
  const auto within = [&](const auto& of) { return ray_field_within(of, surfaces, leapfrogs); };
  return std::visit(within, field);
}

}  // namespace flatspeckle::grin
