#include <csignal>
#include <string>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/result/guarded_read.h"

namespace flatspeckle::test_guarded_read {

TEST_CASE("what cannot be read without a crash is refused, and names the file") {
  for (const int signal : {SIGSEGV, SIGABRT, SIGKILL})
    CHECK_THROWS_WITH_AS(guarded_read("some.h5", [&] { return std::raise(signal); }),
                         doctest::Contains("some.h5: is damaged"), InputError);
}

TEST_CASE("a guarded read gives what it reads, or throws what that throws") {
  CHECK(guarded_read("some.h5", [] { return std::string("read"); }) == "read");
  const auto refused = [] { return throw InputError("not this one"), 0; };
  CHECK_THROWS_WITH_AS(guarded_read("some.h5", refused), "not this one", InputError);
}

}  // namespace flatspeckle::test_guarded_read
