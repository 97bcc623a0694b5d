#include "protocol/wire/packet.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

// Reading a packet
//
// The packet is read in one pass, element by element (OSC 1.0): split() tells a bundle from a message, split_bundle()
// takes the elements of a bundle one after another, read_message() takes address, type tags and arguments off the front
// of a message and must arrive exactly at its end. Every length is compared with the remaining bytes before anything is
// taken, and bundles may nest kMaxBundle deep, so the pass reads no byte outside the packet and its stack is bounded,
// whatever was sent. A message in an inner bundle gets the latest of all time tags around it.
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
std::optional<std::span<const std::byte>> take_blob(std::span<const std::byte>& rest) {
  if (rest.size() < 4) return std::nullopt;
  const std::size_t size = big_endian<std::uint32_t>(rest);
  rest = rest.subspan(4);
  if (size > rest.size()) return std::nullopt;
  const std::size_t padded = (size + 3) / 4 * 4;
  if (padded > rest.size()) return std::nullopt;
  if (std::ranges::any_of(rest.subspan(size, padded - size), [](std::byte b) { return b != std::byte{}; }))
    return std::nullopt;
  const auto blob = rest.first(size);
  rest = rest.subspan(padded);
  return blob;
}

bool is_address(std::string_view text) {
  const auto printable = [](char c) { return c > ' ' && c <= '~'; };
  return text.size() <= kMaxAddress && text.starts_with('/') && std::ranges::all_of(text, printable);
}

// Returns the number of bytes in a number of this type; 0 for other types.
std::size_t size_of(char type) {
  if (std::string_view("ifcmr").find(type) != std::string_view::npos) return 4;
  return std::string_view("hdt").find(type) != std::string_view::npos ? 8 : 0;
}

Argument to_number(char type, std::span<const std::byte> bytes) {
  switch (type) {
    case 'i':
      return static_cast<std::int32_t>(big_endian<std::uint32_t>(bytes));
    case 'h':
      return static_cast<std::int64_t>(big_endian<std::uint64_t>(bytes));
    case 'f':
      return std::bit_cast<float>(big_endian<std::uint32_t>(bytes));
    case 'd':
      return std::bit_cast<double>(big_endian<std::uint64_t>(bytes));
    default:
      return Tag{type};
  }
}

// Takes one argument of type `type` off the front, or says what is wrong with it.
tl::expected<Argument, std::string> take_argument(char type, std::span<const std::byte>& rest) {
  if (type == 'T' || type == 'F') return type == 'T';
  if (type == 'N' || type == 'I') return Tag{type};
  if (type == 's' || type == 'S') {
    const auto text = take_string(rest);
    if (!text) return tl::unexpected<std::string>("is text that does not end or is not padded with zeros");
    return std::string(*text);
  }
  if (type == 'b') {
    const auto blob = take_blob(rest);
    if (!blob) return tl::unexpected<std::string>("is a blob that is cut off or is not padded with zeros");
    return Blob(blob->begin(), blob->end());
  }
  const std::size_t size = size_of(type);
  if (size == 0) {
    const bool printable = type > ' ' && type <= '~';
    return tl::unexpected("has the type " + (printable ? std::string{'\'', type, '\''} : "of an unprintable letter") +
                          ", which OSC does not know; send i, h, f, d, s, b, T or F");
  }
  if (rest.size() < size) return tl::unexpected<std::string>("is cut off");
  const Argument number = to_number(type, rest);
  rest = rest.subspan(size);
  return number;
}

Result<Message> read_message(std::span<const std::byte> rest) {
  const std::optional<std::string_view> address = take_string(rest);
  if (!address) return refuse("the address does not end or is not padded with zeros");
  if (!is_address(*address)) {
    return refuse(formatted("the address must begin with / and be of up to {} printable characters", kMaxAddress));
  }
  Message message{std::string(*address), {}};
  if (rest.empty()) return message;  // old senders leave out the type tags
  if (rest.front() != std::byte{','}) {
    return refuse(
        formatted("{} has {} bytes of arguments, but its type tags are missing: send a text like ,f before them",
                  message.address, rest.size()));
  }
  const std::optional<std::string_view> types = take_string(rest);
  if (!types) return refuse(message.address + " has type tags that do not end or are not padded with zeros");
  int open = 0;  // number of open brackets
  for (const char type : types->substr(1)) {
    if (type == '[' || type == ']') {
      open += type == '[' ? 1 : -1;
      if (open < 0) break;
      continue;
    }
    if (message.arguments.size() == kMaxArguments) {
      return refuse(formatted("{} has more than {} arguments", message.address, kMaxArguments));
    }
    auto argument = take_argument(type, rest);
    if (!argument) {
      return refuse(formatted("{} argument {} {}", message.address, message.arguments.size() + 1, argument.error()));
    }
    message.arguments.push_back(std::move(*argument));
  }
  if (open != 0) return refuse(message.address + " has type tags with a bracket that has no partner");
  if (!rest.empty()) return refuse(formatted("{} has {} bytes too many", message.address, rest.size()));
  return message;
}

Result<void> split(std::span<const std::byte> element, TimeTag time, int depth, std::vector<TimedMessage>& messages);

Result<void> split_bundle(std::span<const std::byte> bundle, TimeTag time, int depth,
                          std::vector<TimedMessage>& messages) {
  if (depth > kMaxBundle) {
    return refuse(formatted("bundles nest deeper than {}", kMaxBundle));
  }
  if (bundle.size() < kBundleHead) return refuse("a bundle is cut off in its timetag");
  time = std::max(time, big_endian<TimeTag>(bundle.subspan(kBundleMark.size())));
  std::span<const std::byte> rest = bundle.subspan(kBundleHead);
  while (!rest.empty()) {
    if (rest.size() < 4) return refuse("a bundle is cut off in the size of an element");
    const std::size_t size = big_endian<std::uint32_t>(rest);
    rest = rest.subspan(4);
    if (size > rest.size()) {
      return refuse(formatted("a bundle's element says it has {} bytes, but {} are left", size, rest.size()));
    }
    if (Result<void> done = split(rest.first(size), time, depth, messages); !done) return done;
    rest = rest.subspan(size);
  }
  return {};
}

Result<void> split(std::span<const std::byte> element, TimeTag time, int depth, std::vector<TimedMessage>& messages) {
  if (element.empty()) return refuse("it is empty");
  if (element.size() % 4 != 0) {
    return refuse(formatted("its length, {} bytes, is not a multiple of 4", element.size()));
  }
  if (as_text(element).starts_with(kBundleMark)) return split_bundle(element, time, depth + 1, messages);
  Result<Message> message = read_message(element);
  if (!message) return fail(message);
  messages.push_back({std::max(time, kImmediately), std::move(*message)});
  return {};
}

}  // namespace

Result<std::vector<TimedMessage>> decode_packet(std::span<const std::byte> packet) {
  if (packet.size() > kMaxPacketBytes) {
    return refuse(formatted("it has more than {} bytes", kMaxPacketBytes));
  }
  std::vector<TimedMessage> messages;
  if (Result<void> done = split(packet, 0, 0, messages); !done) return fail(done);
  return messages;
}

}  // namespace ringdown::wire
