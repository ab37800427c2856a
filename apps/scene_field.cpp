#include "apps/scene_field.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "apps/key_values.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "grin/media/field_file.h"

namespace flatspeckle::apps {

namespace {

using grin::Vec3;

void require_text(const std::string& key, const std::string& value, const std::string& what) {
  if (value.empty()) throw InputError(key + " is not given: " + what);
}

/// One kind after the other, with the excess that it stands on.
class Builder {
 public:
  Builder(const Subcommand& command, const IndexFieldSpec& spec, double reach)
      : command_(command), spec_(spec), reach_(reach) {}

  SceneField build() {
    const std::string medium = medium_of(command_, spec_);
    if (spec_.kinds.size() == 1) {
      make(spec_.kinds.front(), background(1),
           [&](auto field) { scene_.field = std::move(field); });
      return scene_;
    }
    grin::AnySum sum, outside;
    const auto add = [&](auto field) {
      if constexpr (!std::same_as<decltype(field), grin::Luneburg>) outside.add(field);
      sum.add(std::move(field));
    };
    if (medium.empty()) add(grin::Homogeneous{background(1)});
    for (const auto& kind : spec_.kinds) make(kind, kind == medium ? background(1) : 0, add);
    scene_.field = std::move(sum);
    scene_.outside = std::move(outside);
    scene_.symmetry = Symmetry::none;
    return scene_;
  }

 private:
  double background(double usual) const {
    return positive("index", spec_.index.value_or(usual)) - 1;
  }
  Vec3 centre() const { return vector_of("centre", spec_.centre); }
  double number(const std::string& key, double value) const {
    if (!command_.given(key)) throw InputError(key + " is not given: the field needs it");
    if (!std::isfinite(value)) throw InputError(key, value, "must be finite");
    return value;
  }

  void vary(double scale, Symmetry symmetry) {
    scene_.scale = scene_.scale > 0 ? std::min(scene_.scale, scale) : scale;
    scene_.symmetry = symmetry;
  }

  template <class Use>
  void make(const std::string& kind, double excess, const Use& use) {
    if (kind == "homogeneous")
      use(grin::Homogeneous{excess});
    else if (kind == "luneburg")
      use(luneburg());
    else if (kind == "fisheye")
      use(fisheye());
    else if (kind == "parabolic")
      use(grin::ParabolicGuide({excess, guide()}, centre()));
    else if (kind == "sech")
      use(grin::SechGuide({excess, guide()}, centre()));
    else if (kind == "linear")
      use(linear(excess));
    else if (kind == "tanh")
      use(tanh());
    else if (kind == "blobs")
      use(blobs(excess));
    else if (kind == "ultrasound")
      use(ultrasound(excess));
    else if (kind == "focused_sound")
      use(focused_sound(excess));
    else
      use(grid());
  }

  grin::Luneburg luneburg() {
    const double radius = positive("radius", spec_.radius);
    vary(radius, Symmetry::sphere);
    scene_.centre = centre();
    scene_.rim = grin::Sphere{centre(), radius};
    constexpr double beyond = 0.4;  // for steps that reach past the rim
    return grin::Luneburg({radius, beyond}, centre());
  }

  grin::Fisheye fisheye() {
    const double radius = positive("radius", spec_.radius);
    vary(radius, Symmetry::sphere);
    scene_.centre = centre();
    return grin::Fisheye({background(2), radius}, centre());
  }

  double guide() {
    const double alpha = positive("alpha", number("alpha", spec_.alpha));
    vary(1 / alpha, Symmetry::round_guide);
    scene_.centre = centre();
    return alpha;
  }

  grin::LinearRamp linear(double excess) {
    const Vec3 slope = vector_of("slope", spec_.slope);
    if (slope.norm() > 0) {
      vary(1 / slope.norm(), Symmetry::stratified);
      scene_.axis = slope.normalized();
    }
    return {excess, slope};
  }

  grin::TanhRamp tanh() {
    const double low = positive("index_low", number("index_low", spec_.index_low));
    const double high = positive("index_high", number("index_high", spec_.index_high));
    const double width = positive("ramp_width", spec_.ramp_width);
    const bool alone = spec_.kinds.size() == 1;
    vary(width / 2, Symmetry::stratified);
    scene_.axis = direction_of("ramp_axis", spec_.ramp_axis);
    const double below = alone ? 0 : low - 1;  // in a sum the ramp is what it adds
    return {low - 1 - below, high - 1 - below, width, scene_.axis, centre()};
  }

  grin::GaussianBlobs blobs(double excess) {
    require_text("blobs", spec_.blobs, "a CSV file with columns x, y, z, height, width");
    const Table table = read_csv(spec_.blobs);
    if (table.rows() == 0) throw InputError("blobs", spec_.blobs, "holds no blobs");
    const auto x = table.column("x"), y = table.column("y"), z = table.column("z");
    const auto height = table.column("height"), width = table.column("width");
    std::vector<grin::GaussianBlob> blobs;
    for (std::size_t i = 0; i < table.rows(); ++i) {
      vary(positive(spec_.blobs + ", width", width[i]), Symmetry::none);
      blobs.push_back({{x[i], y[i], z[i]}, height[i], width[i]});
    }
    return grin::GaussianBlobs(std::move(blobs), excess);
  }

  double sound_wavenumber() const {
    return positive("sound_wavenumber", number("sound_wavenumber", spec_.sound_wavenumber));
  }
  double amplitude() const { return number("amplitude", spec_.amplitude); }
  double sound_phase() const { return finite("sound_phase", {spec_.sound_phase}).front(); }

  grin::StandingWave ultrasound(double excess) {
    const double k = sound_wavenumber();
    vary(1 / k, spec_.sound_order == 0 ? Symmetry::round_guide : Symmetry::guide);
    constexpr auto most = grin::BesselProfile::max_order;
    if (spec_.sound_order < 0 || spec_.sound_order > most)
      throw InputError("sound_order", spec_.sound_order,
                       "must be from 0 to " + std::to_string(most));
    constexpr double longest_table = 1e3;  // in k rho; beyond it the wave is slow, not wrong
    return grin::StandingWave(excess, amplitude(), static_cast<int>(spec_.sound_order), k,
                              std::min(reach_, longest_table / k))
        .frozen(std::cos(sound_phase()));
  }

  std::vector<Vec3> emitters() const {
    if (spec_.emitters < 1 || spec_.emitters > 100'000)
      throw InputError("emitters", spec_.emitters, "must be from 1 to 100000");
    if (!(spec_.aperture > 0 && spec_.aperture <= std::numbers::pi))
      throw InputError("aperture", spec_.aperture, "must be a half angle in (0, pi]");
    const auto count = static_cast<int>(spec_.emitters);
    if (spec_.focusing == "arc") return grin::arc_directions(count, spec_.aperture);
    if (spec_.focusing == "cone") return grin::cap_directions(count, spec_.aperture);
    throw InputError("focusing", spec_.focusing, "must be cone (on a point) or arc (on a line)");
  }

  grin::FocusedSound focused_sound(double excess) {
    const double k = sound_wavenumber();
    vary(1 / k, Symmetry::none);
    return {excess, amplitude(), k, emitters(), centre(), sound_phase()};
  }

  grin::SplineField grid() {
    require_text("grid", spec_.grid, "an HDF5 file with dataset excess, n - 1 on a grid");
    if (!std::filesystem::exists(spec_.grid)) throw InputError("grid", spec_.grid, "no such file");
    grin::SplineField field = [&] {
      try {
        return grin::read_spline_field(spec_.grid);
      } catch (const InputError& error) {
        throw InputError(std::string("grid: ") + error.what());
      }
    }();
    vary(2 * field.grid().spacing.minCoeff(), Symmetry::none);
    scene_.grid = grin::Box{field.grid().origin, field.grid().end()};
    return field;
  }

  const Subcommand& command_;
  const IndexFieldSpec& spec_;
  double reach_;
  SceneField scene_{
      grin::Homogeneous{}, 0, Symmetry::none, Vec3::Zero(), Vec3::UnitZ(), {}, {}, {}};
};

}  // namespace

SceneField make_index_field(const Subcommand& command, const IndexFieldSpec& spec, double reach) {
  return Builder(command, spec, reach).build();
}

double index_at(const SceneField& scene, const Vec3& x) {
  if (scene.grid && scene.grid->distance(x) > 0) return 0;
  const auto at = [&](const auto& field) { return index(field, x); };
  const bool is_outside = scene.rim && scene.rim->distance(x) > 0;
  const double n = is_outside ? std::visit(at, scene.outside) : std::visit(at, scene.field);
  return n > 0 && std::isfinite(n) ? n : 0;
}

}  // namespace flatspeckle::apps
