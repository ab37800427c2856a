#pragma once

#include <string_view>

namespace flatspeckle {

/// Keyword of the text in PNG files of `export` that describes how the pixels follow from values.
constexpr const char* png_keyword = "flatspeckle";
/// How this text begins in pictures for display, whose pixels are not proportional to values.
constexpr std::string_view display_note = "for display";
/// How it begins in pictures whose largest value has the largest count, without saturation.
constexpr std::string_view linear_note = "linear";

}  // namespace flatspeckle
