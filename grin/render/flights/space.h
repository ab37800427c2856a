#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "grin/rays/marching/step_curve.h"
#include "grin/render/curved/ray_field.h"
#include "grin/render/stage/flight.h"
#include "grin/render/stage/part_medium.h"
#include "grin/render/stage/stage.h"
#include "grin/render/stage/straight_stage.h"

namespace flatspeckle::grin {

/// A segment of a flight within one part.
struct FlightSegment {
  PathPoint start;
  Vec3 direction;  ///< unit tangent at the start of the segment
  double length;
  double weight;  ///< weight of the flight at the start of the segment
};
using FlightLog = std::vector<FlightSegment>;

/// Calls use(x, length) for equidistant points of a segment, at most `apart` from each other, with
/// a random offset. length: arc length that x represents, times the remaining weight of the flight
/// at x. A sum over the points is an unbiased estimate of the integral along the segment. x_at(s):
/// position at arc length s; it is called with increasing s.
template <class At, class Use>
void for_points(const FlightSegment& segment, const PartMedium& medium, double apart,
                RandomStream& random, At x_at, const Use& use) {
  const double count = std::max(1.0, std::ceil(segment.length / apart));
  const double spacing = segment.length / count, offset = random.uniform();
  const bool absorbs = !medium.scatters() && medium.mu_t() > 0;
  const auto collide = [&] { return sample_free_flight(medium.majorant(), random.uniform()); };
  double left = segment.weight;
  double tentative =
      absorbs && medium.varies() ? collide() : std::numeric_limits<double>::infinity();
  for (double i = 0; i < count; ++i) {
    const double s = (i + offset) * spacing;
    for (; tentative < s; tentative += collide()) left *= medium.lacking(x_at(tentative));
    const bool is_even = absorbs && !medium.varies();
    use(x_at(s), spacing * (is_even ? left * transmittance(medium.mu_t(), s) : left));
  }
}

/// Selects the flights for which the spreading |J| (C25) is computed: none, those that end on the
/// boundary, or all. For curved rays it takes about half of the cost of a flight. It is always
/// computed for connections.
enum class Spreading { none, to_boundary, all };

struct SpaceOptions {
  double step = 1;  ///< step of curved rays in sigma, a length where the index is 1
  /// Largest arc length of a curved flight or connection; longer ones are lost.
  double max_length = std::numeric_limits<double>::infinity();
  Spreading spreading = Spreading::all;
  bool leapfrogs = false;  ///< see make_ray_field()
};

/// Flights and connections for the estimators. Rays are straight in parts of constant index; in the
/// part filled by a field of varying index they are curved and traced by RayField, with one virtual
/// call per segment.
class Space {
 public:
  /// Requires a stage that passes check(); make_space() checks it.
  Space(const AnyIndexField& field, const Stage& stage, const SpaceOptions& options = {});

  double index(const PathPoint& p) const {
    return 1 + (is_curved(p.part) ? field_->excess(p.x) : setup_->stage.excess(p.part));
  }
  /// Whether the index varies within some part.
  bool has_curves() const { return !setup_->is_straight; }
  bool is_curved(Part part) const { return part == setup_->field_part && has_curves(); }

  /// Samples a flight. log: receives the segments of the flight; or null. log_gradient: gradient of
  /// the logarithm of the importance, which biases the first segment if that is straight
  /// (StraightStage::fly); or null.
  Flight fly(const PathPoint& from, const Vec3& direction, RandomStream& random,
             FlightLog* log = nullptr, const Vec3* log_gradient = nullptr) const {
    const Spreading spreading = setup_->options.spreading;
    if (spreading == Spreading::to_boundary && !log)
      return fly_again_to_boundary(from, direction, random, log_gradient);
    return fly_once(from, direction, spreading != Spreading::none, random, log, log_gradient);
  }
  /// Whether flights can be traced in SIMD lanes at lower cost: in a single part filled by the
  /// field, without |J|.
  bool has_lanes() const;
  /// Start of a flight in a lane, with the random stream that it uses.
  struct FlightStart {
    PathPoint from;
    Vec3 direction;
    RandomStream* random;
  };
  /// Receives a lane and its last flight (null at first); returns the start of the next flight of
  /// the lane, or nullopt to leave the lane empty.
  using NextFlight = std::function<std::optional<FlightStart>(int lane, const Flight*)>;
  /// Traces flights in SIMD lanes until all lanes are empty.
  void fly_side_by_side(const NextFlight& next) const;
  /// Calls use() for points of a segment; see for_points() above.
  template <class Use>
  void for_points(const FlightSegment& segment, double apart, RandomStream& random,
                  const Use& use) const;

  /// Whether connections between points of these parts are possible.
  bool can_connect(const PathPoint& p, const PathPoint& q) const {
    return setup_->stage.are_alike(p.part, q.part) || connects_through();
  }
  double least_depth(const PathPoint& p, const PathPoint& q) const {
    return setup_->stage.least_depth(p, q);
  }
  /// Connects two points by a curve without interface crossings; nullopt if there is none.
  std::optional<TestConnection> connect(const PathPoint& p, const PathPoint& q,
                                        RandomStream& random,
                                        ConnectionStatistics& statistics) const;
  /// Approximate cost of connect() in flights; cost_of_closed_connection() is 0 if connections are
  /// found by iteration.
  double cost_of_connection() const { return field_->cost_of_curve(); }
  double cost_of_closed_connection() const { return field_->cost_of_closed_curve(); }
  bool connects_through() const { return setup_->stage.refracts(); }
  /// Connects two points by a random specular connection through interfaces.
  std::optional<TestConnection> connect_through(const PathPoint& p, const PathPoint& q,
                                                RandomStream& random,
                                                ConnectionStatistics& statistics) const;

  /// Returns connections from p to parallel light, found by tracing rays backwards from p: those to
  /// which the seeds lead, and sometimes one found at random.
  std::vector<BeamConnection> connections_to_beam(const PathPoint& p, const ParallelLight& light,
                                                  std::span<const BeamSeed> seeds,
                                                  RandomStream& random,
                                                  ConnectionStatistics& statistics) const;
  /// Returns the connection to parallel light whose ray is refracted wherever possible, found by a
  /// deterministic search.
  std::optional<BeamConnection> simplest_connection_to_beam(const PathPoint& p,
                                                            const ParallelLight& light,
                                                            RandomStream& random,
                                                            ConnectionStatistics& statistics) const;
  /// Returns the connection to parallel light that one random trial finds.
  std::optional<BeamConnection> some_connection_to_beam(const PathPoint& p,
                                                        const ParallelLight& light,
                                                        RandomStream& random,
                                                        ConnectionStatistics& statistics) const;
  /// Returns the connection to parallel light with this start direction and these crossings.
  std::optional<BeamConnection> beam_connection(const PathPoint& p, const ParallelLight& light,
                                                const Vec3& direction,
                                                const InterfaceCrossings& crossings,
                                                RandomStream& random) const;

  /// Returns this space at a fixed phase of the sound, from 0 to 2 pi: S = cos(phase) for a
  /// standing wave (conventions, C28). Throws InputError for a field without sound.
  std::unique_ptr<const Space> frozen(double phase) const;

 private:
  /// Data that do not depend on the phase of the sound.
  struct Setup {
    StraightStage stage;
    Part field_part;
    bool is_straight;
    /// For each surface of the field's region: 1 if the region is inside it, -1 if outside.
    std::vector<double> sides;
    SpaceOptions options;
    double longest;                ///< largest arc length of a flight
    ConnectionOptions connection;  ///< options for curves of the field
    ConnectionOptions search;      ///< options for specular connections and connections to beams
  };
  Space(std::shared_ptr<const Setup> setup, std::shared_ptr<const RayField> field)
      : setup_(std::move(setup)), field_(std::move(field)) {}

  /// Returns index and gradient in a part, at a point that may be on its surface. Sound has the
  /// phase of this space.
  IndexGradient side(Part part, const Vec3& x) const {
    if (is_curved(part)) return field_->gradient(x);
    return {setup_->stage.excess(part), Vec3::Zero()};
  }
  /// Region filled by the field.
  SurfaceRegion region() const { return setup_->stage.regions().region(setup_->field_part); }
  const PartMedium& medium() const { return setup_->stage.medium(setup_->field_part); }
  SegmentDomain segment_domain() const { return {region(), medium(), setup_->options.step}; }
  /// Returns the surface on which a ray ends, and moves the ray exactly onto it (to rounding).
  SegmentEnd end_on_surface(RayState& ray) const;

  friend class Segments;
  class Lanes;
  struct Neighbours;
  class Curve;

  bool searches_for_beams() const { return connects_through() || is_curved(around); }
  bool stays_inside(RayState ray, double sigma, int steps) const;
  Flight fly_once(const PathPoint& from, const Vec3& direction, bool spreads, RandomStream& random,
                  FlightLog* log, const Vec3* log_gradient) const;
  Flight fly_again_to_boundary(const PathPoint& from, const Vec3& direction, RandomStream& random,
                               const Vec3* log_gradient) const;
  void go_on(Flight& flight, std::optional<SegmentEnd> end, bool spreads, RandomStream& random,
             FlightLog* log) const;
  bool goes_outside(const Vec3& x, const Vec3& direction) const;
  void end_segment(Flight& flight, const RayState& ray, double weight) const;
  std::optional<SegmentEnd> next_segment(Flight& flight, Neighbours& neighbours,
                                         RandomStream& random) const;
  std::optional<SegmentEnd> curved_segment(Flight& flight, Neighbours& neighbours,
                                           RandomStream& random) const;
  void cross(Flight& flight, SegmentEnd surface, Neighbours& neighbours,
             RandomStream& random) const;
  double transmitted(const PathPoint& p, const Connection& curve, RandomStream& random) const;

  std::shared_ptr<const Setup> setup_;
  std::shared_ptr<const RayField> field_;
};

/// Computes points of a curved segment at increasing arc lengths.
class Space::Curve {
 public:
  Curve(const Space& space, const FlightSegment& segment)
      : field_(*space.field_),
        step_(space.setup_->options.step),
        now_(start_ray(field_, segment.start.x, segment.direction)),
        before_(now_) {}

  /// Returns the point at arc length s; s must increase from call to call.
  Vec3 operator()(double s) {
    while (now_.arc_length < s) {
      before_ = now_;
      field_.advance(step_, 1, now_, nullptr);
      if (!(now_.arc_length > before_.arc_length)) return before_.x;
    }
    const StepCurve curve(before_, now_, step_);
    return curve.x(curve.theta_at(s));
  }

 private:
  const RayField& field_;
  double step_;
  RayState now_, before_;
};

template <class Use>
void Space::for_points(const FlightSegment& segment, double apart, RandomStream& random,
                       const Use& use) const {
  const PartMedium& in = setup_->stage.medium(segment.start.part);
  if (is_curved(segment.start.part))
    return grin::for_points(segment, in, apart, random, Curve(*this, segment), use);
  const auto x_at = [&](double s) -> Vec3 { return segment.start.x + s * segment.direction; };
  grin::for_points(segment, in, apart, random, x_at, use);
}

/// Checks the stage and makes its space. Throws InputError for an invalid stage.
std::unique_ptr<const Space> make_space(const AnyIndexField& field, const Stage& stage,
                                        const SpaceOptions& options = {});

}  // namespace flatspeckle::grin
