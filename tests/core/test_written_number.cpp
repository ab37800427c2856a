#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/keys/written_number.h"

namespace flatspeckle::test_written_number {

namespace {

constexpr double pi = std::numbers::pi;
const KeyUnit radians("rad");

std::string refusal(const std::string& text) {
  try {
    written_numbers("tilts", text, radians);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("written number: accepted and rejected texts") {
  const auto angle = [](const char* text) { return written_number(text, radians); };
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
  CHECK_FALSE(written_number("30deg", KeyUnit()).has_value());
  CHECK(written_number("2pi", KeyUnit()) == 2 * pi);
}

TEST_CASE("written number: sums of any length are added from the left") {
  CHECK(written_number("0.1+0.2 - 0.3 + pi", radians) == 0.1 + 0.2 - 0.3 + pi);
  CHECK(written_number("-0.1 - 0.2", KeyUnit()) == -0.1 - 0.2);
  std::string terms = "1";
  for (int i = 0; i < 500'000; ++i) terms += "+1";
  CHECK(written_number(terms, KeyUnit()) == 500'001);
  CHECK_FALSE(written_number(terms + "+", KeyUnit()).has_value());
}

TEST_CASE("written number: digits may be grouped by underscores") {
  CHECK(written_number("1_000.5", KeyUnit()) == 1000.5);
  for (const char* text : {"_1", "1_", "1__0", "1_.5", "1_e3"})
    CHECK_FALSE(written_number(text, KeyUnit()).has_value());
}

/// A text for a key with this unit; its value, nullopt if it is refused, and words of the refusal.
struct Case {
  const char *unit, *text;
  std::optional<double> value;
  const char* refusal = "must be a number";
};

// The scene's unit of length is the micrometre.
const Case cases[] = {
    {"", "0.1", 0.1},
    {"", "1/3", 1.0 / 3},
    {"", "1.59/1.33", 1.59 / 1.33},
    {"", "-1/-4", 0.25},
    {"", "2pi/3", 2 * pi / 3},
    {"", "1e-3", 1e-3},
    {"", "1/2pi", {}},
    {"", "1/2/3", {}},
    {"", "0.5mm", {}},
    {"", "5deg", {}},
    {"", "633nm/1.33nm", {}},
    {"rad", "5deg", 5 * pi / 180},
    {"rad", "5 deg", 5 * pi / 180},
    {"rad", "180deg - 0.2", pi - 0.2},
    {"rad", "10deg/4", 2.5 * pi / 180},
    {"rad", "pi/2", pi / 2},
    {"rad", "0.5pi rad", pi / 2},
    {"rad", "5mrad", 0.005},
    {"rad", "20urad", 2e-5},
    {"rad", "10/4deg", {}, "as in 10deg/4"},
    {"rad", "5mm", {}, "30deg"},
    {"length", "633nm", 0.633},
    {"length", "633 nm", 0.633},
    {"length", "633e-3um", 0.633},
    {"length", "633nm/1.33", 0.633 / 1.33},
    {"length", "633/1.33nm", {}, "as in 633nm/1.33"},
    {"length", "633/1.33 nm", {}, "as in 633nm/1.33"},
    {"length", "633nm/1.33nm", {}, "as in 633nm/1.33"},
    {"length", "0.5mm", 500},
    {"length", "1_000nm", 1},
    {"length", "0.57cm", 5700},
    {"length", "1m", 1e6},
    {"length", "2", 2},
    {"length", "2/3", 2.0 / 3},
    {"length", "1mm + 20um", 1020},
    {"length", "1mm - 20", 980},
    {"length", "-1mm", -1000},
    {"length", "1length", {}},
    {"length", "1mile", {}, "1 mm"},
    {"length", "1/mm", {}, "1 mm"},
    {"length", "1mm^2", {}},
    {"length", "1us", {}},
    {"length", "1 mm um", {}},
    {"length", "mm", {}},
    {"1/length", "10/mm", 0.01},
    {"1/length", "10 / mm", 0.01},
    {"1/length", "1/3/mm", {}, "as in 1/mm/3"},
    {"1/length", "1/mm/3", 1e-3 / 3},
    {"1/length", "10mm", {}, "1/mm"},
    {"1/length^2", "0.05/um^2", 0.05},
    {"1/length^2", "0.05um^-2", 0.05},
    {"1/length or length", "5um", 5},
    {"1/length or length", "5/um", 5},
    {"s", "1us", 1e-6},
    {"s", "3ms", 3e-3},
    {"s", "0.5", 0.5},
    {"s", "1us/3", 1e-6 / 3},
    {"s", "10Hz", {}, "0.1 or 1 s"},
    {"Hz", "1GHz", 1e9},
    {"Hz", "2.5 THz", 2.5e12},
    {"Hz", "3/us", 3e6},
    {"m^2/s", "4.3e-13m^2/s", 4.3e-13},
    {"m^2/s", "0.43um^2/s", 4.3e-13},
    {"m^2/s", "0.43um^2/s/2", 2.15e-13},
    {"m^2/s", "1m/s", {}},
    {"Pa s", "0.89mPa s", 8.9e-4},
    {"Pa s", "0.89 mPa*s", 8.9e-4},
    {"Pa s", "1mPas", {}, "0.1 or 1 Pa s"},
    {"K", "298.15K", 298.15},
    {"kg/m^3", "1.05g/cm^3", 1050},
    {"1/Pa", "1.3e-10/Pa", 1.3e-10},
    {"m/s", "1500m/s", 1500},
};

TEST_CASE("written number: units are those of the key's dimension, before a divisor") {
  for (const Case& test : cases) {
    INFO(std::string(test.text), " [", std::string(test.unit), "]");
    const KeyUnit unit(test.unit, 1e-6);
    const auto value = written_number(test.text, unit);
    REQUIRE(value.has_value() == test.value.has_value());
    if (value) CHECK(std::abs(*value - *test.value) <= 1e-15 * std::abs(*test.value));
    if (!value) CHECK(must_be_number(test.text, unit).find(test.refusal) != std::string::npos);
  }
}

TEST_CASE("written number: lengths with units require the scene's unit of length") {
  const KeyUnit unknown("length");
  CHECK(written_number("2", unknown) == 2);
  CHECK_FALSE(written_number("2um", unknown).has_value());
  CHECK(must_be_number("2um", unknown).find("also give length_unit") != std::string::npos);
  CHECK(written_number("2um", KeyUnit("length", 0.5e-6)) == 4);
  CHECK(written_number("2um", KeyUnit("m")) == 2e-6);
}

TEST_CASE("written numbers: ranges of times, and replacement of units in texts") {
  const auto times = written_numbers("delays", "1us:10ms:20:log", KeyUnit("s"));
  REQUIRE(times.size() == 20);
  CHECK(times.front() == 1e-6);
  CHECK(times.back() == 1e-2);
  CHECK(times[1] / times[0] == doctest::Approx(std::pow(1e4, 1 / 19.0)).epsilon(1e-13));
  const KeyUnit length("length", 1e-6);
  CHECK(without_units("10um:1mm:5:log,3", length) == "10:1000:5:log,3");
  CHECK(without_units("0:pi/2:3,word,633/1.33nm", length) == "0:pi/2:3,word,633/1.33nm");
  CHECK(refusal("0:10/4deg:3").find("as in 10deg/4") != std::string::npos);
}

TEST_CASE("parse_complex: real numbers may be written with arithmetic") {
  CHECK(parse_complex("index", "1.59/1.33") == Complex(1.59 / 1.33));
  CHECK_THROWS_AS(parse_complex("index", "1.59/1.33um"), InputError);
}

TEST_CASE("written numbers: lists and ranges") {
  const auto numbers = [](const char* text) { return written_numbers("tilts", text, radians); };
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
  CHECK(written_range("tilts", "0:1:5", KeyUnit())->at(3) == 0.75);
  CHECK_FALSE(written_range("tilts", "0:1:5,2", KeyUnit()).has_value());
  CHECK(refusal("0:0.1:1") == "tilts = 0:0.1:1: a range must have 2 to 1000000 values");
  for (const char* text :
       {"0:1", "0:1:2:3", "0:1:5:log", "-1:1:5:log", "a:1:5", "0:1:2.5", "0:inf:3"})
    CHECK(refusal(text).find("must be first:last:count") != std::string::npos);
  CHECK(refusal("0,,1") == "tilts = 0,,1: must be a number such as 0.1, pi/2 or 30deg");
}

TEST_CASE("written range: find() returns the index of its values and of no others") {
  for (const char* text : {"0:1:11", "-0.3:-7:1001", "1e-4:0.1:997:log", "3:1e-9:50:log"}) {
    const auto range = written_range("tilts", text, KeyUnit());
    for (std::size_t i = 0; i < range->count; ++i) CHECK(range->find(range->at(i)) == i);
    CHECK_FALSE(range->find(std::nextafter(range->at(5), 10)).has_value());
    CHECK_FALSE(range->find(1e3).has_value());
    CHECK_FALSE(range->find(-1e3).has_value());
  }
}

}  // namespace flatspeckle::test_written_number
