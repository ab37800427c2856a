#include <doctest/doctest.h>

#include "core/result/scratch_numbers.h"

namespace flatspeckle::test_scratch_numbers {

TEST_CASE("scratch numbers are what they were set to, and 0 before") {
  ScratchNumbers numbers;
  CHECK(numbers.at(0) == 0);
  CHECK(numbers.at(1'000'000) == 0);
  numbers.set(1000, ~std::uint64_t{0});
  numbers.set(3, 7);
  numbers.set(1000, 5);
  CHECK(numbers.at(1000) == 5);
  CHECK(numbers.at(3) == 7);
  CHECK(numbers.at(999) == 0);
  CHECK(numbers.at(1001) == 0);
}

}  // namespace flatspeckle::test_scratch_numbers
