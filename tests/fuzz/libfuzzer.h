#pragma once

#include <cstddef>
#include <cstdint>

// libFuzzer calls these.

/// Reads --target=NAME, which libFuzzer itself, as all flags of two dashes, does not look at.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);
/// Gives the input to the target. Returns 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);
