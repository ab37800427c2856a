#include "grin/space/curved_space_of.h"

namespace flatspeckle::grin {

template class CurvedSpaceOf<LinearRamp>;
template class CurvedSpaceOf<TanhRamp>;
template class CurvedSpaceOf<StandingWave>;
template class CurvedSpaceOf<FocusedSound>;

}  // namespace flatspeckle::grin
