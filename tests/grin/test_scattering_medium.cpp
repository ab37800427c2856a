#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <unistd.h>

#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "core/error.h"
#include "core/result/result_file.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/scattering/scattering_medium.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/stage/part_medium.h"
#include "grin/render/stage/stage.h"
#include "tests/grin/space_stages.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_scattering_medium {

namespace {

using std::numbers::pi;
/// A temporary file with the lifetime of the object.
class TableFile {
 public:
  explicit TableFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("flatspeckle-phase-" + std::to_string(::getpid()) + ".csv")) {
    std::ofstream(path_) << text;
  }
  ~TableFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TablePhase table_phase(const std::string& text) {
  return TablePhase(AngleTable("phase_table", TableFile(text).path()));
}

/// Returns a table of Henyey-Greenstein, denser near the forward peak.
std::string table_text(double g, int intervals) {
  std::ostringstream text;
  text.precision(17);
  text << "angle,value\n";
  for (int i = 0; i <= intervals; ++i) {
    const double angle = pi * std::pow(1.0 * i / intervals, 2);
    text << angle << ',' << 7 * HenyeyGreenstein<3>{g}.density(angle) << '\n';
  }
  return text.str();
}

const char* const coarse = "angle,value\n0,30\n0.4,10\n1,0\n1.3,0\n2.2,5\n3.14159,1\n";

const SpacePhaseFunction phases[] = {
    {},
    {RayleighPhase{}},
    {HgPhase{0}},
    {HgPhase{0.85}},
    {HgPhase{-0.6}},
    {HgPhase{0.99}},
    {TwoTermPhase{{0.9}, {-0.4}, 0.8}},
    {TwoTermPhase{{0.7}, {0.1}, 0}},
    {MiePhase(MieSphere(0.1, 1.5))},
    {MiePhase(MieSphere(6, {1.33, 0.01}))},
    {table_phase("angle,value\n0,1\n3.14159,0\n")},
    {table_phase(coarse)},
    {table_phase(table_text(0.9, 300))},
};
const Vec3 axes[] = {Vec3::UnitZ(), -Vec3::UnitZ(), Vec3(0.6, 0, -0.8), Vec3(-2, 3, 1).normalized(),
                     Vec3(0.8, -0.6, 0)};

/// Returns an edge of the bins in the angle, finer towards 0 for forward phase functions.
double angle_at(double t, double g) {
  return g > 0.9 ? 0.02 * (std::pow(pi / 0.02 + 1, t) - 1) : pi * t;
}

}  // namespace

TEST_CASE("phase functions: normalised, mean cosines agree with g") {
  for (const SpacePhaseFunction& phase : phases) {
    const auto moment = [&](int power) {
      return flatspeckle::tests::integral(
          [&](double t) {
            const double c = std::cos(t);
            return 2 * pi * phase.density(c) * std::pow(c, power) * std::sin(t);
          },
          0, pi);
    };
    CHECK(moment(0) == doctest::Approx(1).epsilon(1e-9));
    CHECK(moment(1) == doctest::Approx(phase.mean_cosine()).epsilon(1e-8));
  }
}

TEST_CASE("scattered directions: angles and azimuths agree with the phase function") {
  std::uint64_t seed = 0;
  const int polar = 25, azimuths = 8, samples = flatspeckle::tests::is_night ? 200000 : 50000;
  for (const SpacePhaseFunction& phase : phases) {
    const Vec3 axis = axes[seed % std::size(axes)];
    const Frame across = frame_across(axis);
    std::vector<double> edges, counts(polar * azimuths), probabilities;
    for (int i = 0; i <= polar; ++i)
      edges.push_back(angle_at(1.0 * i / polar, phase.mean_cosine()));
    RandomStream random(++seed, 81, 0);
    for (int i = 0; i < samples; ++i) {
      const Vec3 d = phase.sample(axis, random);
      REQUIRE(d.squaredNorm() == doctest::Approx(1).epsilon(1e-14));
      const Eigen::Vector2d part = across.transpose() * d;
      const double angle = std::atan2(part.norm(), d.dot(axis));
      const auto bin =
          std::upper_bound(edges.begin() + 1, edges.end() - 1, angle) - edges.begin() - 1;
      const double turn = (std::atan2(part[1], part[0]) / pi + 1) / 2;
      ++counts[bin * azimuths + std::min(azimuths - 1, static_cast<int>(turn * azimuths))];
    }
    const auto ring = [&](double t) { return 2 * pi * phase.density(std::cos(t)) * std::sin(t); };
    for (int i = 0; i < polar; ++i)
      for (int k = 0; k < azimuths; ++k)
        probabilities.push_back(flatspeckle::tests::integral(ring, edges[i], edges[i + 1]) /
                                azimuths);
    flatspeckle::tests::check_chi_square(counts, probabilities);
  }
}

TEST_CASE("two-term phase function: equal terms and weights 0 and 1 agree with henyey_greenstein") {
  const HgPhase hg{0.6};
  for (const TwoTermPhase& phase : {TwoTermPhase{{0.6}, {-0.3}, 1}, TwoTermPhase{{0.2}, {0.6}, 0},
                                    TwoTermPhase{{0.6}, {0.6}, 0.4}})
    for (const double cosine : {-1.0, -0.3, 0.2, 0.95, 1.0})
      CHECK(phase.density(cosine) == doctest::Approx(hg.density(cosine)).epsilon(1e-14));
}

TEST_CASE("table of henyey_greenstein: agrees with it, in any unit") {
  const HgPhase hg{0.8};
  const TablePhase table = table_phase(table_text(hg.g, 2000));
  CHECK(table.mean_cosine() == doctest::Approx(hg.g).epsilon(1e-5));
  for (const double cosine : {-1.0, -0.3, 0.2, 0.95, 0.999, 1.0})
    CHECK(table.density(cosine) == doctest::Approx(hg.density(cosine)).epsilon(1e-5));
}

TEST_CASE("phase tables: invalid ones are rejected by their key") {
  const auto refusal = [](const std::string& text) {
    const TableFile file(text);
    Keys keys;
    MediumValues values{.mu_s = 1, .phase = TablePhaseValues::word};
    add_keys(keys, values, "body_");
    values.of<TablePhaseValues>().phase_table = file.path();
    try {
      make_medium(keys, values);
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  CHECK(refusal(coarse).empty());
  for (const char* text :
       {"", "angle,size\n0,1\n3.1416,1\n", "angle,value\n0,1\nx,1\n", "angle,value\n0,1\n3,1\n",
        "angle,value\n0,1\n2,1\n1,2\n3.1416,1\n", "angle,value\n0,1\n3.1416,-1\n",
        "angle,value\n0,0\n3.1416,0\n", "angle,value\n0,1e200\n3.1416,1\n"}) {
    CHECK(refusal(text).starts_with("body_phase_table"));
    CHECK(refusal(text).find('\n') == std::string::npos);
  }
}

TEST_CASE("scattered directions: length 1 over long walks, also near the poles of the frame") {
  const SpacePhaseFunction phase{HgPhase{0.999}};
  for (Vec3 d : axes) {
    RandomStream random(1, 82, 0);
    for (int i = 0; i < 20000; ++i) d = phase.sample(d, random);
    CHECK(std::abs(d.norm() - 1) < 1e-14);
  }
}

TEST_CASE("density grid: trilinear, 0 outside, invalid grids are rejected") {
  const FieldGrid grid{Vec3(1, 2, 3), Vec3(0.5, 0.25, 1), {3, 4, 2}};
  const auto affine = [](const Vec3& x) { return 1 + 0.3 * x[0] + 2 * x[1] * x[2]; };
  std::vector<double> values;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 2; ++k)
        values.push_back(affine(grid.origin + Vec3(i, j, k).cwiseProduct(grid.spacing)));
  const DensityGrid density(grid, values);
  for (const Vec3& x : {Vec3(1, 2, 3), Vec3(1.3, 2.6, 3.9), Vec3(2, 2.75, 4), Vec3(1.5, 2.25, 3.5)})
    CHECK(density(x) == doctest::Approx(affine(x)).epsilon(1e-13));
  CHECK(density(Vec3(0.999, 2.5, 3.5)) == 0);
  CHECK(density(Vec3(1.5, 2.751, 3.5)) == 0);
  CHECK(density.largest() == *std::max_element(values.begin(), values.end()));
  std::vector<double> bad = values;
  bad[3] = -1e-9;
  CHECK_THROWS_AS(DensityGrid(grid, bad), InputError);
  bad[3] = std::nan("");
  CHECK_THROWS_AS(DensityGrid(grid, bad), InputError);
  bad.pop_back();
  CHECK_THROWS_AS(DensityGrid(grid, bad), InputError);
  CHECK_THROWS_AS(DensityGrid({grid.origin, grid.spacing, {1, 4, 2}}, std::vector<double>(8)),
                  InputError);
}

TEST_CASE("density grid from a file: agrees with the grid, errors name the file") {
  const auto path = std::filesystem::temp_directory_path() /
                    ("flatspeckle-density-" + std::to_string(::getpid()) + ".h5");
  const FieldGrid grid{Vec3(-1, 2, 0.5), Vec3(0.3, 0.2, 0.1), {2, 3, 4}};
  std::vector<double> values(grid.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sqrt(static_cast<double>(i));
  const auto write = [&] {
    ResultFile file(path);
    file.dataset("density", values, {std::size_t{2}, std::size_t{3}, std::size_t{4}}, "1", "");
    file.attribute("density", "origin", std::vector<double>{-1, 2, 0.5});
    file.attribute("density", "spacing", std::vector<double>{0.3, 0.2, 0.1});
    file.commit();
  };
  write();
  const Vec3 x(-0.8, 2.33, 0.71);
  CHECK(read_density_grid(path)(x) == DensityGrid(grid, values)(x));
  CHECK(read_density_grid(path)(x) > 1);
  CHECK_THROWS_AS(read_spline_field(path), InputError);
  values[7] = -2;
  write();
  try {
    read_density_grid(path);
    FAIL("accepted a negative density");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find(path.string()) != std::string::npos);
    CHECK(std::string(error.what()).find("-2") != std::string::npos);
  }
  std::filesystem::remove(path);
}

TEST_CASE("stages: invalid ones are rejected") {
  const auto refuses = [](Stage stage, const std::string& word) {
    try {
      check(stage);
      FAIL("accepted: " << word);
    } catch (const InputError& error) {
      CHECK(std::string(error.what()).find(word) != std::string::npos);
    }
  };
  const Stage good{.boundary = Box{{-1, -1, -1}, {1, 1, 1}}, .bodies = {Body{Sphere{}}}};
  check(good);
  Stage bad = good;
  bad.boundary = Plane{{0, 0, 1}, Vec3::UnitZ()};
  refuses(bad, "closed");
  bad = good;
  bad.bodies[0].surface = Sphere{{0.1, 0, 0}, 1};
  refuses(bad, "inside of the stage");
  bad = good;
  bad.boundary = Sphere{Vec3::Zero(), 1.7};
  bad.bodies[0].surface = Box{{-1, -1, -1}, {1, 1, 1}};
  refuses(bad, "inside of the stage");
}

}  // namespace flatspeckle::grin::test_scattering_medium
