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
#include "grin/media/fields/polynomial.h"
#include "grin/media/fields/radial_spline.h"
#include "grin/media/fields/sech.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/media/fields/transducers.h"
#include "grin/media/fields/ultrasound.h"

namespace flatspeckle::grin {

/// All kinds of index fields (explained in field_kind.h). To add a kind, extend only this list.
using IndexFieldKinds =
    std::tuple<HomogeneousValues, LuneburgValues, FisheyeValues, ParabolicValues, SechValues,
               LinearValues, TanhValues, BlobsValues, UltrasoundValues, FocusedSoundValues,
               TransducersValues, GridValues, BallValues, RadialSplineValues, GradedValues,
               PolynomialValues>;

template <class Kinds>
struct FieldsOf;
template <class... Kind>
struct FieldsOf<std::tuple<Kind...>> {
  using Vectors = std::tuple<std::vector<typename Kind::Field>...>;
  template <class Other>
  using VariantWith = std::variant<typename Kind::Field..., Other>;
};

/// A sum of index fields: n - 1 is the sum of n - 1 over all terms. It contains any number of terms
/// of each kind, chosen at run time, without branches in the loop over the terms. Its functions are
/// not inlined, because a call costs little compared with a sum.
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

/// An index field of any kind, chosen at run time. Call std::visit once for a bundle of rays, never
/// for each integration step.
using AnyIndexField = FieldsOf<IndexFieldKinds>::VariantWith<AnySum>;

/// A parameter of the index field, and two copies of the field in which this parameter is smaller
/// and larger by `step`, for finite differences.
struct FieldParameter {
  std::string name;
  /// Magnitude of the parameter (1 if it is 0), to which relative changes refer.
  double scale;
  double step;
  AnyIndexField less, more;
};

}  // namespace flatspeckle::grin
