#include <doctest/doctest.h>

#include "core/keys/keys.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle::test_keys {

namespace {

struct Lens {
  std::string kind = "ball";
  double radius = 1;
  std::optional<double> index = {};
  std::vector<double> centre = {};
  std::vector<std::string> names = {};
  std::optional<std::int64_t> count = {};
  bool coated = false;
};

void add_keys(Keys& keys, Lens& lens) {
  keys.group("Lens");
  keys.add("kind", lens.kind, "What it is").one_of({"ball", "rod"});
  keys.add("radius", lens.radius, "Its radius").positive().unit("length").only_of("ball");
  keys.add("index", lens.index, "Its index").from(1, 4);
  keys.add("centre", lens.centre, "x y z of each").each_of(3, "x y z");
  keys.add("names", lens.names, "Of each");
  keys.add("count", lens.count, "How many").positive().effort();
  keys.add("coated", lens.coated, "Whether it is").no_file();
}

/// Reads the keys that the kind uses: a rod has no radius.
int make(const Keys& keys, const Lens& lens) {
  keys.read(lens.count);
  keys.read(lens.centre);
  return keys.read(lens.kind) == "ball" ? static_cast<int>(keys.read(lens.radius)) : 0;
}

std::string refusal(const auto& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string refusal_of(const Lens& lens) {
  return refusal([&] { made_of(lens, make); });
}

}  // namespace

TEST_CASE("keys: given keys that are not read are rejected") {
  CHECK(made_of(Lens{.radius = 2}, make) == 2);
  CHECK(refusal_of({.kind = "rod", .radius = 2}) == "radius = 2: is a key of ball only");
  CHECK(refusal_of({.kind = "rod", .radius = 1}) == "");  // equal to the default
  CHECK(refusal_of({.index = 1.5}) == "index = 1.5: is not used here; leave it out");
}

TEST_CASE("keys: values outside the schema entries are rejected") {
  CHECK(refusal_of({.kind = "cube"}) == "kind = cube: must be one of ball rod");
  CHECK(refusal_of({.radius = 0}) == "radius = 0: must be positive");
  CHECK(refusal_of({.radius = std::nan("")}) == "radius = nan: must be positive");
  CHECK(refusal_of({.radius = 1e60}) == "radius = 1e+60: must be from 1e-50 to 1e50");
  CHECK(refusal_of({.index = 5}) == "index = 5: must be from 1 to 4");
  CHECK(refusal_of({.centre = {1, 2}}) == "centre = 1 2: must be 3 numbers for each: x y z");
  CHECK(refusal_of({.count = -1}) == "count = -1: must be positive");
}

TEST_CASE("keys: texts are converted to members") {
  Lens lens;
  Keys keys;
  add_keys(keys, lens);
  keys.set("radius", {"2.50"});
  keys.set("centre", {"-.5", "1e-3", "0"});
  keys.set("count", {"1e6"});
  keys.set("coated", {"true"});
  CHECK(lens.radius == 2.5);
  CHECK(lens.centre == std::vector<double>{-0.5, 0.001, 0});
  CHECK(lens.count == 1'000'000);
  CHECK(lens.coated);
  CHECK(keys.find("radius")->line() == "radius = 2.5");
  CHECK(keys.find("centre")->line() == "centre = [-0.5, 0.001, 0]");
  const auto refused = [&](const char* key, const std::string& text, const std::string& words) {
    CHECK(refusal([&] { keys.set(key, {text}); }) == key + (" = " + text) + ": " + words);
  };
  refused("radius", "2x", "must be a number such as 0.1 or 1 mm");
  refused("count", "1.5", "must be a whole number of at most 18 digits");
  refused("count", "99999999999999999999", "must be a whole number of at most 18 digits");
  refused("kind", "a\"b", "must not contain control characters, \" or \\");
  CHECK(refusal([&] {
          keys.set("radius", {"1", "2"});
        }) == "radius: must have one value, and be given once");
}

TEST_CASE("keys: config() contains all keys read, identity() those that change results") {
  Lens lens;
  Keys keys;
  add_keys(keys, lens);
  keys.set("count", {"3"});
  keys.set("index", {"1.5"});
  make(keys, lens);
  CHECK(keys.config() == "kind = \"ball\"\nradius = 1\ncount = 3\n");
  CHECK(keys.identity() == "kind = \"ball\"\nradius = 1\n");
  CHECK(keys.config({"kind"}) == "radius = 1\ncount = 3\n");
}

TEST_CASE("keys: entries of several kinds share a name") {
  Lens ball, rod;
  Keys keys;
  keys.add("index", ball.index, "Of the ball").only_of("ball");
  keys.add("index", rod.index, "Of the rod").only_of("rod");
  keys.set("index", {"2"});
  CHECK(ball.index == 2);
  CHECK(rod.index == 2);
  CHECK(refusal([&] { keys.refuse_unread(); }) == "index = 2: is a key of ball, rod only");
  keys.read(rod.index);
  CHECK(refusal([&] { keys.refuse_unread(); }) == "");
}

TEST_CASE("parse_complex: accepted and rejected texts") {
  for (const auto& [text, value] : {std::pair<std::string, Complex>{"1.5", 1.5},
                                    {"1.5+0.1i", {1.5, 0.1}},
                                    {" -2 - i ", {-2, -1}},
                                    {"1e-3+2e-3j", {1e-3, 2e-3}},
                                    {".5 + .25 i", {0.5, 0.25}}})
    CHECK(parse_complex("index", text) == value);
  for (const char* text :
       {"", "i", "1.5i", "1 5", "1+", "1+2", "1+2i3", "nan", "inf", "1+nani", "x"})
    CHECK(refusal([&] { parse_complex("index", text); }) ==
          "index = \"" + std::string(text) + "\": must be a number such as 1.5 or 1.5+0.1i");
  CHECK(refusal([&] { parse_complex("index", "1e999"); }) == "index = 1e999: must be finite");
  CHECK(number_text(Complex(1.5, -0.1)) == "1.5-0.1i");
  CHECK(number_text(-0.0) == "0");
}

}  // namespace flatspeckle::test_keys
