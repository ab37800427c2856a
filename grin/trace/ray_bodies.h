#pragma once

#include "grin/render/values/field_body.h"
#include "grin/render/values/plain_bodies.h"

namespace flatspeckle::grin {

/// Bodies that rays pass, as keys have them: those of render's stage.
struct RayBodyValues : FieldBodyValues {
  PlainBodyValues plain_bodies{};
};

void add_keys(Keys& keys, RayBodyValues& values);

/// A stage around them, whose boundary rays need not know of. A field that fills a body loses its
/// rim, box and symmetry, as rays see that body. Throws InputError.
Stage make_ray_stage(const Keys& keys, const RayBodyValues& values, SceneField& field);

/// 0 where there is no field.
double index_at(const SceneField& field, const Stage& stage, const Vec3& x);

}  // namespace flatspeckle::grin
