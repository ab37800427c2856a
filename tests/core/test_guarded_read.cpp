#include <csignal>
#include <string>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/result/guarded_read.h"

namespace flatspeckle::test_guarded_read {

TEST_CASE("guarded read: a crash becomes an InputError that contains the file name") {
  for (const int signal : {SIGSEGV, SIGABRT, SIGKILL})
    CHECK_THROWS_WITH_AS(guarded_read("some.h5", [&] { return std::raise(signal); }),
                         doctest::Contains("some.h5: is damaged"), InputError);
}

TEST_CASE("guarded read: returns the value or rethrows the exception") {
  CHECK(guarded_read("some.h5", [] { return std::string("read"); }) == "read");
  const auto refused = [] { return throw InputError("not this one"), 0; };
  CHECK_THROWS_WITH_AS(guarded_read("some.h5", refused), "not this one", InputError);
}

}  // namespace flatspeckle::test_guarded_read
