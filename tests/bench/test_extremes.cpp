#include <limits>
#include <stdexcept>

#include "tests/bench/check_extremes.h"

namespace flatspeckle::bench::test_extremes {

namespace {

ExtremeCase row(std::function<Finding()> run, std::string must_say = {}) {
  return {"room", "name", "invariant", std::move(must_say), std::move(run)};
}
bool good(const ExtremeCase& extreme) {
  return passes(extreme, examine(extreme));
}
Finding refused() {
  throw std::runtime_error("width = 0: must be positive");
}

}  // namespace

TEST_CASE("Extreme cases are right, or refused with a clear error") {
  tests::check_extremes(false);
}

TEST_CASE("A row fails by its figure, by NaN, by a refusal that nobody asked for or another one") {
  CHECK(good(row([] { return Finding{1, 1}; })));
  CHECK(!good(row([] { return Finding{1.1, 1}; })));
  CHECK(!good(row([] { return Finding{std::numeric_limits<double>::quiet_NaN(), 1}; })));
  CHECK(!good(row(refused)));
  CHECK(good(row(refused, "width = 0")));
  CHECK(!good(row(refused, "depth")));
  CHECK(!good(row([] { return Finding{0, 1}; }, "width")));
}

TEST_CASE("nightly: Extreme cases that take long are right, or refused with a clear error") {
  tests::check_extremes(true);
}

}  // namespace flatspeckle::bench::test_extremes
