#pragma once

#include <variant>

#include "grin/fields/field_sum.h"
#include "grin/fields/focused_sound.h"
#include "grin/fields/gaussian_blobs.h"
#include "grin/fields/guides.h"
#include "grin/fields/lenses.h"
#include "grin/fields/ramps.h"
#include "grin/fields/spline_field.h"
#include "grin/fields/ultrasound.h"

namespace flatspeckle::grin {

using AnySum = FieldSum<Homogeneous, Luneburg, Fisheye, ParabolicGuide, SechGuide, LinearRamp,
                        TanhRamp, GaussianBlobs, StandingWave, FocusedSound, SplineField>;

/// A field chosen at run time: std::visit it once for a bundle of rays, never for a step.
using AnyIndexField =
    std::variant<Homogeneous, Luneburg, Fisheye, ParabolicGuide, SechGuide, LinearRamp, TanhRamp,
                 GaussianBlobs, StandingWave, FocusedSound, SplineField, AnySum>;

}  // namespace flatspeckle::grin
