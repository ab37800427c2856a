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

SweepHead head_in(ByteReader& bytes) {
  SweepHead head;
  bytes.get(head.identity);
  bytes.get(head.config);
  return head;
}

InputError holds_none(const std::filesystem::path& path) {
  return InputError(path.string() + " holds no points of a sweep");
}

}  // namespace

PointJournal::PointJournal(const std::filesystem::path& path, const SweepHead& head,
                           const Found& found)
    : file_(std::make_unique<BlockFile>(path, BlockFile::Access::append)) {
  const auto tail = scan(head.identity, found);
  if (head_ && head_->identity != head.identity)
    throw InputError("resume: what " + path.string() + " holds belongs to another sweep (" +
                     first_difference(head_->identity, head.identity) +
                     "); name another result file, or remove it");
  if (tail == BlockFile::Tail::damaged) keep_damaged(path);
  file_->cut();
  if (head_) return;
  head_ = head;
  ByteWriter block;
  block.put(Kind::head);
  block.put(head.identity);
  block.put(head.config);
  file_->append(block.take());
}

PointJournal::PointJournal(const std::filesystem::path& path, const std::string& identity,
                           const Found& found)
    : file_(std::make_unique<BlockFile>(path, BlockFile::Access::read)) {
  if (scan(identity, found) == BlockFile::Tail::damaged)
    std::cerr << "warning: " << path.string() << " is damaged; " << size()
              << " points of it are taken\n";
  if (!head_) throw holds_none(path);
  if (head_->identity != identity)
    throw InputError(path.string() + " belongs to another sweep (" +
                     first_difference(head_->identity, identity) + ')');
}

SweepHead PointJournal::head_of(const std::filesystem::path& path) try {
  const auto block = BlockFile(path, BlockFile::Access::read).read(0);
  ByteReader bytes(block);
  if (bytes.get<Kind>() != Kind::head) throw holds_none(path);
  return head_in(bytes);
} catch (const IoError&) {
  throw holds_none(path);
}

BlockFile::Tail PointJournal::scan(const std::string& identity, const Found& found) {
  return file_->scan([&](std::uint64_t place, std::span<const std::byte> block) {
    take_in(place, block, identity, found);
  });
}

/// Of the points of another sweep, which a head before them tells, nothing is told.
void PointJournal::take_in(std::uint64_t place, std::span<const std::byte> block,
                           const std::string& identity, const Found& found) {
  ByteReader bytes(block);
  switch (bytes.get<Kind>()) {
    case Kind::head:
      head_ = head_in(bytes);
      break;
    case Kind::plan:
      plans_.add(text_of(bytes.rest()), place);
      break;
    case Kind::layout:
      layouts_.add(text_of(bytes.rest()), place);
      break;
    case Kind::point:
      if (!head_ || head_->identity != identity) break;
      ++size_;
      found(bytes.get<std::string>(), place);
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

void PointJournal::Shared::add(const std::string& text, std::uint64_t place) {
  constexpr std::size_t most = 256;
  if (known.size() == most) known.clear();
  known[text] = count;
  places.set(count++, place);
}

std::string PointJournal::text(const Shared& shared, std::uint64_t number) const {
  if (number >= shared.count) throw InputError("a point refers to what its file does not have");
  const auto block = file_->read(shared.places.at(number));
  return text_of(std::span(block).subspan(sizeof(Kind)));
}

/// Written where it is new.
std::uint64_t PointJournal::number_of(Kind kind, const std::string& text) {
  Shared& shared = kind == Kind::plan ? plans_ : layouts_;
  if (const auto found = shared.known.find(text); found != shared.known.end()) return found->second;
  ByteWriter block;
  block.put(kind);
  put_bytes(block, bytes_of(text));
  shared.add(text, file_->append(block.take()));
  return shared.count - 1;
}

std::uint64_t PointJournal::add(const std::string& name, const FinishedPoint& point) {
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
  ++size_;
  return file_->append(block.take());
}

FinishedPoint PointJournal::read(std::uint64_t place) const {
  const std::lock_guard lock(mutex_);
  const auto block = file_->read(place);
  ByteReader bytes(block);
  bytes.get<Kind>();
  bytes.get<std::string>();
  FinishedPoint point;
  point.plan = text(plans_, bytes.get<std::uint64_t>());
  const std::string layout = text(layouts_, bytes.get<std::uint64_t>());
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
