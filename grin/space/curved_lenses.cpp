#include "grin/space/curved_space_of.h"

namespace flatspeckle::grin {

template class CurvedSpaceOf<Luneburg>;
template class CurvedSpaceOf<Fisheye>;
template class CurvedSpaceOf<ParabolicGuide>;
template class CurvedSpaceOf<SechGuide>;

}  // namespace flatspeckle::grin
