#include "apps/sweep/sweep_share.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "core/error.h"

namespace flatspeckle::apps {

SweepShare share_of(const std::string& text) {
  SweepShare share;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, share.number);
  const bool slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto count = slash ? std::from_chars(number.ptr + 1, end, share.count) : number;
  if (!slash || count.ec != std::errc{} || count.ptr != end || share.number >= share.count)
    throw InputError("shard", text, "must be i/n with 0 <= i < n");
  return share;
}

ScatteredRuns::ScatteredRuns(std::size_t runs, const SweepShare& share)
    : runs_(runs), stride_(std::max<std::size_t>(1, runs * 618 / 1000)), share_(share) {
  while (std::gcd(stride_, runs_) != 1) ++stride_;
}

std::size_t ScatteredRuns::size() const {
  return (runs_ + share_.count - 1 - share_.number) / share_.count;
}

std::size_t ScatteredRuns::operator[](std::size_t number) const {
  return (share_.number + number * share_.count) * stride_ % runs_;
}

}  // namespace flatspeckle::apps
