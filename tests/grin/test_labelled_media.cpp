#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/media/labels/label_volume.h"
#include "grin/media/scattering/labelled_media.h"
#include "grin/render/pictures/render_datasets.h"
#include "tests/grin/render_tests.h"

// Media of labelled voxels: their files, and light in them against the same media as bodies.

namespace flatspeckle::grin::tests::test_labelled_media {

namespace {

/// A file that is removed at the end of a test.
struct ScratchFile {
  std::filesystem::path path;

  ScratchFile(const std::string& name, const std::string& bytes)
      : path(std::filesystem::temp_directory_path() / ("flatspeckle_labels_" + name)) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  ~ScratchFile() { std::filesystem::remove(path); }
};

template <class Number>
void put(std::string& bytes, std::size_t at, Number number) {
  std::memcpy(&bytes[at], &number, sizeof number);
}

/// Returns a NIfTI-1 file of 2 x 3 x 4 voxels of 0.5 x 1 x 2 mm, whose labels count from 0 in the
/// order of the file.
template <class Number>
std::string nifti(std::int16_t datatype) {
  std::string bytes(352, '\0');
  put(bytes, 0, std::int32_t{348});
  const std::int16_t dim[] = {3, 2, 3, 4, 1, 1, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) put(bytes, 40 + 2 * i, dim[i]);
  put(bytes, 70, datatype);
  const float pixdim[] = {1, 0.5F, 1, 2};
  for (std::size_t i = 0; i < 4; ++i) put(bytes, 76 + 4 * i, pixdim[i]);
  put(bytes, 108, 352.0F);
  bytes.replace(344, 3, "n+1");
  bytes.resize(352 + 24 * sizeof(Number));
  for (std::size_t i = 0; i < 24; ++i) put(bytes, 352 + i * sizeof(Number), static_cast<Number>(i));
  return bytes;
}

/// Returns a message that reading labels gives; empty if it does not fail.
std::string refusal(const std::string& name, const std::string& bytes) {
  const ScratchFile file(name, bytes);
  try {
    read_labels(file.path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string mcx(const std::string& shapes) {
  return R"({"Domain": {"Dim": [4, 4, 6], "LengthUnit": 0.5}, "Shapes": [)" + shapes + "]}";
}
LabelVolume filled(const std::string& shapes) {
  const ScratchFile file("shapes.json", mcx(shapes));
  return read_labels(file.path);
}
/// Returns the number of voxels of a label.
long count(const LabelVolume& volume, int label) {
  return std::count(volume.labels.begin(), volume.labels.end(), label);
}

/// Two layers with a block of a third medium in them, as voxels or as bodies of the same index.
RenderScene layered(bool as_voxels) {
  const ScatteringMedium first{.mu_s = 2, .mu_a = 0.1},
      second{.mu_s = 0.5, .mu_a = 0.3, .phase = {HgPhase{0.6}}}, third{.mu_s = 0, .mu_a = 0.5};
  RenderScene scene{};
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage.boundary = Box{{-2, -2, 0}, {2, 2, 3}};
  scene.lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 0.5}};
  scene.sensors = {AreaDetector{{0, 0, 0}, {0, 1, 0}, 4, 4, {}, 1.5707963},
                   AreaDetector{{0, 0, 3}, {0, 1, 0}, 4, 4, {}, 1.5707963}};
  if (as_voxels) {
    LabelVolume volume{
        {-2, -2, 0}, {0.5, 0.5, 0.5}, {8, 8, 6}, std::vector<std::uint16_t>(8 * 8 * 6)};
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j)
        for (int k = 0; k < 6; ++k)
          volume.labels[volume.number(i, j, k)] =
              i >= 5 && i < 7 && j >= 3 && j < 5 && k >= 1 && k < 5 ? 3
              : k < 2                                               ? 1
                                                                    : 2;
    scene.stage.medium =
        labelled_medium(volume, {0, 0, 0, 2, 0.1, 0, 0.5, 0.3, 0.6, 0, 0.5, 0}, "label_media");
    return scene;
  }
  scene.stage.medium = first;
  scene.stage.bodies = {Body{Box{{-2, -2, 1}, {2, 2, 3}}, second, 0.0, "block"},
                        Body{Box{{0.5, -0.5, 0.5}, {1.5, 0.5, 2.5}}, third, 0.0, "block"}};
  return scene;
}

struct LayerPowers {
  double value[2], error[2];
};
LayerPowers powers(bool as_voxels, RenderMethod method, double samples) {
  const RenderScene scene = layered(as_voxels);
  const RenderJob job = render_job(scene, {method}, 1);
  const auto result = render_result(scene, job, run_render(job, samples).sums);
  LayerPowers found{};
  for (std::size_t i = 0; i < 2; ++i) {
    found.value[i] = result[i].total->value[0].real();
    found.error[i] = result[i].total->error[0];
  }
  return found;
}

}  // namespace

TEST_CASE("labels: files of NIfTI-1, all kinds of whole numbers") {
  const auto check_labels = [](const std::string& bytes) {
    const ScratchFile file("head.nii", bytes);
    const LabelVolume volume = read_labels(file.path);
    CHECK(volume.spacing == Vec3(0.5, 1, 2));
    // x varies fastest in the file
    CHECK(volume.at({0.75, 0.5, 0.5}) == 1);
    CHECK(volume.at({0.25, 1.5, 0.5}) == 2);
    CHECK(volume.at({0.25, 0.5, 2.5}) == 6);
    CHECK(volume.at({0.75, 2.5, 7.5}) == 23);
    for (const Vec3& outside : {Vec3(-0.1, 1, 1), Vec3(1.01, 1, 1), Vec3(0.5, 1, 8.1)})
      CHECK(volume.at(outside) == 0);
  };
  check_labels(nifti<std::uint8_t>(2));
  check_labels(nifti<std::int16_t>(4));
  check_labels(nifti<std::int8_t>(256));
  check_labels(nifti<std::uint16_t>(512));
}

TEST_CASE("labels: files that cannot be read are rejected") {
  const std::string good = nifti<std::uint8_t>(2);
  CHECK(refusal("x.nii", good) == "");
  const auto changed = [&](std::size_t at, auto number) {
    std::string bytes = good;
    put(bytes, at, number);
    return refusal("x.nii", bytes);
  };
  CHECK(changed(70, std::int16_t{16}).find("datatype = 16: must be 2") != std::string::npos);
  CHECK(changed(42, std::int16_t{-1}).find("voxels along an axis = -1") != std::string::npos);
  CHECK(changed(80, 0.0F).find("spacing of voxels = 0") != std::string::npos);
  CHECK(changed(48, std::int16_t{2}) == "");  // dim[0] is 3: the fourth axis does not count
  CHECK(changed(108, 1e9F).find("is shorter than its header") != std::string::npos);
  CHECK(changed(0, std::int32_t{1543569408}).find("little endian") != std::string::npos);
  CHECK(refusal("y.nii", "\x1f\x8b").find("gunzip") != std::string::npos);
  CHECK(refusal("y.nii", "short").find("NIfTI-1") != std::string::npos);
  std::string negative = nifti<std::int16_t>(4);
  put(negative, 352, std::int16_t{-1});
  CHECK(refusal("x.nii", negative).find("label = -1") != std::string::npos);
}

TEST_CASE("labels: shapes of MCX scenes") {
  const std::string grid = R"({"Grid": {"Tag": 1, "Size": [4, 4, 6]}})";
  CHECK(filled(grid).spacing == Vec3::Constant(0.5));
  CHECK(count(filled(grid), 1) == 96);
  const LabelVolume layers = filled(grid + R"(, {"ZLayers": [[1, 2, 3], [6, 6, 4]]})");
  CHECK(count(layers, 3) == 32);
  CHECK(count(layers, 4) == 16);
  CHECK(layers.at({0.1, 0.1, 0.9}) == 3);
  CHECK(layers.at({0.1, 0.1, 1.1}) == 1);
  CHECK(count(filled(grid + R"(, {"XLayers": [2, 3, 5]})"), 5) == 48);
  CHECK(count(filled(grid + R"(, {"Box": {"Tag": 2, "O": [1, 1, 1], "Size": [2, 3, 4]}})"), 2) ==
        24);
  CHECK(count(filled(R"({"Sphere": {"Tag": 1, "O": [2, 2, 3], "R": 1}})"), 1) == 8);
  CHECK(count(filled(R"({"Cylinder": {"Tag": 7, "C0": [2, 2, 0], "C1": [2, 2, 5], "R": 1}})"), 7) ==
        20);
  const auto refused = [](const std::string& shapes) { return refusal("x.json", mcx(shapes)); };
  CHECK(refused(R"({"Pyramid": {}})").find("Shapes[0].Pyramid: has no counterpart") !=
        std::string::npos);
  CHECK(refused(R"({"Origin": [1, 0, 0]})").find("must be [0, 0, 0]") != std::string::npos);
  CHECK(refused(R"({"Sphere": {"Tag": -1, "O": [0, 0, 0], "R": 1}})").find("Tag = -1") !=
        std::string::npos);
  CHECK(refused(R"({"Sphere": {"Tag": 1, "O": [0, 0], "R": 1}})").find("3 numbers") !=
        std::string::npos);
  CHECK(refused("").find("Shapes: is missing") != std::string::npos);
  CHECK(refusal("x.json", "[").find("one JSON object") != std::string::npos);
}

TEST_CASE("labelled media: means, extremes, and invalid media") {
  const LabelVolume volume{Vec3::Zero(), Vec3::Ones(), {2, 1, 1}, {0, 1}};
  const ScatteringMedium medium = labelled_medium(volume, {1, 0, 0.5, 3, 1, 0}, "label_media");
  CHECK(medium.mu_s == 2);
  CHECK(medium.mu_a == 0.5);
  CHECK(medium.phase.mean_cosine() == doctest::Approx(0.125));
  CHECK(medium.largest_relative() == doctest::Approx(4 / 2.5));
  CHECK(medium.relative({1.5, 0.5, 0.5}) == doctest::Approx(4 / 2.5));
  CHECK(medium.absorption({0.5, 0.5, 0.5}) == 0);
  CHECK(medium.at({5, 5, 5}).mu_s == 1);  // label 0 outside
  // g = 1: light goes on as if it were not scattered
  CHECK(labelled_medium(volume, {5, 0, 1, 3, 1, 0}, "label_media").mu_s == 1.5);
  CHECK_THROWS_AS(labelled_medium(volume, {1, 0, 0.5}, "label_media"), InputError);
  CHECK_THROWS_AS(labelled_medium(volume, {1, 0, 0.5, -3, 1, 0}, "label_media"), InputError);
  CHECK_THROWS_AS(labelled_medium(volume, {1, 0, 0.5, 3, 1, 1.1}, "label_media"), InputError);
  CHECK_THROWS_AS(labelled_medium(volume, {0, 0, 0, 0, 0, 0}, "label_media"), InputError);
}

TEST_CASE("labelled media: all methods agree with the same media as bodies") {
  const LayerPowers bodies = powers(false, RenderMethod::forward, 50'000);
  for (const RenderMethod method : {RenderMethod::forward, RenderMethod::light, RenderMethod::path,
                                    RenderMethod::bidirectional}) {
    CAPTURE(name(method));
    const double samples = method == RenderMethod::forward ? 50'000 : 10'000;
    const LayerPowers voxels = powers(true, method, samples);
    for (std::size_t i = 0; i < 2; ++i) {
      CAPTURE(i);
      CAPTURE(bodies.value[i]);
      CAPTURE(voxels.value[i]);
      CAPTURE(voxels.error[i]);
      CHECK(std::abs(voxels.value[i] - bodies.value[i]) <
            4 * std::hypot(voxels.error[i], bodies.error[i]));
      CHECK(voxels.error[i] < 0.1 * voxels.value[i]);
    }
  }
}

}  // namespace flatspeckle::grin::tests::test_labelled_media
