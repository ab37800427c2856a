#pragma once

#include <tuple>
#include <variant>

#include "grin/media/fields/ball_spline.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/focused_sound.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/graded_guide.h"
#include "grin/media/fields/homogeneous.h"
#include "grin/media/fields/linear_ramp.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/radial_spline.h"
#include "grin/media/fields/sech.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/media/fields/transducers.h"
#include "grin/media/fields/ultrasound.h"
#include "grin/media/index/field_sum.h"

namespace flatspeckle::grin {

/// All kinds of index fields (field_kind.h); the one list of them.
using IndexFieldKinds =
    std::tuple<HomogeneousValues, LuneburgValues, FisheyeValues, ParabolicValues, SechValues,
               LinearValues, TanhValues, BlobsValues, UltrasoundValues, FocusedSoundValues,
               TransducersValues, GridValues, BallValues, RadialSplineValues, GradedValues>;

template <class Kinds>
struct FieldsOf;
template <class... Kind>
struct FieldsOf<std::tuple<Kind...>> {
  using Sum = FieldSum<typename Kind::Field...>;
  template <class Other>
  using VariantWith = std::variant<typename Kind::Field..., Other>;
};

/// Any of them added up, compiled once: a sum is long enough for a call.
class AnySum {
 public:
  template <IndexField F>
  AnySum& add(F field) {
    sum_.add(std::move(field));
    return *this;
  }

  double excess(const Vec3& x) const;
  IndexGradient gradient(const Vec3& x) const;
  void gradients(const LaneVectors& x, LaneGradients& found) const;
  IndexHessian hessian(const Vec3& x) const;

 private:
  FieldsOf<IndexFieldKinds>::Sum sum_;
};

/// A field chosen at run time: std::visit it once for a bundle of rays, never for a step.
using AnyIndexField = FieldsOf<IndexFieldKinds>::VariantWith<AnySum>;

}  // namespace flatspeckle::grin
