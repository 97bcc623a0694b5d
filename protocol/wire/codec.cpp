#include "protocol/wire/codec.h"

#include <lo/lo.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <memory>

namespace ringdown::wire {
namespace {

struct FreeMessage {
  using pointer = lo_message;
  void operator()(lo_message message) const { lo_message_free(message); }
};
struct FreeBundle {
  using pointer = lo_bundle;
  void operator()(lo_bundle bundle) const { lo_bundle_free_recursive(bundle); }
};
// lo_message and lo_bundle are void* in liblo 0.31, and pointers to distinct types from 0.32 on.
using MessageHandle = std::unique_ptr<std::remove_pointer_t<lo_message>, FreeMessage>;
using BundleHandle = std::unique_ptr<std::remove_pointer_t<lo_bundle>, FreeBundle>;

constexpr double kUnixEpochNtp = 2208988800;  // seconds from 1900 to 1970, RFC 868

void add(lo_message message, std::int32_t value) { lo_message_add_int32(message, value); }
void add(lo_message message, std::int64_t value) { lo_message_add_int64(message, value); }
void add(lo_message message, float value) { lo_message_add_float(message, value); }
void add(lo_message message, double value) { lo_message_add_double(message, value); }
void add(lo_message message, const std::string& value) { lo_message_add_string(message, value.c_str()); }
void add(lo_message message, bool value) { (value ? lo_message_add_true : lo_message_add_false)(message); }
void add(lo_message message, Tag tag) { (tag.type == 'I' ? lo_message_add_infinitum : lo_message_add_nil)(message); }
void add(lo_message message, const Blob& value) {
  // lo_blob_new() cannot make an empty blob, so the blob is built here: its size, then its bytes, as in an argument.
  std::vector<std::uint32_t> blob(1 + (value.size() + 3) / 4);
  blob[0] = static_cast<std::uint32_t>(value.size());
  std::ranges::copy(value, reinterpret_cast<std::byte*>(blob.data() + 1));
  lo_message_add_blob(message, reinterpret_cast<lo_blob>(blob.data()));
}

MessageHandle to_liblo(const Message& message) {
  MessageHandle handle(lo_message_new());
  for (const Argument& argument : message.arguments) {
    std::visit([&](const auto& value) { add(handle.get(), value); }, argument);
  }
  return handle;
}

// Takes ownership of a packet that liblo allocated with malloc.
std::vector<std::byte> take(void* serialised, std::size_t size) {
  const auto* const first = static_cast<const std::byte*>(serialised);
  std::vector<std::byte> bytes(first, first + size);
  std::free(serialised);
  return bytes;
}

}  // namespace

std::vector<std::byte> encode(const Message& message) {
  std::size_t size = 0;
  void* const serialised = lo_message_serialise(to_liblo(message).get(), message.address.c_str(), nullptr, &size);
  return take(serialised, size);
}

std::vector<std::byte> encode_bundle(TimeTag time, std::span<const Message> messages) {
  const lo_timetag tag{static_cast<std::uint32_t>(time >> 32), static_cast<std::uint32_t>(time)};
  const BundleHandle bundle(lo_bundle_new(tag));
  for (const Message& message : messages) {
    lo_bundle_add_message(bundle.get(), message.address.c_str(), to_liblo(message).release());
  }
  std::size_t size = 0;
  void* const serialised = lo_bundle_serialise(bundle.get(), nullptr, &size);
  return take(serialised, size);
}

TimeTag time_tag(double unix_s) {
  const double ntp_s = unix_s + kUnixEpochNtp;
  const double whole = std::floor(ntp_s);
  const auto fraction = static_cast<TimeTag>((ntp_s - whole) * kTicksPerSecond);
  return static_cast<TimeTag>(whole) << 32 | fraction;
}

double unix_seconds(TimeTag time) {
  return static_cast<double>(time >> 32) - kUnixEpochNtp + static_cast<double>(time & 0xffffffff) / kTicksPerSecond;
}

Result<OscUrl> parse_url(std::string_view url) {
  constexpr std::string_view kScheme = "osc.udp://";
  const auto refuse = [&] {
    return fail(ErrorKind::bad_input, "'{}' is not a daemon's address; write it like osc.udp://127.0.0.1:7770", url);
  };
  if (!url.starts_with(kScheme)) return refuse();
  std::string_view rest = url.substr(kScheme.size());
  if (rest.ends_with('/')) rest.remove_suffix(1);
  const std::size_t colon = rest.rfind(':');
  if (colon == rest.npos || colon == 0) return refuse();
  std::string_view host = rest.substr(0, colon);
  const bool in_brackets = host.starts_with('[') && host.ends_with(']');
  if (in_brackets) host = host.substr(1, host.size() - 2);
  if (host.empty() || in_brackets != (host.find(':') != host.npos)) return refuse();
  const std::string_view digits = rest.substr(colon + 1);
  std::uint16_t port = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc() || stop != digits.data() + digits.size() || port == 0) return refuse();
  return OscUrl{std::string(host), port};
}

}  // namespace ringdown::wire
