#include "grin/curved_space_of.h"

namespace flatspeckle::grin {

template class CurvedSpaceOf<LinearRamp>;
template class CurvedSpaceOf<TanhRamp>;
template class CurvedSpaceOf<GaussianBlobs>;

}  // namespace flatspeckle::grin
