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

std::vector<std::size_t> scattered(std::size_t runs, const SweepShare& share) {
  std::size_t stride = std::max<std::size_t>(1, runs * 618 / 1000);
  while (std::gcd(stride, runs) != 1) ++stride;
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < runs; ++i)
    if (i % share.count == share.number) own.push_back(i * stride % runs);
  return own;
}

}  // namespace flatspeckle::apps
