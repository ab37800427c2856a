#include "apps/light_options.h"

#include <limits>

#include "apps/key_values.h"
#include "core/error.h"

namespace flatspeckle::apps {

void add_light_options(Options& options, LightSpec& spec) {
  options.add("--point_light", spec.points, "x y z power: shines alike into all directions");
  options.add("--beam_light", spec.beams,
              "x y z dx dy dz radius power: parallel rays from an even disk");
  options.add("--face_light", spec.faces,
              "x y z radius radiance: the stage's boundary within the radius shines inwards, "
              "Lambertian, with this L/n^2");
  options.add("--environment", spec.environment,
              "L/n^2 of light that comes in through all of the boundary");
}

std::vector<grin::Light> make_lights(const LightSpec& spec) {
  std::vector<grin::Light> lights;
  for (const auto& p : parts_of("point_light", spec.points, 4, "x y z power"))
    lights.push_back(grin::PointLight{three(p, 0), positive("point_light, power", p[3])});
  for (const auto& b : parts_of("beam_light", spec.beams, 8, "x y z dx dy dz radius power"))
    lights.push_back(
        grin::BeamLight{three(b, 0), direction_of("beam_light, direction", {b[3], b[4], b[5]}),
                        positive("beam_light, radius", b[6]), positive("beam_light, power", b[7])});
  for (const auto& f : parts_of("face_light", spec.faces, 5, "x y z radius radiance"))
    lights.push_back(grin::FaceLight{three(f, 0), positive("face_light, radius", f[3]),
                                     positive("face_light, radiance", f[4])});
  if (spec.environment)
    lights.push_back(grin::FaceLight{grin::Vec3::Zero(), std::numeric_limits<double>::infinity(),
                                     positive("environment", *spec.environment)});
  if (lights.empty())
    throw InputError(
        "light is not given: a scene needs one or more of point_light, beam_light, face_light, "
        "environment");
  return lights;
}

}  // namespace flatspeckle::apps
