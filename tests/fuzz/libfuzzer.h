#pragma once

#include <cstddef>
#include <cstdint>

// Functions called by libFuzzer.

/// Reads --target=NAME; libFuzzer itself ignores all flags with two dashes.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);
/// Passes the input to the target. Returns 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);
