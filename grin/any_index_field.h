#pragma once

#include <variant>

#include "grin/field_sum.h"
#include "grin/focused_sound.h"
#include "grin/gaussian_blobs.h"
#include "grin/guides.h"
#include "grin/lenses.h"
#include "grin/ramps.h"
#include "grin/spline_field.h"
#include "grin/ultrasound.h"

namespace flatspeckle::grin {

using AnySum = FieldSum<Homogeneous, Luneburg, Fisheye, ParabolicGuide, SechGuide, LinearRamp,
                        TanhRamp, GaussianBlobs, StandingWave, FocusedSound, SplineField>;

/// A field chosen at run time: std::visit it once for a bundle of rays, never for a step.
using AnyIndexField =
    std::variant<Homogeneous, Luneburg, Fisheye, ParabolicGuide, SechGuide, LinearRamp, TanhRamp,
                 GaussianBlobs, StandingWave, FocusedSound, SplineField, AnySum>;

}  // namespace flatspeckle::grin
