#include "protocol/wire/packet.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

// Checking a packet before liblo sees it
//
// One pass over the bytes, element by element (OSC 1.0): split() tells a bundle from a message, split_bundle() takes
// the elements of a bundle one after the other, check_message() takes address, type tags and arguments off the front of
// a message and must arrive exactly at its end. Every length is compared with the bytes that are left before anything
// is taken, and bundles may nest kMaxBundle deep, so the pass reads no byte outside of the packet and its stack is
// bounded, whatever was sent. A message in an inner bundle carries the later of all time tags around it.
namespace ringdown::wire {
namespace {

constexpr std::string_view kBundleMark("#bundle", 8);  // with its terminating zero
constexpr std::size_t kBundleHead = 16;                // the mark and the timetag

tl::unexpected<Error> refuse(const std::string& what) { return fail(ErrorKind::bad_input, "no OSC packet: " + what); }

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <class Unsigned>
Unsigned big_endian(std::span<const std::byte> bytes) {
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) value = value << 8 | std::to_integer<Unsigned>(bytes[i]);
  return value;
}

// Takes an OSC string off the front: ended by a zero, padded with zeros to a multiple of 4.
std::optional<std::string_view> take_string(std::span<const std::byte>& rest) {
  const std::string_view text = as_text(rest);
  const std::size_t length = text.find('\0');
  if (length == text.npos) return std::nullopt;
  const std::size_t padded = (length / 4 + 1) * 4;
  if (padded > text.size()) return std::nullopt;
  if (text.substr(length, padded - length).find_first_not_of('\0') != text.npos) return std::nullopt;
  rest = rest.subspan(padded);
  return text.substr(0, length);
}

// Takes an OSC blob off the front: its size, its bytes, and zeros up to a multiple of 4.
bool take_blob(std::span<const std::byte>& rest) {
  if (rest.size() < 4) return false;
  const std::size_t size = big_endian<std::uint32_t>(rest);
  rest = rest.subspan(4);
  if (size > rest.size()) return false;
  const std::size_t padded = (size + 3) / 4 * 4;
  if (padded > rest.size()) return false;
  if (std::ranges::any_of(rest.subspan(size, padded - size), [](std::byte b) { return b != std::byte{}; }))
    return false;
  rest = rest.subspan(padded);
  return true;
}

bool is_address(std::string_view text) {
  const auto printable = [](char c) { return c > ' ' && c <= '~'; };
  return text.size() <= kMaxAddress && text.starts_with('/') && std::ranges::all_of(text, printable);
}

// Takes one argument of type `type` off the front.
Result<void> take_argument(char type, const std::string& where, std::span<const std::byte>& rest) {
  if (type == 's') {
    if (!take_string(rest)) return refuse(where + " is text that does not end or is not padded with zeros");
    return {};
  }
  if (type == 'b') {
    if (!take_blob(rest)) return refuse(where + " is a blob that is cut off or is not padded with zeros");
    return {};
  }
  const bool wide = type == 'h' || type == 'd';
  if (!wide && type != 'i' && type != 'f') {
    const bool printable = type > ' ' && type <= '~';
    return refuse(where + " has the type " + (printable ? std::string{'\'', type, '\''} : "of an unprintable letter") +
                  "; send i, h, f, d, s or b");
  }
  const std::size_t size = wide ? 8 : 4;
  if (rest.size() < size) return refuse(where + " is cut off");
  rest = rest.subspan(size);
  return {};
}

Result<void> check_message(std::span<const std::byte> rest) {
  const std::optional<std::string_view> address = take_string(rest);
  if (!address) return refuse("the address does not end or is not padded with zeros");
  if (!is_address(*address)) {
    return refuse("the address must begin with / and be of up to " + std::to_string(kMaxAddress) +
                  " printable characters");
  }
  const std::string name(*address);
  const std::optional<std::string_view> types = take_string(rest);
  if (!types || !types->starts_with(',')) return refuse(name + " has no type tags");
  if (types->size() - 1 > kMaxArguments) {
    return refuse(name + " has more than " + std::to_string(kMaxArguments) + " arguments");
  }
  for (std::size_t i = 1; i < types->size(); ++i) {
    const std::string where = name + " argument " + std::to_string(i);
    if (Result<void> taken = take_argument((*types)[i], where, rest); !taken) return taken;
  }
  if (!rest.empty()) return refuse(name + " has " + std::to_string(rest.size()) + " bytes too many");
  return {};
}

Result<void> split(std::span<const std::byte> element, TimeTag time, int depth, std::vector<RawMessage>& messages);

Result<void> split_bundle(std::span<const std::byte> bundle, TimeTag time, int depth,
                          std::vector<RawMessage>& messages) {
  if (depth > kMaxBundle) {
    return refuse("bundles nest deeper than " + std::to_string(kMaxBundle));
  }
  if (bundle.size() < kBundleHead) return refuse("a bundle is cut off in its timetag");
  time = std::max(time, big_endian<TimeTag>(bundle.subspan(kBundleMark.size())));
  std::span<const std::byte> rest = bundle.subspan(kBundleHead);
  while (!rest.empty()) {
    if (rest.size() < 4) return refuse("a bundle is cut off in the size of an element");
    const std::size_t size = big_endian<std::uint32_t>(rest);
    rest = rest.subspan(4);
    if (size > rest.size()) {
      return refuse("a bundle's element says it has " + std::to_string(size) + " bytes, but " +
                    std::to_string(rest.size()) + " are left");
    }
    if (Result<void> done = split(rest.first(size), time, depth, messages); !done) return done;
    rest = rest.subspan(size);
  }
  return {};
}

Result<void> split(std::span<const std::byte> element, TimeTag time, int depth, std::vector<RawMessage>& messages) {
  if (element.empty()) return refuse("it is empty");
  if (element.size() % 4 != 0) {
    return refuse("its length, " + std::to_string(element.size()) + " bytes, is no multiple of 4");
  }
  if (as_text(element).starts_with(kBundleMark)) return split_bundle(element, time, depth + 1, messages);
  if (Result<void> good = check_message(element); !good) return good;
  messages.push_back({time, element});
  return {};
}

}  // namespace

Result<std::vector<RawMessage>> split_packet(std::span<const std::byte> packet) {
  if (packet.size() > kMaxPacketBytes) {
    return refuse("it has more than " + std::to_string(kMaxPacketBytes) + " bytes");
  }
  std::vector<RawMessage> messages;
  if (Result<void> done = split(packet, 0, 0, messages); !done) return fail(done.error());
  for (RawMessage& message : messages) message.time = std::max(message.time, kImmediately);
  return messages;
}

}  // namespace ringdown::wire
