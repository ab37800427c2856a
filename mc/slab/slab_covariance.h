#pragma once

#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/jobs/changed_fields.h"
#include "mc/slab/adding/slab.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// A scene's slab; of Layers, of which one at the least scatters, a layer each. delay: of
/// scatterers that diffuse as the scene states, of which each layer has its share.
template <typename Geometry>
SlabOf<Geometry, double> slab_of(const Scene& scene, double delay = 0);

/// The covariance of C14 and C18 on a slab in the plane or, as the scene says, of scalar waves in
/// space (C41), per entry of the request, as linear transport of pairs at one transverse frequency
/// (conventions, C35 to C40): what covariance_job() estimates, single scattering in closed form.
/// Layers are of plane waves in far views. reversed: with reversed paths (C38). The tolerance is
/// relative to the entry, or to the root of its two intensities (or that which the request has)
/// where that is more. change: of the second field of each entry.
Refined slab_covariance(const Scene& scene, bool reversed, const Refinement& refinement,
                        const FieldChange& change = {});

/// Values per entry, then derivatives by a parameter: exact, of the doubling itself. The tolerance
/// of a derivative is relative to the entry where that is more than what a relative change of the
/// parameter makes. The slab scatters, and has no layers.
Refined slab_slopes(const Scene& scene, bool reversed, const Refinement& refinement,
                    BulkParameter parameter);

/// The same of a slab and directions, per length or area. Ordinates, and in space modes of the
/// azimuth, are refined until each alone changes nothing. Number: double, Complex for two
/// frequencies, or Dual<double>, whose derivatives follow the values.
template <typename Geometry, typename Number>
Refined slab_covariance(const SlabOf<Geometry, Number>& slab,
                        const RequestOf<typename Geometry::Direction>& request, bool reversed,
                        const Refinement& refinement);

}  // namespace flatspeckle::mc
