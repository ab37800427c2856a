#include <limits>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/result/collected_result.h"

namespace flatspeckle::test_collected_result {

namespace {

const std::vector<double> tilts{0, 0.1};
const std::vector<Complex> fields{{1, 2}, {3, 4}};
const std::vector<std::uint64_t> counts{7, 8};
const std::vector<std::string> words{"a", "longer word"};

CollectedResult some_result() {
  CollectedResult result;
  ResultFile file(result);
  file.scale("tilt", tilts, "rad", "rotation");
  file.dataset("group/field", fields, {"tilt"}, "length", "a field");
  file.dataset("count", counts, {std::size_t{2}}, "1", "counts");
  file.dataset("word", words, {"tilt"}, "", "words");
  file.dataset("scalar", std::span(tilts).first(1), {}, "1", "a number");
  file.attribute("/", "depth", 3.5);
  file.attribute("/", "kind", std::string("slab"));
  file.attribute("count", "all", true);
  CHECK(file.has("tilt"));
  CHECK(file.has("group"));
  CHECK_FALSE(file.has("gro"));
  return result;
}

}  // namespace

TEST_CASE("collected result: contains the datasets and attributes of a file") {
  const CollectedResult result = some_result();
  REQUIRE(result.datasets.size() == 5);
  CHECK(result.find("tilt")->is_scale);
  CHECK(std::get<1>(result.find("group/field")->values) == fields);
  CHECK(result.find("group/field")->axes == std::vector<Axis>{"tilt"});
  CHECK(result.find("none") == nullptr);
  CHECK(result.attributes.size() == 3);
}

TEST_CASE("collected result: is restored from the bytes of layout and values") {
  const CollectedResult one = some_result();
  CollectedResult other = some_result();
  std::get<0>(other.datasets[0].values)[1] = 0.2;
  std::get<3>(other.datasets[3].values)[0] = "changed";
  other.attributes[0].value = 7.0;
  CHECK(layout_of(one) == layout_of(other));
  const CollectedResult back = result_of(layout_of(one), values_of(other));
  REQUIRE(back.datasets.size() == one.datasets.size());
  for (std::size_t i = 0; i < back.datasets.size(); ++i) {
    const CollectedDataset &a = back.datasets[i], &b = other.datasets[i];
    CHECK(a.name == b.name);
    CHECK(a.is_scale == b.is_scale);
    CHECK(a.axes == b.axes);
    CHECK(a.units == b.units);
    CHECK(a.long_name == b.long_name);
    CHECK(a.values == b.values);
  }
  for (std::size_t i = 0; i < back.attributes.size(); ++i)
    CHECK(back.attributes[i].value == other.attributes[i].value);
}

TEST_CASE("collected result: truncated and excess bytes are rejected") {
  const auto layout = layout_of(some_result()), values = values_of(some_result());
  for (std::size_t size = 0; size < layout.size(); ++size)
    CHECK_THROWS_AS(result_of(std::span(layout).first(size)), InputError);
  for (std::size_t size = 0; size < values.size(); ++size)
    CHECK_THROWS_AS(result_of(layout, std::span(values).first(size)), InputError);
  auto more = values;
  more.push_back({});
  CHECK_THROWS_AS(result_of(layout, more), InputError);
}

TEST_CASE("collected result: infinite values and repeated names are rejected") {
  CollectedResult result;
  ResultFile file(result);
  const std::vector<double> bad{std::numeric_limits<double>::quiet_NaN()};
  CHECK_THROWS_AS(file.dataset("bad", bad, {std::size_t{1}}, "1", "no number"), std::logic_error);
  file.dataset("good", std::span(tilts), {std::size_t{2}}, "1", "numbers");
  CHECK_THROWS_AS(file.dataset("good", std::span(tilts), {std::size_t{2}}, "1", "again"),
                  std::logic_error);
  file.begin_dataset("blocks", std::span<const Complex>(), {}, {}, "1", "blocks");
  CHECK_THROWS_AS(file.begin_dataset("blocks", std::span<const Complex>(), {}, {}, "1", "again"),
                  std::logic_error);
}

}  // namespace flatspeckle::test_collected_result
