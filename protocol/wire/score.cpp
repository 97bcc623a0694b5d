#include "protocol/wire/score.h"

#include "engine/base/atomic_file.h"
#include "engine/base/within_memory.h"
#include "protocol/wire/codec.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

namespace ringdown::wire {
namespace {

// The time tag 1, "immediately", means the start.
double to_seconds(TimeTag time) { return time == kImmediately ? 0 : static_cast<double>(time) / kTicksPerSecond; }
TimeTag to_time_tag(double seconds) { return static_cast<TimeTag>(std::llround(seconds * kTicksPerSecond)); }

std::uint32_t read_size(std::span<const std::byte> bytes) {
  std::uint32_t size = 0;
  for (const std::byte byte : bytes.first(4)) size = size << 8 | std::to_integer<std::uint32_t>(byte);
  return size;
}

void append_size(std::vector<std::byte>& bytes, std::size_t size) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::byte>(size >> shift));
}

bool is_bundle(std::span<const std::byte> bytes) {
  return bytes.size() >= 8 && std::memcmp(bytes.data(), "#bundle", 8) == 0;
}

// Appends the messages of the bundle to `events`, or says what is wrong with it.
Result<void> read_bundle(std::span<const std::byte> bundle, std::vector<ScoreEvent>& events) {
  if (!is_bundle(bundle)) return fail(ErrorKind::bad_input, "it is not a bundle, so it has no time");
  Result<std::vector<TimedMessage>> messages = decode_packet(bundle);
  if (!messages) return fail(messages);
  for (TimedMessage& timed : *messages) {
    const double time_s = to_seconds(timed.time);
    if (time_s > kMaxScore)
      return fail(ErrorKind::bad_input, "its time is more than a day after the start: is it a date?");
    events.push_back({time_s, std::move(timed.message)});
  }
  return {};
}

}  // namespace

Result<std::vector<ScoreEvent>> parse_score(std::span<const std::byte> bytes, const std::string& name) {
  std::vector<ScoreEvent> events;
  std::size_t number = 0;
  for (std::span<const std::byte> rest = bytes; !rest.empty();) {
    const std::string where = formatted("{}: bundle {} at byte {}: ", name, ++number, bytes.size() - rest.size());
    if (rest.size() < 4) return fail(ErrorKind::bad_input, where + "the file ends inside its length");
    const std::size_t size = read_size(rest);
    rest = rest.subspan(4);
    if (size > rest.size()) {
      return fail(ErrorKind::bad_input, "{}its length is {} bytes, but the file has only {} more", where, size,
                  rest.size());
    }
    if (Result<void> good = read_bundle(rest.first(size), events); !good)
      return fail(good.error().kind, where + good.error().message);
    rest = rest.subspan(size);
  }
  std::ranges::stable_sort(events, {}, &ScoreEvent::time_s);
  return events;
}

Result<std::vector<ScoreEvent>> read_score(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_whole_file(path, kMaxScoreBytes);
  if (!bytes) return fail(bytes);
  return within_memory("read " + path.string(),
                       [&] { return parse_score(std::as_bytes(std::span(*bytes)), path.string()); });
}

std::vector<std::byte> encode_score(std::span<const ScoreEvent> events) {
  assert(std::ranges::is_sorted(events, {}, &ScoreEvent::time_s));
  std::vector<std::byte> bytes;
  for (std::size_t first = 0, last = 0; first < events.size(); first = last) {
    const double time_s = events[first].time_s;
    assert(time_s >= 0 && time_s <= kMaxScore);
    std::vector<Message> messages;
    // Messages that do not fit into one packet go into further bundles of the same time.
    constexpr std::size_t kBundleHead = 16, kLength = 4;
    for (std::size_t size = kBundleHead; last < events.size() && events[last].time_s == time_s; ++last) {
      size += kLength + encode(events[last].message).size();
      if (last > first && size > kMaxPacketBytes) break;
      messages.push_back(events[last].message);
    }
    const std::vector<std::byte> bundle = encode_bundle(to_time_tag(time_s), messages);
    append_size(bytes, bundle.size());
    bytes.insert(bytes.end(), bundle.begin(), bundle.end());
  }
  return bytes;
}

Result<void> write_score(std::span<const ScoreEvent> events, const std::filesystem::path& path) {
  return write_file_atomically(path, encode_score(events));
}

}  // namespace ringdown::wire
