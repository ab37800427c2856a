#include <limits>
#include <stdexcept>

#include "tests/bench/check_extremes.h"

namespace flatspeckle::bench::test_extremes {

namespace {

ExtremeCase row(std::function<Finding()> run, std::string must_say = {}) {
  return {"module", "name", "invariant", std::move(must_say), std::move(run)};
}
bool good(const ExtremeCase& extreme) {
  return passes(extreme, examine(extreme));
}
Finding refused() {
  throw std::runtime_error("width = 0: must be positive");
}

}  // namespace

TEST_CASE(
    "extreme cases: results are within limits, or input is rejected with the required message") {
  tests::check_extremes(false);
}

TEST_CASE("stability rows: a large figure, NaN, an unexpected or a different error fails") {
  CHECK(good(row([] { return Finding{1, 1}; })));
  CHECK(!good(row([] { return Finding{1.1, 1}; })));
  CHECK(!good(row([] { return Finding{std::numeric_limits<double>::quiet_NaN(), 1}; })));
  CHECK(!good(row(refused)));
  CHECK(good(row(refused, "width = 0")));
  CHECK(!good(row(refused, "depth")));
  CHECK(!good(row([] { return Finding{0, 1}; }, "width")));
}

TEST_CASE(
    "nightly: slow extreme cases: results are within limits, or input is rejected with the "
    "required message") {
  tests::check_extremes(true);
}

}  // namespace flatspeckle::bench::test_extremes
