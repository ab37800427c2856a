#include "grin/space/curved_space_of.h"

namespace flatspeckle::grin {

template class CurvedSpaceOf<GaussianBlobs>;
template class CurvedSpaceOf<SplineField>;
template class CurvedSpaceOf<AnySum>;

}  // namespace flatspeckle::grin
