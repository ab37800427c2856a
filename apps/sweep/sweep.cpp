#include "apps/sweep/sweep.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "apps/sweep/point_store.h"
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

bool Sweep::read() {
  session_.emplace(command_.text(), keys(), run_, command_.only_prints(), Session::Out::shared);
  take_points();
  return command_.settle();
}

void Sweep::parse_config(const std::string& config, const std::string& command_line) {
  command_.parse_config(config);
  session_.emplace(command_line, keys(), run_, true);
  take_points();
}

void Sweep::take_points() {
  if (!keys().read(share_text_).empty()) share_ = share_of(share_text_);
  check();
}

void Sweep::add_share_key() {
  keys()
      .add("shard", share_text_,
           "i/n: work on every nth point only, from number i = 0 .. n - 1 on; then merge")
      .no_file();
}

std::size_t Sweep::finished_points(const PointStore& store) const {
  return store.finished();
}

}  // namespace flatspeckle::apps
