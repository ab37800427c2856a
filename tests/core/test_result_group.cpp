#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/result/collected_result.h"
#include "core/result/provenance.h"
#include "core/result/result_group.h"
#include "core/result/result_reader.h"

namespace flatspeckle::test_result_group {

namespace fs = std::filesystem;

namespace {

const DatasetTable table{
    .name = "test",
    .rows = {{"tilt", Data::scale, "", "rad", "rotation of the light"},
             {"sensor", Data::numbers, "", "1", "number of the sensor"},
             {"covariance", Data::complex_estimate, "tilt VIEW", "COVARIANCE", "covariance"},
             {"intensity", Data::estimate, "VIEW", "COVARIANCE", "variance of the field"},
             {"trace/row", Data::numbers, "", "1", "number of the row"},
             {"trace/count", Data::count, "trace/row", "1", "counts"},
             {"method", Data::text, "VIEW", "", "what estimates"},
             {"range", Data::real, "", "1", "a scalar"},
             {"sums", Data::complex, "PLAIN", "", "sums"},
             {"invariants/power", Data::invariant, "VIEW", "1", "imbalance"}},
    .attributes = {{"", "depth", "float64", "of the medium"},
                   {"range", "censored", "uint64", "0: read off"}}};

const std::vector<double> tilts{0, 0.1}, two{0.5, 2}, errors{0.1, 0.2, 0.3, 0.4};
const std::vector<Complex> four{{1, 1}, {2, 2}, {3, 3}, {4, 4}};
const std::vector<std::uint64_t> counts{7, 8};
const Estimate estimate{{{1, 5}, {2, 5}}, {0.1, 0.2}};

/// A file in a temporary folder, with the roles bound and both axes.
struct Written {
  Written() : file(path()), root(file, table), mc(file, table, "mc") {
    file.bind("VIEW", {"sensor"});
    file.bind("COVARIANCE", {"length"});
    file.bind("PLAIN", {std::size_t{2}, std::size_t{2}});
    root.put("tilt", tilts);
    root.number("sensor", 2);
  }
  ~Written() { fs::remove_all(folder); }
  Written(const Written&) = delete;
  Written& operator=(const Written&) = delete;

  fs::path path() {
    std::string pattern = (fs::temp_directory_path() / "flatspeckle-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    folder = pattern;
    return folder / "a.h5";
  }

  fs::path folder;
  ResultFile file;
  ResultGroup root, mc;
};

}  // namespace

TEST_CASE("result group: schema entries define axes, units, names and error datasets") {
  Written out;
  out.mc.put("covariance", four, errors);
  out.mc.put("intensity", estimate);
  out.mc.number("trace/row", 2);
  out.mc.put("trace/count", counts);
  out.root.put("method", std::vector<std::string>{"one", "two"});
  out.root.put("range", 1.5);
  out.root.put("sums", four);
  out.root.attribute("depth", 3.0);
  out.root.attribute("range", "censored", std::uint64_t{1});
  out.file.commit();

  const ResultReader file(out.folder / "a.h5");
  CHECK(file.dataset<Complex>("mc/covariance") == four);
  CHECK(file.attribute<std::string>("mc/covariance_error", "units") == "length");
  CHECK(file.attribute<std::string>("mc/covariance_error", "long_name") ==
        "standard error: covariance");
  CHECK(file.dataset<double>("mc/intensity") == std::vector<double>{1, 2});
  CHECK(file.dataset<double>("mc/intensity_error") == estimate.error);
  CHECK(file.dataset<double>("mc/trace/row") == std::vector<double>{0, 1});
  CHECK(file.attribute<std::string>("sensor", "units") == "1");
  CHECK(file.dataset<double>("range") == std::vector<double>{1.5});
  CHECK(file.shape("sums") == std::vector<std::size_t>{2, 2});
  CHECK_FALSE(file.has_attribute("sums", "units"));
  CHECK(file.attribute<double>("/", "depth") == 3);
  CHECK(file.attribute<std::uint64_t>("range", "censored") == 1);
}

TEST_CASE("result group: unknown names and wrong shapes are rejected") {
  const Written out;
  CHECK_THROWS_WITH_AS(out.root.put("albedo", 1.0), "albedo: no row for it in test",
                       std::logic_error);
  CHECK_THROWS_AS(out.root.put("intensity", estimate.error), std::logic_error);  // no errors
  CHECK_THROWS_AS(out.root.put("tilt", tilts, tilts), std::logic_error);         // errors
  CHECK_THROWS_AS(out.root.put("range", four), std::logic_error);
  CHECK_THROWS_AS(out.root.put("range", two), std::logic_error);
  CHECK_THROWS_AS(out.root.put("covariance", four, two), std::logic_error);
  CHECK_THROWS_AS(out.root.put("trace/count", counts), std::logic_error);  // no such axis
  CHECK_THROWS_AS(out.root.number("range", 2), std::logic_error);
  CHECK_THROWS_AS(out.root.attribute("width", 1.0), std::logic_error);
  CHECK_THROWS_AS(out.root.attribute("depth", std::uint64_t{1}), std::logic_error);
}

TEST_CASE("result group: values that are not finite are omitted and listed") {
  Written out;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  out.root.put("intensity", two, std::vector<double>{0.1, HUGE_VAL});
  out.root.put("range", nan);
  out.root.attribute("range", "censored", std::uint64_t{1});
  out.root.attribute("depth", nan);
  const std::vector<std::string> names{"intensity_error", "range", "@depth"};
  CHECK(out.file.undefined() == names);
  Provenance made;
  made.converged = true;
  write_provenance(out.file, made);
  out.file.commit();
  const ResultReader file(out.folder / "a.h5");
  CHECK(file.dataset<double>("intensity") == two);
  for (const char* name : {"intensity_error", "range"}) CHECK_FALSE(file.has(name));
  CHECK_FALSE(file.has_attribute("/", "depth"));
  CHECK_FALSE(file.attribute<bool>("/", "converged"));
  CHECK(file.has_attribute("/", "undefined"));
}

TEST_CASE("result group: an unbound role is rejected") {
  Written out;
  ResultFile other(out.folder / "b.h5");
  const ResultGroup root(other, table);
  other.bind("COVARIANCE", {"length"});
  root.put("tilt", tilts);
  CHECK_THROWS_WITH_AS(root.put("intensity", estimate), "VIEW: this role is not bound",
                       std::logic_error);
}

TEST_CASE("result group: invariants are written with their limits, the worst is reported") {
  Written out;
  const std::vector<Invariant> kept{{0.5, 1}, {0, 0}}, broken{{2, 4}, {0.2, 0.1}};
  out.root.check("invariants/power", kept);
  CHECK(out.file.keeps_invariants());
  out.mc.check("invariants/power", broken);
  CHECK(!out.file.keeps_invariants());
  CHECK(out.file.invariants().at(1).first == "mc/invariants/power");
  CHECK(out.file.invariants().at(1).second.off == 0.2);
  CHECK_THROWS_AS(out.root.put("invariants/power", tilts), std::logic_error);
  CHECK_THROWS_AS(out.root.check("range", kept), std::logic_error);
  out.file.commit();
  const ResultReader file(out.folder / "a.h5");
  CHECK(file.dataset<double>("mc/invariants/power") == std::vector<double>{2, 0.2});
  CHECK(file.dataset<double>("mc/invariants/power_limit") == std::vector<double>{4, 0.1});
}

TEST_CASE("collected result: reports whether its invariants hold") {
  CollectedResult kept;
  ResultFile(kept).dataset("range", std::span<const double>(two).first(1), {}, "", "");
  CHECK(kept.keeps_invariants());
  for (const double off : {0.5, 2.0}) {
    CollectedResult result;
    ResultFile file(result);
    file.bind("VIEW", {std::size_t{1}});
    ResultGroup(file, table, "mc").check("invariants/power", Invariant{off, 1});
    CHECK(result.keeps_invariants() == (off < 1));
  }
}

}  // namespace flatspeckle::test_result_group
