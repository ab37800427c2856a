#include "grin/render/values/mcx_scene.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "grin/media/labels/mcx_object.h"
#include "grin/media/labels/mcx_shapes.h"

namespace flatspeckle::grin {

namespace {

/// Translates the parts of an MCX scene one after another.
class McxScene {
 public:
  explicit McxScene(const std::filesystem::path& path)
      : path_(path),
        root_(read_mcx(path), ""),
        session_(root_.object("Session")),
        domain_(root_.object("Domain")),
        volume_(read_mcx_shapes(path)),
        reflects_(session_.is_set("DoMismatch")) {
    root_.refuse_others({"Session", "Forward", "Optode", "Domain", "Shapes", "Help"});
    domain_.refuse_others({"Dim", "OriginType", "LengthUnit", "Media", "MediaFormat", "Step",
                           "CacheBoxP0", "CacheBoxP1"});
    if (const auto step = domain_.numbers("Step", 3, 3);
        !step.empty() && step != std::vector<double>{1, 1, 1})
      domain_.refuse("Step", "must be [1, 1, 1]; use LengthUnit");
  }

  std::vector<McxKey> keys() {
    take_session();
    take_media();
    take_source();
    take_detectors();
    take_times();
    take_map();
    return std::move(keys_);
  }

 private:
  void add(const std::string& key, const std::vector<double>& numbers) {
    std::vector<std::string> texts;
    for (const double number : numbers) texts.push_back(number_text(number));
    keys_.push_back({key, texts});
  }
  void add_text(const std::string& key, const std::string& text) { keys_.push_back({key, {text}}); }

  void take_session() {
    session_.refuse_others({"ID", "Photons", "RNGSeed", "DoMismatch", "DoSpecular", "DoAutoThread",
                            "DoSaveVolume", "DoNormalize", "DoPartialPath", "DoSaveRef",
                            "DoSaveExit", "DoSaveSeed", "DoDCS", "DebugFlag", "SaveDataMask",
                            "OutputFormat", "OutputType"});
    add_text("length_unit", "1mm");
    if (session_.has("Photons")) add("samples", {session_.number("Photons")});
    if (session_.number("RNGSeed", -1) >= 0) add("seed", {session_.number("RNGSeed")});
  }

  /// Takes the media of the labels. Their index must be the same, since surfaces of voxels are not
  /// those of the bodies that they approximate.
  void take_media() {
    const std::set<int> used(volume_.labels.begin(), volume_.labels.end());
    std::vector<double> numbers;
    const auto media = domain_.objects("Media");
    for (std::size_t label = 0; label < media.size(); ++label) {
      media[label].refuse_others({"mua", "mus", "g", "n"});
      for (const char* key : {"mus", "mua", "g"}) numbers.push_back(media[label].number(key));
      const double index = media[label].number("n");
      if (label == 0) outside_ = index;
      const bool fills = used.contains(static_cast<int>(label)) && (label > 0 || reflects_);
      if (!fills) continue;
      if (index_ && *index_ != index)
        media[label].refuse("n", "must be the same in all voxels: " + number_text(*index_) +
                                     "; make bodies of other indices by block, ball or mesh");
      index_ = index;
    }
    if (!index_) index_ = outside_;
    refracts_ = reflects_ && *index_ != outside_;
    const std::string prefix = refracts_ ? "body_" : "";
    gap_ = refracts_ ? 1e-6 * (volume_.end() - volume_.origin).maxCoeff() : 0;
    const Vec3 low = volume_.origin, high = volume_.end();
    const auto box_beyond = [&](double gap) {
      return std::vector<double>{low[0] - gap,  low[1] - gap,  low[2] - gap,
                                 high[0] + gap, high[1] + gap, high[2] + gap};
    };
    add("stage_box", box_beyond(gap_));
    add("index", {*index_});
    if (refracts_) {
      add("body_box", box_beyond(0));
      add("index_around", {outside_});
    }
    add_text(prefix + "labels", path_.string());
    add(prefix + "label_media", numbers);
  }

  /// Returns a point given in voxels, which are numbered from 0 or from 1.
  Vec3 place_of(const McxObject& object, const std::string& key) const {
    const auto numbers = object.required(key, 3);
    const double first = domain_.is_set("OriginType") ? 0 : 1;
    return volume_.spacing[0] * (Vec3(numbers[0], numbers[1], numbers[2]) - Vec3::Constant(first));
  }

  void take_source() {
    const McxObject optode = root_.object("Optode"), source = optode.object("Source");
    optode.refuse_others({"Source", "Detector"});
    source.refuse_others({"Type", "Pos", "Dir", "Param1", "Param2", "SrcNum"});
    if (source.number("SrcNum", 1) != 1) source.refuse("SrcNum", "must be 1");
    const std::string type = source.text("Type", "pencil");
    const Vec3 place = place_of(source, "Pos");
    if (type == "isotropic") return add("point_light", {place[0], place[1], place[2], 1});
    const auto direction = source.numbers("Dir", 3, 4);
    if (direction.empty()) source.refuse("Dir", "must be a list of 3 numbers");
    if (direction.size() > 3 && direction[3] != 0)
      source.refuse("Dir", "must have the focal length 0");
    const Vec3 along = Vec3(direction[0], direction[1], direction[2]).normalized();
    const auto parameters = source.numbers("Param1", 4, 4);
    const double given = parameters.empty() ? 0 : volume_.spacing[0] * parameters[0];
    constexpr double thin = 1e-6;  // radius of a pencil beam, in voxels
    if (type != "pencil" && type != "disk" && type != "gaussian")
      source.refuse("Type", "must be pencil, isotropic, disk or gaussian");
    if (type != "pencil" && !(given > 0)) source.refuse("Param1", "must begin with a radius");
    const double radius = type == "pencil" ? thin * volume_.spacing[0] : given;
    if (type == "disk" && parameters[1] != 0) source.refuse("Param1", "must have one radius");
    // a tilted disk in a face would reach out of the volume
    const Vec3 start = type == "pencil" ? Vec3(place + radius * along) : place;
    add(type == "gaussian" ? "gaussian_beam" : "beam_light",
        {start[0], start[1], start[2], along[0], along[1], along[2], radius, 1});
  }

  void take_detectors() {
    std::vector<double> places, radii;
    for (const McxObject& detector : root_.object("Optode").objects("Detector")) {
      detector.refuse_others({"Pos", "R"});
      const Vec3 on_face = moved_to_stage(detector, place_of(detector, "Pos"));
      places.insert(places.end(), on_face.begin(), on_face.end());
      radii.push_back(volume_.spacing[0] * detector.number("R"));
    }
    if (radii.empty()) return add_text("sensor", "none");
    keys_.push_back({"sensor", std::vector<std::string>(radii.size(), "radial")});
    add("sensor_at", places);
    add("sensor_radius", radii);
    add("rings", {1});
    add_text("method", "forward");
  }
  /// Returns the point of the stage's boundary beside a place on a face of the volume.
  Vec3 moved_to_stage(const McxObject& detector, Vec3 place) const {
    const Vec3 low = volume_.origin, high = volume_.end();
    for (int axis = 0; axis < 3; ++axis) {
      const double close = 1e-9 * (high[axis] - low[axis]);
      const bool is_low = std::abs(place[axis] - low[axis]) <= close;
      if (!is_low && std::abs(place[axis] - high[axis]) > close) continue;
      place[axis] = is_low ? low[axis] - gap_ : high[axis] + gap_;
      return place;
    }
    detector.refuse("Pos", "must be on a face of the volume");
  }

  void take_times() {
    const McxObject forward = root_.object("Forward");
    forward.refuse_others({"T0", "T1", "Dt"});
    if (!forward.has("T1")) return;
    constexpr double speed = 299'792'458'000;  // of light, in mm/s
    const double first = forward.number("T0", 0), last = forward.number("T1");
    const double count = std::round((last - first) / forward.number("Dt", last - first));
    if (count > 1) add("path_bins", {speed * first, speed * last, count});
  }

  /// Maps the fluence in all voxels, if they are not too many.
  void take_map() {
    constexpr double most = 1 << 21;
    const auto [nx, ny, nz] = volume_.voxels;
    if (static_cast<double>(nx) * ny * nz > most) return;
    const Vec3 low = volume_.origin, high = volume_.end();
    add("map_box", {low[0], low[1], low[2], high[0], high[1], high[2]});
    add("map_cells", {static_cast<double>(nx), static_cast<double>(ny), static_cast<double>(nz)});
  }

  std::filesystem::path path_;
  McxObject root_, session_, domain_;
  LabelVolume volume_;
  bool reflects_, refracts_ = false;
  double outside_ = 1, gap_ = 0;
  std::optional<double> index_ = {};
  std::vector<McxKey> keys_;
};

}  // namespace

std::vector<McxKey> mcx_keys(const std::filesystem::path& path) {
  return McxScene(path).keys();
}

}  // namespace flatspeckle::grin
