#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/numbers/complex.h"
#include "grin/render/flights/space.h"
#include "grin/render/methods/light_map.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/methods/render_scene.h"
#include "grin/render/methods/unscattered_beams.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Adds so many light paths to the sums of a map: [cell][fluence rate, absorbed power density], and
/// what became of their power. Each stretch of a path counts by its length in a cell (track-length
/// estimator), which points along it find.
using MapKernel = std::function<void(int paths, RandomStream& random, std::span<Complex> sums,
                                     EnergyBalance& energy, TransportCounts& counts)>;
inline constexpr std::size_t sums_per_cell = 2;

/// random_phase: each light path meets its own phase of the sound.
MapKernel map_kernel(const LightMap& map, std::shared_ptr<const Transport> transport,
                     std::shared_ptr<const Space> space, bool random_phase);

/// The least plan that a scene allows.
RenderPlan render_plan(const RenderScene& scene);

/// Of sensors that light can hit.
bool can_be_analog(const RenderScene& scene);

/// Lights and sensors for a method; throws InputError where they do not fit the stage.
std::shared_ptr<Transport> transport_of(const RenderScene& scene, const RenderRequest& request,
                                        RenderMethod method);

/// What draws light by one method.
struct Tracer {
  RenderMethod method;
  std::shared_ptr<Transport> transport;
  PathKernel kernel;                   ///< empty where paths would bring nothing
  BeamsKernel unscattered_beams = {};  ///< where the kernel leaves that out and there is some
  double rays_per_path = 1;            ///< of them
  /// Of a light path and its sensor paths; infinity where they were too long to be walked.
  double flights_per_pair = 1;
  /// Less than what one costs, as a level of joins too low only costs time.
  double flights_per_join = 0.1;
  double cost_of_closed_join = 0;  ///< in flights; 0 of joins by iterations
  Spreading spreading = Spreading::all;

  void add(int paths, RandomStream& random, Film& film, TransportCounts& counts) const;
};

/// Makes the tracers of a scene. Refers to scene and request.
class Tracers {
 public:
  Tracers(const RenderScene& scene, const RenderRequest& request);

  /// Walks a few paths to tune it.
  Tracer make(RenderMethod method) const;

  /// Nothing where the scene asks for no map.
  MapKernel map_kernel() const;

  /// At the most, against a flight of twenty steps, or of none in uniform media: long curved ones
  /// cost more, and those through grids with many tentative collisions.
  double cost_of_flight() const;
  /// Of curved rays in the stage's medium, roughly.
  double steps_of_flight() const;

  /// Whether light paths book their drift.
  bool has_drift() const { return depth_ && depth_->drift(); }

  /// Light paths: else beams are all the light, and nothing scatters it.
  bool walks() const { return walks_; }

  const RenderScene& scene() const { return scene_; }
  const RenderPlan& plan() const { return plan_; }

 private:
  void find_depth();
  void find_motion();
  void find_beams();
  Tracer untuned(RenderMethod method) const;
  /// Of a pair, as a pilot has it that tunes joins.
  double flights(const Tracer& tracer) const;
  SpaceOptions options(Spreading spreading) const;
  Spreading spreading_of(RenderMethod method) const;

  const RenderScene& scene_;
  const RenderRequest& request_;
  RenderPlan plan_;
  bool walks_ = true;
  std::shared_ptr<const DepthImportance> depth_;  ///< where the plan is deep
  std::shared_ptr<const MovingField> moving_;     ///< where the scene has parameters
  BeamsKernel unscattered_beams_ = {};            ///< where there are beams
  double few_rays_per_path_ = 1;                  ///< where paths cost no more than they do
};

}  // namespace flatspeckle::grin
