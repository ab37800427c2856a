#pragma once

#include <string>
#include <vector>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// How far a solution without chance is refined: until the ordinates of one step and those of the
/// step before, a third fewer, agree to a relative tolerance.
struct Refinement {
  double tolerance = 1e-6;
  int first_order = 6;
  int most_ordinates = 1500;  ///< of both ways together; past it the error tells what is missing
};

/// Values and their difference from the step before: more than their error.
struct Refined {
  std::vector<Complex> value, difference;
  int ordinates = 0;  ///< the most that any part has needed
};

/// The covariance of C14 and C18 on a slab, per entry of the request, as linear transport of pairs
/// at one transverse frequency (conventions, C35 to C40): what covariance_job() estimates, single
/// scattering in closed form. reversed: with reversed paths (C38). The tolerance is relative to the
/// entry, or to the root of its two intensities where the request has them.
Refined slab_covariance(const Scene& slab, bool reversed, const Refinement& refinement);

/// The same as a job of two batches, the values plus and minus their difference: any function of
/// them has its own difference as its error then. The first batch solves.
FieldJob slab_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement);

}  // namespace flatspeckle::mc
