#include "grin/render/methods/path_kernels.h"

#include <numbers>
#include <sstream>

#include "grin/render/transport/bidirectional.h"

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

namespace {

template <class Tree>
PathKernel kernel_of(std::shared_ptr<const Transport> transport, std::shared_ptr<const Space> space,
                     bool random_phase) {
  return [=](int paths, RandomStream& random, Film& film, TransportCounts& counts,
             ExpectedConnections* expected_connections) {
    const auto add = [&](const Space& met, int first, int last) {
      Bidirectional<Tree> estimator(*transport, met, random, film, counts);
      for (int path = first; path < last; ++path) {
        estimator.add(path, paths);
        if (expected_connections) estimator.append_expected_contributions(*expected_connections);
      }
    };
    if (!random_phase) return add(*space, 0, paths);
    for (int path = 0; path < paths; ++path)
      add(*space->frozen(2 * std::numbers::pi * random.uniform()), path, path + 1);
  };
}

}  // namespace

PathKernel path_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                       std::shared_ptr<const Space> space, bool random_phase) {
  return plan.deep ? kernel_of<SplitTree>(transport, space, random_phase)
                   : kernel_of<UnsplitPath>(transport, space, random_phase);
}

}  // namespace flatspeckle::grin
