#include "flatland/scene/scene.h"

namespace flatspeckle {

void add_scatterer_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Scatterers");
  keys.add(
          "wavelength", spec.wavelength,
          "Wavelength around the scatterers or, if medium_index is given, in vacuum; sets the unit "
          "of length")
      .positive()
      .unit("length");
  keys.add("scatterer", spec.scatterer,
           "Points; cylinders that are soft (field 0 at the rim), hard (normal derivative 0), tm "
           "or te (E or H along the axis); a phase function instead of scatterers; or mie, "
           "spheres in 3D")
      .one_of(scatterer_words());
  keys.add("radius", spec.radius, "Radius of the cylinders or spheres")
      .positive()
      .unit("length")
      .only_of("soft, hard, tm, te and mie")
      .swept();
  keys.add("diameter", spec.diameter, "Diameter of the cylinders or spheres, instead of radius")
      .positive()
      .unit("length")
      .only_of("soft, hard, tm, te and mie");
  keys.add(
          "index", spec.index,
          "Relative index, such as \"1.5+0.1i\" (absorbing); no part may be negative (default 1.5)")
      .only_of("tm, te and mie")
      .swept();
  keys.add("phase_shift", spec.phase_shift,
           "Scattering phase shift of a lossless point (default pi/2, resonance)")
      .unit("rad")
      .only_of("point");
}

void add_bulk_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Bulk");
  keys.add("optical_depth", spec.optical_depth,
           "Optical depth mu_t x depth, which sets the density")
      .positive()
      .swept();
  keys.add("g", spec.g, "Mean cosine of the scattering angle (default 0)")
      .between(-1, 1)
      .only_of("hg")
      .swept();
  add_keys(keys, spec.bulk);
  keys.add("albedo", spec.albedo,
           "Albedo (default 1). Points require a value above 0; below 1, they scatter at resonance")
      .from(0, 1)
      .only_of("points and phase functions of the bulk")
      .swept();
  keys.add("mu_s", spec.mu_s, "Scattering coefficient, instead of albedo and a density")
      .positive()
      .unit("1/length")
      .only_of("phase functions of the bulk");
  keys.add("mu_a", spec.mu_a, "Absorption coefficient (default 0)")
      .not_negative()
      .unit("1/length")
      .only_of("mu_s");
}

void add_medium_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Medium");
  keys.add("domain", spec.domain, "Region of the scatterers; a slab is infinite in x and y")
      .one_of({"box", "slab"});
  keys.add("width", spec.width, "Width of the box: |x| <= width/2")
      .positive()
      .unit("length")
      .only_of("a box");
  keys.add("depth", spec.depth, "Depth of the domain: 0 <= z <= depth").positive().unit("length");
  keys.add("count", spec.count, "Number of scatterers in the box, which sets the density")
      .not_negative();
  keys.add("density", spec.density, "Number of scatterers per area, in 3D per volume")
      .positive()
      .unit("1/length^2 or 1/length^3")
      .swept();
  keys.add("volume_fraction", spec.volume_fraction,
           "Fraction of the volume (in 2D of the area) that the scatterers fill, which sets the "
           "density")
      .between(0, 1)
      .only_of("soft, hard, tm, te and mie");
  keys.add("mass_fraction", spec.mass_fraction,
           "Mass of the scatterers divided by the mass of the suspension, which sets the density")
      .between(0, 1)
      .only_of("soft, hard, tm, te and mie");
  keys.add("particle_density", spec.particle_density,
           "Mass per volume of the scatterers, in the unit of medium_density")
      .positive()
      .only_of("mass_fraction");
  keys.add("medium_density", spec.medium_density,
           "Mass per volume of the medium around the scatterers")
      .positive()
      .only_of("mass_fraction");
  keys.add("mean_free_path", spec.mean_free_path, "Mean free path 1/mu_t, which sets the density")
      .positive()
      .unit("length");
  keys.add("placement", spec.placement,
           "poisson for points; for disks hard_disk (default, random sequential addition) or "
           "equilibrium (the fluid of hard disks or spheres)")
      .one_of(placement_words);
  keys.add("min_gap", spec.min_gap,
           "Least gap between the rims of disks or spheres (default 1e-3 radius)")
      .not_negative()
      .unit("length")
      .only_of("disks and spheres");
}

void add_space_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Space");
  keys.add("dimension", spec.dimension, "2: the plane (x, z); 3: space, with scalar waves")
      .from(2, 3)
      .only_of("programs and methods that work in space");
  keys.add("height", spec.height, "Height of the box: |y| <= height/2")
      .positive()
      .unit("length")
      .only_of("a box with dimension = 3");
  keys.add("light_azimuths", spec.light_azimuths,
           "Azimuths of the light_angles, from x towards y: one for each, or one for all (default "
           "0)")
      .angle()
      .only_of("light_angles with dimension = 3");
  keys.add(
          "view_azimuths", spec.view_azimuths,
          "Azimuths of the view_angles, from x towards y: one for each, or one for all (default 0)")
      .angle()
      .only_of("view_angles with dimension = 3");
  keys.add("tilt_azimuth", spec.tilt_azimuth,
           "Direction of tilts and shifts, as an azimuth from that of the light: 0 in the plane of "
           "incidence (default), pi/2 out of it")
      .angle()
      .only_of("tilts and shifts with dimension = 3");
  keys.add("beam_y", spec.beam_y, "y of the beams' foci (default 0)")
      .unit("length")
      .only_of("beams with dimension = 3");
  keys.add("camera_pixels", spec.camera_pixels,
           "Number of pixels along each side of a square camera of far views around the only "
           "direction of view_angles")
      .from(1, 4096)
      .only_of("far views with dimension = 3");
  keys.add("camera_aperture", spec.camera_aperture,
           "Numerical aperture of the camera: half its width, as a difference of direction cosines")
      .positive_to(1)
      .only_of("a camera (camera_pixels)");
  keys.add("pair_azimuths", spec.pair_azimuths,
           "Azimuths of the angles of `pairs`, in the same order (default 0)")
      .angle()
      .only_of("covariance = pairs with dimension = 3");
}

void add_faces_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Scatterers");
  keys.add("particle_index", spec.particle_index,
           "Absolute index of the scatterers, instead of index; it is divided by medium_index")
      .only_of("tm, te and mie with medium_index");
  keys.group("Faces");
  keys.add("medium_index", spec.medium_index,
           "Refractive index around the scatterers. The wavelength is then that in vacuum, the "
           "faces "
           "z = 0 and z = depth reflect, and all angles are those outside")
      .positive()
      .swept();
  keys.add("outside_index", spec.outside_index, "Refractive index outside the faces (default 1)")
      .positive()
      .only_of("media with medium_index")
      .swept();
  keys.add(
          "polarisation", spec.polarisation,
          "Reflection at the faces. tm: E along the axis, and scalar waves in space (default); te: "
          "H "
          "along the axis, in the plane; unpolarised: mean power of both, for flux. Cylinders have "
          "their own")
      .one_of(polarisation_words)
      .only_of("media with medium_index");
}

void add_structure_key(Keys& keys, SceneSpec& spec) {
  keys.group("Medium");
  keys.add("structure", spec.structure,
           "Structure factor of the positions in Monte Carlo and transport: none; hard_disks, or "
           "a file that place --structure wrote, of cylinders; hard_spheres of spheres");
}

void add_profile_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Medium");
  keys.add("layers", spec.layers,
           "CSV with a line for each layer; the first layer starts at z = 0. Columns: thickness; "
           "one of "
           "optical_depth, mean_free_path, density and mu_s (with mu_a, in place of albedo); and "
           "those of g, albedo, radius, index_re, "
           "index_im, phase_shift, medium_index that differ between layers; also diffusion and "
           "flow, "
           "factors on the diffusion constant and the velocity")
      .file()
      .only_of("layered media, instead of depth and density");
  keys.add("density_blobs", spec.density_blobs,
           "CSV with columns x, z, radius, amplitude and, in space, y: Gaussians added to the "
           "relative density of 1")
      .file()
      .only_of("a box");
  keys.add("density_map", spec.density_map,
           "HDF5 file with relative_density [z][x], in space [z][y][x], of equal cells that fill "
           "the box")
      .file()
      .only_of("a box");
}

void add_index_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Index around the scatterers");
  keys.add("index_field", spec.index_field,
           "How the index n varies: n^2 linear, a parabolic guide along z, Gaussian blobs, a "
           "standing sound wave, or samples on a grid (the wavelength is that where n = 1); or "
           "mean_field, the effective index of the scatterers (k_shift)")
      .one_of(index_field_words);
  keys.add("axis_index", spec.axis_index,
           "Index at the origin (linear), on the axis x = 0 (parabolic), or in the background")
      .positive()
      .only_of("index_field = linear, parabolic, blobs and ultrasound");
  keys.add("index_slope", spec.index_gradient, "Gradient of n^2, along x and z")
      .exactly(2, "along x, along z")
      .unit("1/length")
      .only_of("index_field = linear");
  keys.add("index_alpha", spec.index_alpha, "alpha in n^2 = axis_index^2 - alpha^2 x^2")
      .positive()
      .unit("1/length")
      .only_of("index_field = parabolic");
  keys.add("index_blobs", spec.index_blobs,
           "CSV with columns x, z, height, width: each line adds height exp(-r^2/(2 width^2)) to n")
      .file()
      .only_of("index_field = blobs");
  keys.add("sound_amplitude", spec.sound_amplitude,
           "Amplitude of the change of n, sound_amplitude J_0(sound_wavenumber x)")
      .only_of("index_field = ultrasound");
  keys.add("sound_wavenumber", spec.sound_wavenumber, "2 pi frequency / speed of the sound")
      .positive()
      .unit("1/length")
      .only_of("index_field = ultrasound");
  keys.add("index_grid", spec.index_grid,
           "HDF5 file with excess [x][y][z], which is n - 1 as for render; samples at y = 0 are "
           "used")
      .file()
      .only_of("index_field = grid");
}

void add_view_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Lights and views");
  keys.add("light_angles", spec.light_angles, "Directions of plane waves and beams, from +z")
      .angle()
      .only_of("plane waves and beams (not with near_sources or pairs)");
  keys.add("view_angles", spec.view_angles, "Directions of far views, from +z")
      .angle()
      .only_of(
          "far views (give either near_sensors or view_angles; pairs contain their own angles)");
  keys.add("near_sensors", spec.near_sensors, "CSV with columns x, z: near-field sensors")
      .only_of("near fields (pairs and memory_effect have far views only)");
}

void add_light_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Lights and views");
  keys.add("near_sources", spec.near_sources,
           "CSV with columns x, z: point sources instead of plane waves")
      .only_of("near fields (pairs have plane waves)");
  keys.add("beam_waist", spec.beam_waist,
           "Gaussian beams instead of plane waves: 1/e radius of the field at the focus")
      .positive()
      .unit("length")
      .only_of("beams (give either near_sources or beams; pairs have neither)");
  keys.add("beam_positions", spec.beam_positions,
           "x of the beams' foci, each combined with every light angle (default 0)")
      .unit("length")
      .only_of("beams (beam_waist)");
  keys.add("beam_depth", spec.beam_depth, "z of the beams' foci (default 0)")
      .unit("length")
      .only_of("beams (beam_waist)");
}

void add_request_keys(Keys& keys, SceneSpec& spec) {
  keys.group("Requested entries");
  keys.add("covariance", spec.covariance, "Entries of the covariance to compute")
      .one_of(request_words);
  keys.add("tilts", spec.tilts, "Rotations of the light")
      .angle()
      .only_of("covariance = memory_effect and tilt_shift");
  keys.add("shifts", spec.shifts,
           "tilt_shift: shifts of far views in k sin(view angle), or of near sensors along x; "
           "translation: shifts of the light and the near sensors along x")
      .unit("1/length or length")
      .only_of("covariance = tilt_shift and translation");
  keys.add("pairs", spec.pairs,
           "Angles of each pair, one pair after the other: light 1, view 1, light 2, view 2")
      .each_of(4, "light 1, view 1, light 2, view 2")
      .angle()
      .only_of("covariance = pairs");
}

void add_keys(Keys& keys, SceneSpec& spec) {
  add_medium_keys(keys, spec);
  add_scatterer_keys(keys, spec);
  add_bulk_keys(keys, spec);
  add_structure_key(keys, spec);
  add_profile_keys(keys, spec);
  add_index_keys(keys, spec);
  add_view_keys(keys, spec);
  add_light_keys(keys, spec);
  add_request_keys(keys, spec);
  add_space_keys(keys, spec);
  add_faces_keys(keys, spec);
}

}  // namespace flatspeckle
