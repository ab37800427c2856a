#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/keys/written_number.h"

namespace flatspeckle::test_written_number {

namespace {

constexpr double pi = std::numbers::pi;

std::string refusal(const std::string& text) {
  try {
    written_numbers("tilts", text, Written::angle);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("written number: accepted and rejected texts") {
  const auto angle = [](const char* text) { return written_number(text, Written::angle); };
  CHECK(angle("pi") == pi);
  CHECK(angle("-pi") == -pi);
  CHECK(angle("pi/2") == pi / 2);
  CHECK(angle("-0.25pi") == -0.25 * pi);
  CHECK(angle("2 pi / 3") == 2 * pi / 3);
  CHECK(angle("pi - 0.2") == pi - 0.2);
  CHECK(angle("pi-1e-3") == pi - 1e-3);
  CHECK(angle("0-.4") == -0.4);
  CHECK(angle("-.4") == -0.4);
  CHECK(angle("1/8") == 0.125);
  CHECK(angle("30deg") == doctest::Approx(pi / 6).epsilon(1e-15));
  CHECK(angle("180deg - 0.2") == doctest::Approx(pi - 0.2).epsilon(1e-15));
  CHECK(angle("5mrad") == 0.005);
  CHECK(angle("2rad") == 2);
  for (const char* text :
       {"", "deg", "pie", "2x", "1//2", "1/0", "1+", "+-1", "--1", "1e", "pi pi"})
    CHECK_FALSE(angle(text).has_value());
  CHECK_FALSE(written_number("30deg", Written::number).has_value());
  CHECK(written_number("2pi", Written::number) == 2 * pi);
}

TEST_CASE("written number: sums of any length are added from the left") {
  CHECK(written_number("0.1+0.2 - 0.3 + pi", Written::angle) == 0.1 + 0.2 - 0.3 + pi);
  CHECK(written_number("-0.1 - 0.2", Written::number) == -0.1 - 0.2);
  std::string terms = "1";
  for (int i = 0; i < 500'000; ++i) terms += "+1";
  CHECK(written_number(terms, Written::number) == 500'001);
  CHECK_FALSE(written_number(terms + "+", Written::number).has_value());
}

TEST_CASE("written number: digits may be grouped by underscores") {
  CHECK(written_number("1_000.5", Written::number) == 1000.5);
  for (const char* text : {"_1", "1_", "1__0", "1_.5", "1_e3"})
    CHECK_FALSE(written_number(text, Written::number).has_value());
}

TEST_CASE("written numbers: lists and ranges") {
  const auto numbers = [](const char* text) {
    return written_numbers("tilts", text, Written::angle);
  };
  CHECK(numbers("0,0.1, pi") == std::vector<double>{0, 0.1, pi});
  CHECK(numbers("0:1:5") == std::vector<double>{0, 0.25, 0.5, 0.75, 1});
  CHECK(numbers("-1:1:3,2") == std::vector<double>{-1, 0, 1, 2});
  const auto steps = numbers("1e-4:0.1:4:log");
  REQUIRE(steps.size() == 4);
  for (int i = 0; i < 4; ++i)
    CHECK(steps[i] == doctest::Approx(std::pow(10, i - 4)).epsilon(1e-14));
  CHECK(numbers("1:40:40")[11] == 12);
  CHECK(numbers("-1e308:1e308:3") == std::vector<double>{-1e308, 0, 1e308});
  CHECK(numbers("0:10deg:11").back() == doctest::Approx(pi / 18).epsilon(1e-15));
  CHECK(written_range("tilts", "0:1:5", Written::number)->at(3) == 0.75);
  CHECK_FALSE(written_range("tilts", "0:1:5,2", Written::number).has_value());
  CHECK(refusal("0:0.1:1") == "tilts = 0:0.1:1: a range must have 2 to 1000000 values");
  for (const char* text :
       {"0:1", "0:1:2:3", "0:1:5:log", "-1:1:5:log", "a:1:5", "0:1:2.5", "0:inf:3"})
    CHECK(refusal(text).find("must be first:last:count") != std::string::npos);
  CHECK(refusal("0,,1") == "tilts = 0,,1: must be a number such as 0.1, pi/2 or 30deg");
}

TEST_CASE("written range: find() returns the index of its values and of no others") {
  for (const char* text : {"0:1:11", "-0.3:-7:1001", "1e-4:0.1:997:log", "3:1e-9:50:log"}) {
    const auto range = written_range("tilts", text, Written::number);
    for (std::size_t i = 0; i < range->count; ++i) CHECK(range->find(range->at(i)) == i);
    CHECK_FALSE(range->find(std::nextafter(range->at(5), 10)).has_value());
    CHECK_FALSE(range->find(1e3).has_value());
    CHECK_FALSE(range->find(-1e3).has_value());
  }
}

}  // namespace flatspeckle::test_written_number
