#include "apps/command/subcommands.h"

namespace flatspeckle::apps {

int place(const Arguments& arguments);
int solve(const Arguments& arguments);
int covariance(const Arguments& arguments);
int validate(const Arguments& arguments);
int flux(const Arguments& arguments);
int sweep(const Arguments& arguments);
int merge(const Arguments& arguments);
int optimise(const Arguments& arguments);
int field(const Arguments& arguments);
int image(const Arguments& arguments);
int fit(const Arguments& arguments);
int recover(const Arguments& arguments);
int trace(const Arguments& arguments);
int render(const Arguments& arguments);
int design(const Arguments& arguments);
int bench(const Arguments& arguments);
int list_keys(const Arguments& arguments);
int datasets(const Arguments& arguments);
int explain(const Arguments& arguments);
int new_scene(const Arguments& arguments);

std::span<const SubcommandEntry> subcommands() {
  static constexpr SubcommandEntry entries[] = {
      {"place", "a placement of scatterers, drawn and written as CSV", place},
      {"solve", "exact fields of one placement of scatterers", solve},
      {"covariance",
       "covariance and intensity of the speckle of a scene, by Monte Carlo or exactly", covariance},
      {"validate", "both methods on one scene, compared entry by entry", validate},
      {"flux", "reflected, transmitted and absorbed power, intensity only", flux},
      {"sweep",
       "memory-effect curves over g, albedo, optical depth, radius, index; any result by --of",
       sweep},
      {"merge", "the points of a sweep that ran in shares, as one result", merge},
      {"optimise", "the values of keys that make a number of a result as large as can be, or small",
       optimise},
      {"field", "speckle fields drawn with the covariance of a scene, also over tilts of the light",
       field},
      {"image",
       "pictures of hidden points through a medium, and what the memory effect finds in them",
       image},
      {"recover", "points found in the autocorrelation of measured frames", recover},
      {"fit", "the medium that gave measured curves and fluxes, with errors", fit},
      {"trace", "rays and the curves between two points in a gradient-index field", trace},
      {"render", "pictures of scattering media with a gradient index: 3D refractive path tracing",
       render},
      {"design", "an index field from what its light should do: inverse design by rays", design},
#ifdef FLATSPECKLE_BENCH
      {"bench",
       "what accuracy costs, where it breaks, what plans leave out: error, stability, plan", bench},
#endif
      {"keys", "the keys of all subcommands, for programs: json, markdown, man, completion",
       list_keys},
      {"new", "a commented scene to begin with, for a purpose", new_scene},
      {"explain", "what a result file holds, in words: its medium, sizes, and what draws it",
       explain},
      {"datasets", "what result files hold, as in docs/format.md", datasets}};
  return entries;
}

}  // namespace flatspeckle::apps
