#pragma once

#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

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
  using Vectors = std::tuple<std::vector<typename Kind::Field>...>;
  template <class Other>
  using VariantWith = std::variant<typename Kind::Field..., Other>;
};

/// n = 1 + the sum of the terms' excesses: any number of each kind, chosen at run time and without
/// a choice in the loop. Compiled once: a sum is long enough for a call.
class AnySum {
 public:
  template <IndexField F>
  AnySum& add(F field) {
    std::get<std::vector<F>>(terms_).push_back(std::move(field));
    return *this;
  }

  double excess(const Vec3& x) const;
  IndexGradient gradient(const Vec3& x) const;
  void gradients(const LaneVectors& x, LaneGradients& found) const;
  IndexHessian hessian(const Vec3& x) const;

 private:
  FieldsOf<IndexFieldKinds>::Vectors terms_;
};

/// A field chosen at run time: std::visit it once for a bundle of rays, never for a step.
using AnyIndexField = FieldsOf<IndexFieldKinds>::VariantWith<AnySum>;

/// A number of the index field, and the fields with a little less and more of it.
struct FieldParameter {
  std::string name;
  double scale;  ///< what counts as a whole of it: its size, or 1
  double step;
  AnyIndexField less, more;
};

}  // namespace flatspeckle::grin
