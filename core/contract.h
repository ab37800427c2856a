#pragma once

#include <stdexcept>
#include <string>

namespace flatspeckle {

/// Exception for a violated precondition or postcondition, that is, a mistake in the program, not
/// in its input. The program prints the message as one line and exits with status 1.
class ContractViolation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] inline void violated(const char* kind, const char* condition, const char* file,
                                  int line) {
  throw ContractViolation(std::string(file) + ":" + std::to_string(line) + ": " + kind + " " +
                          condition + " does not hold");
}

}  // namespace flatspeckle

// Preconditions and postconditions at module boundaries. They are checked in all builds, because
// the checks are cheap and wrong results are not; inner loops use assert instead.
#define FS_EXPECT(condition) \
  ((condition) ? void() : flatspeckle::violated("precondition", #condition, __FILE__, __LINE__))
#define FS_ENSURE(condition) \
  ((condition) ? void() : flatspeckle::violated("postcondition", #condition, __FILE__, __LINE__))
