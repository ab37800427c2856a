#include "grin/space/curved_space.h"

#include <cmath>

#include "grin/space/curved_space_of.h"
#include "grin/space/straight_space.h"

namespace flatspeckle::grin {

extern template class CurvedSpaceOf<Luneburg>;
extern template class CurvedSpaceOf<Fisheye>;
extern template class CurvedSpaceOf<ParabolicGuide>;
extern template class CurvedSpaceOf<SechGuide>;
extern template class CurvedSpaceOf<LinearRamp>;
extern template class CurvedSpaceOf<TanhRamp>;
extern template class CurvedSpaceOf<GaussianBlobs>;
extern template class CurvedSpaceOf<StandingWave>;
extern template class CurvedSpaceOf<FocusedSound>;
extern template class CurvedSpaceOf<SplineField>;
extern template class CurvedSpaceOf<AnySum>;

CurvedSetup::CurvedSetup(const Stage& of, const CurvedSpaceOptions& with)
    : stage(of),
      excess_around(of.excess_around),
      field_part(of.body ? Part::body : Part::stage),
      options(with),
      connection{.step = with.step,
                 .max_length = with.max_length,
                 .start = {.chord_share = 0.2},
                 .tolerance = 1e-8,
                 .count_caustics = false} {}

namespace {

/// A field that is the same everywhere: no step, no solver.
class StraightCurvedSpace final : public CurvedSpace {
 public:
  StraightCurvedSpace(const Stage& stage, double excess) : space_(stage, excess) {}

  double index(const PathPoint& p) const override { return space_.index(p); }
  Flight fly(const PathPoint& from, const Vec3& direction, RandomStream& random) const override {
    return space_.fly(from, direction, random);
  }
  std::optional<Join> join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                           ConnectionStatistics& statistics) const override {
    return space_.join(p, q, random, statistics);
  }
  std::unique_ptr<const CurvedSpace> frozen(double) const override {
    throw InputError("random_phase needs a single field of sound: ultrasound or focused_sound");
  }

 private:
  StraightSpace<RenderPlan{.curved = false}> space_;
};

template <IndexField F>
const F& smooth_within(const F& field, const Surface&) {
  return field;
}
/// Where the rim is the surface that rays end on, steps that reach past it should stay smooth.
Luneburg smooth_within(const Luneburg& field, const Surface& container) {
  const Sphere* sphere = std::get_if<Sphere>(&container);
  LuneburgProfile profile = field.profile();
  const double rounding = 1e-9 * profile.radius;
  if (!sphere ||
      (sphere->centre - field.centre()).norm() + sphere->radius > profile.radius + rounding)
    return field;
  profile.beyond = 0.4;
  return Luneburg(profile, field.centre());
}

}  // namespace

std::unique_ptr<const CurvedSpace> make_curved_space(const AnyIndexField& field, const Stage& stage,
                                                     const CurvedSpaceOptions& options) {
  check(stage);
  const auto setup = std::make_shared<const CurvedSetup>(stage, options);
  const auto make = [&]<class F>(const F& of) -> std::unique_ptr<const CurvedSpace> {
    if constexpr (HomogeneousField<F>) {
      return std::make_unique<StraightCurvedSpace>(stage, of.n_excess);
    } else {
      check(setup->connection);
      return std::make_unique<CurvedSpaceOf<F>>(
          smooth_within(of, setup->stage.container(setup->field_part)), setup);
    }
  };
  return std::visit(make, field);
}

}  // namespace flatspeckle::grin
