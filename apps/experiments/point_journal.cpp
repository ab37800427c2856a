#include "apps/experiments/point_journal.h"

#include <iostream>

#include "core/error.h"
#include "core/result/byte_stream.h"
#include "core/session/aside.h"
#include "core/session/identity.h"

namespace flatspeckle::apps {

namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void put_bytes(ByteWriter& block, std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) block.put(byte);
}

}  // namespace

PointJournal::PointJournal(const std::filesystem::path& path, const SweepHead& head)
    : file_(std::make_unique<BlockFile>(path, BlockFile::Access::append)) {
  const auto tail = scan();
  if (has_head_ && head_.identity != head.identity)
    throw InputError("resume: what " + path.string() + " holds belongs to another sweep (" +
                     first_difference(head_.identity, head.identity) +
                     "); name another result file, or remove it");
  if (tail == BlockFile::Tail::damaged) keep_damaged(path);
  file_->cut();
  if (has_head_) return;
  head_ = head;
  ByteWriter block;
  block.put(Kind::head);
  block.put(head.identity);
  block.put(head.config);
  file_->append(block.take());
}

PointJournal::PointJournal(const std::filesystem::path& path)
    : file_(std::make_unique<BlockFile>(path, BlockFile::Access::read)) {
  if (scan() == BlockFile::Tail::damaged)
    std::cerr << "warning: " << path.string() << " is damaged; " << size()
              << " points of it are taken\n";
  if (!has_head_) throw InputError(path.string() + " holds no points of a sweep");
}

BlockFile::Tail PointJournal::scan() {
  return file_->scan(
      [this](std::uint64_t place, std::span<const std::byte> block) { take_in(place, block); });
}

void PointJournal::take_in(std::uint64_t place, std::span<const std::byte> block) {
  ByteReader bytes(block);
  switch (bytes.get<Kind>()) {
    case Kind::head:
      bytes.get(head_.identity);
      bytes.get(head_.config);
      has_head_ = true;
      break;
    case Kind::plan:
      plans_.add(text_of(bytes.rest()));
      break;
    case Kind::layout:
      layouts_.add(text_of(bytes.rest()));
      break;
    case Kind::point:
      places_.emplace(std::hash<std::string>()(bytes.get<std::string>()), place);
      break;
  }
}

void PointJournal::keep_damaged(const std::filesystem::path& path) const {
  const auto place = free_aside(path);
  std::error_code failed;
  std::filesystem::copy_file(path, place, failed);
  std::cerr << "warning: " + path.string() + " is damaged after " + std::to_string(size()) +
                   " points; " +
                   (failed ? "the rest is done again\n"
                           : "it is kept as " + place.filename().string() +
                                 ", and the rest is done again\n");
}

bool PointJournal::has(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return place_of(name).has_value();
}

/// Of names only their hashes are in memory: there may be very many.
std::optional<std::uint64_t> PointJournal::place_of(const std::string& name) const {
  const auto [first, last] = places_.equal_range(std::hash<std::string>()(name));
  for (auto place = first; place != last; ++place) {
    const auto block = file_->read(place->second);
    ByteReader bytes(block);
    bytes.get<Kind>();
    if (bytes.get<std::string>() == name) return place->second;
  }
  return std::nullopt;
}

void PointJournal::Shared::add(const std::string& text) {
  numbers.emplace(text, texts.size());
  texts.push_back(text);
}

const std::string& PointJournal::Shared::at(std::uint64_t number) const {
  if (number >= texts.size()) throw InputError("a point refers to what its file does not have");
  return texts[number];
}

/// Written where it is new.
std::uint64_t PointJournal::number_of(Kind kind, const std::string& text) {
  Shared& known = kind == Kind::plan ? plans_ : layouts_;
  if (const auto found = known.numbers.find(text); found != known.numbers.end())
    return found->second;
  ByteWriter block;
  block.put(kind);
  put_bytes(block, bytes_of(text));
  file_->append(block.take());
  known.add(text);
  return known.texts.size() - 1;
}

void PointJournal::add(const std::string& name, const FinishedPoint& point) {
  const auto layout = layout_of(point.result), values = values_of(point.result);
  const std::lock_guard lock(mutex_);
  ByteWriter block;
  block.put(Kind::point);
  block.put(name);
  block.put(number_of(Kind::plan, point.plan));
  block.put(number_of(Kind::layout, text_of(layout)));
  block.put(point.started);
  for (const double number : {point.samples, point.cpu_s, point.wall_s, point.relative_error})
    block.put(number);
  block.put(point.reached);
  put_bytes(block, values);
  places_.emplace(std::hash<std::string>()(name), file_->append(block.take()));
}

FinishedPoint PointJournal::read(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto block = file_->read(place_of(name).value());
  ByteReader bytes(block);
  bytes.get<Kind>();
  bytes.get<std::string>();
  FinishedPoint point;
  point.plan = plans_.at(bytes.get<std::uint64_t>());
  const std::string& layout = layouts_.at(bytes.get<std::uint64_t>());
  bytes.get(point.started);
  for (double* number : {&point.samples, &point.cpu_s, &point.wall_s, &point.relative_error})
    bytes.get(*number);
  bytes.get(point.reached);
  point.result = result_of(bytes_of(layout), bytes.rest());
  return point;
}

void PointJournal::sync() {
  const std::lock_guard lock(mutex_);
  file_->sync();
}

}  // namespace flatspeckle::apps
