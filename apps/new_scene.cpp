#include <algorithm>
#include <iostream>
#include <iterator>

#include "apps/command/subcommands.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

/// An example scene: the word that selects it, its subcommand and its text.
struct Purpose {
  const char *word, *subcommand, *lines;
};

constexpr Purpose purposes[] = {
    {"memory-effect", "covariance",
     R"(# How far can the light be tilted before the speckle behind a slab decorrelates?
domain = "slab"               # infinite in x
depth = 1000                  # in wavelengths
scatterer = "hg"              # Henyey and Greenstein
g = 0.9                       # mean cosine of scattering
optical_depth = 10            # depth in mean free paths
albedo = 1                    # below 1: the medium absorbs
view_angles = [0]             # radians; pi - 0.2 is a view in reflection
covariance = "memory_effect"
tilts = [0, 1e-4, 2e-4, 3e-4, 4e-4, 6e-4, 8e-4]  # radians
)"},
    {"validate", "validate",
     R"(# Monte Carlo compared with the exact solution, entry by entry: cylinders in a box.
domain = "box"
width = 20                    # wavelengths
depth = 10
scatterer = "tm"              # dielectric cylinders, E along the axis
radius = 0.16
index = "1.5"                 # "1.5+0.01i" absorbs
count = 67                    # number of cylinders; each placement has new positions
view_angles = [0.4, 1.0, 2.1, 3.1415]
wave_samples = 400            # placements of the exact solver
samples = 200000              # light paths
)"},
    {"near-field", "solve",
     R"(# The exact field around and inside cylinders, on a grid: near field.
domain = "box"
width = 12                    # wavelengths
depth = 8
scatterer = "tm"
radius = 0.4
index = "1.5"
count = 20
map = [-8, 8, -2, 12]         # x from, to, z from, to
)"},
    {"waveguide", "render",
     R"(# Irradiance at the end of a scattering graded-index guide, n^2 = n0^2 - alpha^2 r^2, for a beam along it.
field = ["parabolic"]
index = 1.33
alpha = 0.15
stage_box = [-6, -6, 0, 6, 6, 20]            # two opposite corners
mu_s = 0.15                                  # scattering, per length
phase = "henyey_greenstein"
g = 0.9
beam_light = [0, 0, 0, 0, 0, 1, 0.3, 1]      # x y z dx dy dz radius power
sensor = "area"
sensor_at = [0, 0, 20]
sensor_size = [6, 6]
pixels = [48, 48]
samples = 60000
)"},
    {"lens", "design",
     R"(# A lens that focuses parallel light onto a point of its surface.
design = "radial"             # or "ball": no symmetry
coefficients = 8
directions = 1
rays_per_direction = 100
)"},
    {"imaging", "image",
     R"(# Can a camera recover four points behind a medium from the autocorrelation of its frame?
domain = "box"
width = 4000
depth = 20
scatterer = "hg"
g = 0.9
optical_depth = 5
object_x = [0, 60, 150, 310]  # the points, on a line
object_depth = -40000         # far away on the side opposite to the camera
camera = [-0.5, 0.5]          # sines of the first and last viewing direction
pixels = 8192
repeats = 2                   # number of media, with one frame each
)"},
    {"matrix", "matrix",
     R"(# Transmission matrices of slabs that repeat: open channels, focusing, memory effect.
width = 40.3                  # the period, in wavelengths; it sets the number of channels
depth = 10
scatterer = "tm"              # dielectric cylinders, E along the axis
radius = 0.25
index = "1.5"
count = 200                   # number of cylinders; each placement has new positions
samples = 20                  # placements
)"},
    {"tissue", "reflectance",
     R"(# Diffuse light at distances from a beam on tissue, and its decorrelation by moving scatterers.
length_unit = "mm"
wavelength = "785nm"          # in vacuum
depth = 60
scatterer = "hg"
mu_s = 10
mu_a = 0.02
g = 0.9
medium_index = 1.4            # the surface reflects; outside_index is 1
distances = [5, 10, 20, 30]
ring_width = 1
diffusion = "1e-12 m^2/s"     # of the scatterers
delays = ["0", "1us:1ms:21:log"]
)"}};

std::string words() {
  std::string all;
  for (const Purpose& purpose : purposes) all += std::string(" ") + purpose.word;
  return all;
}

int print_scene(const Subcommand&, Words& values) {
  const std::string word = values.text();
  if (word.empty()) throw InputError("new: must have one purpose, one of" + words());
  const auto* const found = std::ranges::find(purposes, word, &Purpose::word);
  if (found == std::end(purposes)) throw InputError("new", word, "must be one of" + words());
  std::cout << found->lines << "# To run it: flatspeckle " << found->subcommand
            << " --config THIS_FILE --out result.h5; then: flatspeckle explain result.h5\n";
  return ExitStatus::done;
}

}  // namespace

std::unique_ptr<Call> new_scene(const std::string&) {
  return call_with<Words>("new", "Prints a commented example scene: new PURPOSE, one of" + words(),
                          print_scene);
}

}  // namespace flatspeckle::apps
