#pragma once

#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

/// Side of a slab on which light leaves it.
enum class ExitSide { transmitted, reflected };

/// Returns the field correlation g1 of light that leaves a slab of diffusing scatterers, by the
/// diffusion theory of Pine, Weitz and others [pine1988], [weitz1993] (conventions, C53), which is
/// diffusing-wave spectroscopy. delay: t = k^2 D tau. A plane wave enters along the normal; its
/// light begins to diffuse one transport mean free path deep. The motion acts as an absorption 2 t
/// (1 - g) mu_s, which is added to mu_a. The result is the limit for thick slabs and small t; in
/// reflection, short paths make the true correlation decay faster.
double diffusing_wave_correlation(const DiffusingSlab& slab, double delay, ExitSide side);

/// Returns the factor gamma in g1 = exp(-gamma sqrt(2 dimension t)), the small-t limit of
/// diffusing_wave_correlation() for reflection by an infinitely thick slab without absorption: 1 +
/// z0/l*.
double backscattering_factor(const DiffusingSlab& slab);

/// Returns the delay t at which diffusing_wave_correlation() is 1/e.
double diffusing_wave_decay(const DiffusingSlab& slab, ExitSide side);

}  // namespace flatspeckle::mc
