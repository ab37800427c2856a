#include "apps/sweep/point_journal.h"

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

PointJournal::PointJournal(const std::filesystem::path& path, const JournalHead& head,
                           const std::string& whose, const Found& found)
    : journal_(path, head, whose, taking(found)) {}

PointJournal::PointJournal(const std::filesystem::path& path, const std::string& identity,
                           const Found& found)
    : journal_(path, identity, "sweep", taking(found)) {}

Journal::Use PointJournal::taking(const Found& found) {
  return [this, &found](std::uint64_t place, char kind, ByteReader& record) {
    switch (kind) {
      case plan_kind:
        return plans_.add(text_of(record.rest()), place);
      case layout_kind:
        return layouts_.add(text_of(record.rest()), place);
      case point_kind:
        ++size_;
        return found(record.get<std::string>(), place);
    }
  };
}

void PointJournal::Shared::add(const std::string& text, std::uint64_t place) {
  constexpr std::size_t most = 256;
  if (known.size() == most) known.clear();
  known[text] = places.size();
  places.push_back(place);
}

std::string PointJournal::text(const Shared& shared, std::uint64_t number) const {
  if (number >= shared.places.size())
    throw InputError("the file is damaged: one of its points refers to a text that is missing");
  return text_of(journal_.read(shared.places[number]));
}

/// Returns the number under which a shared text is stored in the journal. A new text is appended to
/// the journal.
std::uint64_t PointJournal::number_of(char kind, const std::string& text) {
  Shared& shared = kind == plan_kind ? plans_ : layouts_;
  if (const auto found = shared.known.find(text); found != shared.known.end()) return found->second;
  shared.add(text, journal_.append(kind, bytes_of(text)));
  return shared.places.size() - 1;
}

std::uint64_t PointJournal::add(const std::string& name, const FinishedPoint& point) {
  const auto layout = layout_of(point.result), values = values_of(point.result);
  const std::lock_guard lock(mutex_);
  ByteWriter record;
  record.put(name);
  record.put(number_of(plan_kind, point.plan));
  record.put(number_of(layout_kind, text_of(layout)));
  record.put(point.started);
  for (const double number : {point.samples, point.cpu_s, point.wall_s, point.relative_error})
    record.put(number);
  record.put(point.reached);
  for (const std::byte byte : values) record.put(byte);
  ++size_;
  return journal_.append(point_kind, record.take());
}

FinishedPoint PointJournal::read(std::uint64_t place) const {
  const std::lock_guard lock(mutex_);
  const auto record = journal_.read(place);
  ByteReader bytes(record);
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
  journal_.sync();
}

}  // namespace flatspeckle::apps
