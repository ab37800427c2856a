#include "grin/render_plan.h"

#include <sstream>

#include "grin/render_job.h"

namespace flatspeckle::grin {

std::string RenderPlan::describe() const {
  std::ostringstream text;
  text << (curved ? "curved rays" : "straight rays") << "; "
       << (scatters ? "scattering" : "no scattering") << "; "
       << (absorbs ? "absorption" : "no absorption") << "; "
       << (gridded ? "density grid" : "uniform media") << "; "
       << (body ? "a body in the stage" : "a single medium") << "; "
       << (timed ? "time bins" : "steady state");
  return text.str();
}

RenderPlan render_plan(const RenderScene& scene) {
  RenderPlan plan;
  plan.curved = !std::holds_alternative<Homogeneous>(scene.field);
  plan.body = scene.stage.body.has_value();
  plan.timed = scene.bins.count > 1;
  plan.scatters = plan.absorbs = plan.gridded = false;
  const auto add = [&](const ScatteringMedium& medium) {
    plan.scatters |= medium.mu_s > 0;
    plan.absorbs |= medium.mu_a > 0;
    plan.gridded |= medium.density && medium.mu_t() > 0;
  };
  add(scene.stage.medium);
  if (scene.stage.body) add(scene.stage.body->medium);
  return plan;
}

}  // namespace flatspeckle::grin
