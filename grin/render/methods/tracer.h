#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/numbers/complex.h"
#include "grin/render/flights/space.h"
#include "grin/render/methods/guided_walk.h"
#include "grin/render/methods/light_map.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/methods/render_scene.h"
#include "grin/render/methods/unscattered_beams.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Computes the sums of a map over light paths, [cell][fluence rate, absorbed power density], which
/// are 0 before, and adds their power to an energy balance. Each segment of a path contributes to a
/// cell in proportion to its length in the cell (track-length estimator). Lengths are sampled by
/// points along the segment.
using MapKernel = std::function<void(int paths, RandomStream& random, std::span<Complex> sums,
                                     EnergyBalance& energy, TransportCounts& counts)>;
inline constexpr std::size_t sums_per_cell = 2;
/// Number of labels of the voxels in a stage, 0 included; 0 without voxels. The sums of the cells
/// are followed by the power absorbed within the map in voxels of each label.
std::size_t label_count(const Stage& stage);
/// Number of sums of a map.
std::size_t map_sums(const LightMap& map, const Stage& stage);
/// Number of labels of the voxels in a stage, 0 included; 0 without voxels. The sums of the cells
/// are followed by the power absorbed within the map in voxels of each label.
std::size_t label_count(const Stage& stage);
/// Number of sums of a map.
std::size_t map_sums(const LightMap& map, const Stage& stage);

/// Makes the kernel of a map. random_phase: each light path has a random phase of the sound.
MapKernel map_kernel(const LightMap& map, std::shared_ptr<const Transport> transport,
                     std::shared_ptr<const Space> space, bool random_phase);

/// Returns the plan that has only the features that a scene needs.
RenderPlan render_plan(const RenderScene& scene);

/// Whether forward tracing is possible: light can hit all sensors.
bool can_be_forward(const RenderScene& scene);

/// Makes lights and sensors for a method; throws InputError if they do not fit the stage.
std::shared_ptr<Transport> transport_of(const RenderScene& scene, const RenderRequest& request,
                                        RenderMethod method);

/// Renders by one method.
struct Tracer {
  RenderMethod method;
  std::shared_ptr<Transport> transport;
  PathKernel kernel;  ///< empty if paths would contribute nothing
  BeamsKernel unscattered_beams =
      {};                    ///< unscattered light of beams, if any; the kernel leaves it out
  double rays_per_path = 1;  ///< rays of unscattered beams per path
  /// Mean flights of a light path and its sensor paths; infinity if they exceed the pilot's limit.
  double flights_per_pair = 1;
  /// Cost of a connection in flights, used to tune the connections. It is a low estimate, since a
  /// roulette threshold that is too low only costs time.
  double flights_per_connection = 0.1;
  /// Cost of a connection in closed form, in flights; 0 if connections are found by iteration.
  double cost_of_closed_connection = 0;
  Spreading spreading = Spreading::all;
  bool has_control_variates = false;  ///< whether light paths accumulate control variates
  bool is_guided = false;             ///< whether light paths are guided to far sensors (PathGuide)
  bool is_aimed = false;              ///< whether a pilot run has aimed its lights at the sensors

  void add(int paths, RandomStream& random, Film& film, TransportCounts& counts) const;
};

/// Makes the tracers of a scene. Holds references to scene and request.
class Tracers {
 public:
  Tracers(const RenderScene& scene, const RenderRequest& request);

  /// Makes the tracer of a method and tunes it by a pilot run.
  Tracer make(RenderMethod method) const;

  /// Returns an empty kernel if the scene has no map.
  MapKernel map_kernel() const;

  /// Upper estimate of the cost of a flight. The unit is a curved flight of twenty steps, or a
  /// straight flight in uniform media; long curved flights and tentative collisions in density
  /// grids cost more.
  double cost_of_flight() const;
  /// Approximate number of steps of a curved flight in the stage's medium.
  double steps_of_flight() const;

  /// Whether paths are traced; if not, all lights are beams and nothing scatters.
  bool walks() const { return walks_; }

  /// Whether the rays of beams are counted where they hit the sensors, without connections. They
  /// are if nothing scatters, most of the light hits each sensor, and forward tracing is requested
  /// or the index varies: connections along curved rays are expensive.
  bool counts_rays() const { return counts_rays_; }

  /// Whether forward tracing guides its paths, since few would reach some sensor.
  bool are_guided() const { return guide_ != nullptr; }

  const RenderScene& scene() const { return scene_; }
  const RenderPlan& plan() const { return plan_; }

 private:
  void find_depth();
  void find_motion();
  void find_beams();
  void find_guide();
  void find_aim();
  Tracer untuned(RenderMethod method) const;
  /// Tunes the connections by pilot runs; returns the flights per pair.
  double flights(const Tracer& tracer) const;
  SpaceOptions options(Spreading spreading) const;
  Spreading spreading_of(RenderMethod method) const;

  const RenderScene& scene_;
  const RenderRequest& request_;
  RenderPlan plan_;
  bool walks_ = true, counts_rays_ = false;
  std::shared_ptr<const PathGuide> guide_;  ///< for counted paths; set if few reach some sensor
  std::optional<Aim> aim_;                        ///< for counted paths; set if it saves much work
  std::shared_ptr<const DepthImportance> depth_;  ///< set if the plan is deep
  /// Set if derivatives by parameters of the field are requested (gradient_by).
  std::shared_ptr<const MovingField> moving_;
  BeamsKernel unscattered_beams_ = {};  ///< set if there are beams
  /// Tracer::rays_per_path for forward tracing, whose paths are as cheap as rays
  double few_rays_per_path_ = 1;
};

}  // namespace flatspeckle::grin
