#pragma once

#include <stdexcept>
#include <string>

namespace flatspeckle {

/// A function was called with what it does not take, or has not made what it should: a mistake in
/// the program, not in its input. The program prints the line and ends with status 1.
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

// Preconditions and postconditions at the borders of rooms. They hold in all builds, since wrong
// numbers cost more than a comparison; inner loops use assert.
#define FS_EXPECT(condition) \
  ((condition) ? void() : flatspeckle::violated("precondition", #condition, __FILE__, __LINE__))
#define FS_ENSURE(condition) \
  ((condition) ? void() : flatspeckle::violated("postcondition", #condition, __FILE__, __LINE__))
