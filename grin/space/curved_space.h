#pragma once

#include <memory>

#include "grin/fields/any_index_field.h"
#include "grin/space/space.h"
#include "grin/space/stage.h"

namespace flatspeckle::grin {

struct CurvedSpaceOptions {
  double step;            ///< of rays in sigma: length at index 1
  double max_length;      ///< arc length of a flight or join; longer ones are lost
  bool spreading = true;  ///< flights tell |J|, about half of their cost; joins always do
};

/// Space where the index varies. One virtual call for each flight or join; behind it every step
/// knows the type of the field.
class CurvedSpace {
 public:
  virtual ~CurvedSpace() = default;

  virtual double index(const PathPoint& p) const = 0;
  virtual Flight fly(const PathPoint& from, const Vec3& direction, RandomStream& random) const = 0;
  virtual std::optional<Join> join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                                   ConnectionStatistics& statistics) const = 0;

  /// The same space as light meets it at this phase of the sound, from 0 to 2 pi: S = cos(phase)
  /// of a standing wave (conventions, C28). Throws InputError for a field without sound.
  virtual std::unique_ptr<const CurvedSpace> frozen(double phase) const = 0;
};
static_assert(Space<CurvedSpace>);

/// The field fills the body if there is one, else the stage. Throws InputError for a bad stage, and
/// unless step and max_length are positive.
std::unique_ptr<const CurvedSpace> make_curved_space(const AnyIndexField& field, const Stage& stage,
                                                     const CurvedSpaceOptions& options);

}  // namespace flatspeckle::grin
