#include "grin/render/stage/render_plan.h"

#include <sstream>

namespace flatspeckle::grin {

std::string RenderPlan::describe() const {
  std::ostringstream text;
  text << (curved ? "curved rays" : "straight rays") << "; "
       << (scatters ? "scattering" : "no scattering") << "; "
       << (absorbs ? "absorption" : "no absorption") << "; "
       << (gridded ? "density grid" : "uniform media") << "; "
       << (body ? "a body in the stage" : "a single medium") << "; "
       << (timed ? "optical paths" : "steady state") << "; "
       << (deep ? "importance in depth" : "no importance in depth");
  return text.str();
}

}  // namespace flatspeckle::grin
