#include "apps/subcommands.h"
namespace flatspeckle::apps {
int trace(const Arguments&);
int render(const Arguments&);
int trace(const Arguments&) {
  return 1;
}
int render(const Arguments&) {
  return 1;
}
}  // namespace flatspeckle::apps
