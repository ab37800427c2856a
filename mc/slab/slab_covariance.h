#pragma once

#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/jobs/changed_fields.h"
#include "mc/slab/adding/slab.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Returns the covariance of each entry of the request for a slab in the plane (C14, C18) or, if
/// the scene's dimension is 3, for scalar waves in space (C41). covariance_job() estimates the same
/// quantity by Monte Carlo. This function solves the linear transport of field pairs at one
/// transverse frequency (C35 to C40), with single scattering in closed form. Layers require plane
/// waves and far views. reversed: whether to include reversed paths (C38). change: change of the
/// second field of each entry. The tolerance is relative to scales().
Refined slab_covariance(const Scene& scene, bool reversed, const Refinement& refinement,
                        const FieldChange& change = {});

/// Returns the values of the entries, then their derivatives by a parameter, computed by exact
/// differentiation of the doubling method. Let d be a derivative times unit_of() of the parameter.
/// The tolerance of d is relative to d or to the entry, whichever is larger. The slab must scatter
/// and have no layers.
Refined slab_derivatives(const Scene& scene, bool reversed, const Refinement& refinement,
                         BulkParameter parameter);

/// Returns the covariance per illuminated length or area for a request given by directions.
/// Ordinates and, in space, azimuthal modes are refined until refining either of them changes no
/// entry by more than the tolerance. Number: double; Complex for fields at two frequencies; or
/// Dual<double>, which appends the derivatives to the values.
template <typename Geometry, typename Number>
Refined slab_covariance(const SlabOf<Geometry, Number>& slab,
                        const RequestOf<typename Geometry::Direction>& request, bool reversed,
                        const Refinement& refinement);

}  // namespace flatspeckle::mc
