#include "protocol/help.h"

#include "engine/base/formatted.h"
#include "protocol/convert.h"
#include "protocol/defaults.h"

#include <cctype>
#include <limits>

namespace ringdown::protocol {
namespace {

constexpr std::string_view kHead = R"(# The protocol

<!-- Written by `ringdown protocol --markdown` from the table in protocol/table.cpp. Change it there. -->

The daemon listens for OSC 1.0 and 1.1 over UDP (IPv4 and IPv6), on port {port} of this computer by default. With `--tcp PORT`
it also accepts OSC over TCP, in SLIP frames (OSC 1.1) or with a length before each packet (OSC 1.0), and answers in the same
framing. With `--query PORT` it serves this list as JSON over HTTP (OSCQuery). With liblo's `oscsend`:

    oscsend osc.udp://127.0.0.1:{port} /load ss bell presets/banks/bronze-bell.glb
    oscsend osc.udp://127.0.0.1:{port} /object/bell/strike ffffff 0.05 0 0.02 -0.02 0 0

- **Units** are SI. Points, impulses and forces are in the object's own frame, which is that of its mesh.
- **Arguments** come in the order listed; those with a default may be omitted, from the right. Numbers may be of type `i`, `h`,
  `f` or `d`; 3.0 counts as a whole number. If an `f` cannot hold a limit exactly, such as 0.1, the nearest `f` is accepted.
  Switches (0 or 1 below) may also be `T` or `F`. Text is type `s` or `S`, 1 to 4096 bytes without control characters; blobs are
  type `b`. An `N` omits an argument that has a default. A single `I` stands for no arguments. Brackets of arrays are ignored. No
  request takes `c`, `m`, `r` or `t`. A message without arguments may lack its type tags.
- **Objects** have a name (1 to 64 of `A-Z a-z 0-9 _ . -`, not digits only) and a number. Addresses take either:
  `/object/bell/strike`, `/object/0/strike`. Groups are named in the same way.
- **Paths** are absolute, or relative to the folder in which the daemon was started.
- **An impulse** is mass times change of velocity. **Contact time** is the length of a half-sine pulse, which excites little
  above the inverse of this time; 0 s excites all modes alike. By Hertz's law (K. L. Johnson, Contact Mechanics, equation 11.24)
  a ball that hits steel at 1 m/s touches it for 0.07 ms (steel, radius 10 mm), 0.1 ms (hardwood, 15 mm), 0.2 ms (hard plastic)
  or 0.7 ms (hard rubber).
- **Time.** A message outside a bundle sounds at a fixed short latency (`--latency`) after its arrival. A bundle sounds at its
  time tag, to the sample. A tag may lie up to an hour ahead; a bundle with a tag in the past is played at once and counted.
  Bundles may be nested 4 deep; a message has the latest tag of the bundles around it. Below, *timed* requests obey the tag,
  requests *in order* follow everything sent before, and *immediate* requests are handled on arrival.
- **Answers** go to the sender's port. A refusal is `/fail`. Unless another answer is named, a successful timed request has no
  answer, and any other has `/done`. `/sync` is answered when everything before it has been handled.
- **Patterns** of OSC 1.0 match object names, and what follows them: `/object/glass*/gain`, `/object/{bell,bowl}/[!f]*`. `?` is
  one character, `*` any number, `[a-z]` and `[!a-z]` a set, `{low,high}` words. A pattern that matches nothing is refused.
- **Limits**: 64 arguments, an address of 256 characters, and [others](../use/limits.md). A faulty datagram is refused as a
  whole. If 64 strikes arrive within `--merge` (1 ms by default), further strikes on one point are merged into one with the sum
  of their impulses.

)";

std::string accepted_text(const ArgumentSpec& spec) {
  std::string text = expectation(spec);
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

constexpr std::int32_t kAnyInteger = std::numeric_limits<std::int32_t>::max();

std::string fallback_text(const ArgumentSpec& spec) {
  if (std::holds_alternative<std::monostate>(spec.fallback)) return "none";
  return spec.fallback == Value(kAnyInteger) ? "all" : value_text(spec.fallback);
}

// The values of an argument as the page states them: "0 to 60 s", "whole, 0 to 15", "text". Limits that only keep
// numbers finite are left out.
std::string brief_range(const ArgumentSpec& spec) {
  constexpr double kAnyNumber = 1e30;
  const bool whole = spec.type == ValueType::integer;
  if (!whole && spec.type != ValueType::number) {
    return spec.type == ValueType::text || spec.type == ValueType::name || spec.type == ValueType::object
               ? ""
               : expectation(spec);
  }
  const std::string unit(spec.unit);
  if (spec.max == (whole ? kAnyInteger : kAnyNumber) && (spec.min == 0 || spec.min == -spec.max)) {
    return whole ? "whole" : unit;
  }
  const std::string range =
      spec.min == -spec.max ? "±" + number_text(spec.max) : number_text(spec.min) + " to " + number_text(spec.max);
  return (whole ? "whole, " : "") + range + (unit.empty() ? "" : " " + unit);
}

// All that a client has to know to send an argument; for an argument of a reply, its unit alone.
std::string values_text(const ArgumentSpec& argument, bool is_request) {
  if (!is_request) return std::string(argument.unit);
  std::string values = brief_range(argument);
  if (argument.optional) values += (values.empty() ? "default " : "; default ") + fallback_text(argument);
  return values;
}

constexpr std::string_view kTheSame = "The same.";

// Returns whether `next` is one more component of the vector, or one more argument of the kind, that `first` begins.
bool continues(const ArgumentSpec& first, const ArgumentSpec& next, bool is_request) {
  const bool same =
      next.sentence == "Its y component." || next.sentence == "Its z component." || next.sentence == kTheSame;
  return same && values_text(first, is_request) == values_text(next, is_request) && first.optional == next.optional;
}

// One line for each argument that is not in the address; the components of a vector, and arguments of one kind, share a
// line.
std::string argument_list(const AddressSpec& spec) {
  std::string list;
  const auto arguments = std::span(spec.arguments).subspan(spec.arguments_in_address());
  for (std::size_t i = 0; i < arguments.size();) {
    const ArgumentSpec& first = arguments[i];
    list.append("- `").append(first.name);
    for (++i; i < arguments.size() && continues(first, arguments[i], spec.lane.has_value()); ++i)
      list.append(arguments[i].sentence == kTheSame ? "`, `" : " ").append(arguments[i].name);
    list.append("`: ").append(first.sentence);
    const std::string values = values_text(first, spec.lane.has_value());
    list += (values.empty() ? "" : " (" + values + ")") + "\n";
  }
  return list.empty() ? "" : list + "\n";
}

// When a request happens, in the words of the page's head.
std::string_view time_text(Lane lane) {
  switch (lane) {
    case Lane::mixer:
    case Lane::timed_worker:
      return "Timed";
    case Lane::worker:
    case Lane::file:
    case Lane::question:
      return "In order";
    case Lane::subscription:
    case Lane::daemon:
      return "Immediate";
  }
  return "";
}

// Returns how a request is answered, or nothing if the page's head says it already.
std::string answer_text(const AddressSpec& spec) {
  const std::string_view usual = time_text(*spec.lane) == "Timed" ? "" : "/done";
  if (spec.reply == usual && spec.reply_number.empty()) return "";
  std::string text = formatted("; answers `{}`", spec.reply);
  if (!spec.reply_number.empty()) text.append(" and ").append(spec.reply_number);
  return text;
}

std::string section(const AddressSpec& spec) {
  const std::string when = spec.lane ? formatted(" {}{}.", time_text(*spec.lane), answer_text(spec)) : "";
  return "### `" + std::string(spec.address) + "`\n\n" + std::string(spec.sentence) + when + "\n\n" +
         argument_list(spec);
}

// An argument for oscsend: its type letter and its word. Numbers go as f, as most clients send them.
std::pair<char, std::string> as_word(const wire::Argument& argument) {
  if (const auto* text = std::get_if<std::string>(&argument)) return {'s', *text};
  if (const auto* integer = std::get_if<std::int32_t>(&argument)) return {'i', std::to_string(*integer)};
  return {'f', number_text(std::get<double>(argument))};
}

}  // namespace

std::string signature(const AddressSpec& spec) {
  std::string text(spec.address);
  for (const ArgumentSpec& argument : std::span(spec.arguments).subspan(spec.arguments_in_address())) {
    text.append(argument.optional ? " [" : " ").append(argument.name).append(argument.optional ? "]" : "");
  }
  return text;
}

std::string describe(const ArgumentSpec& spec) {
  std::string text = formatted("{} {}", spec.sentence, accepted_text(spec));
  if (spec.optional) text += "; " + fallback_text(spec) + " if left out";
  return text + ".";
}

std::string overview() {
  std::string text;
  for (const AddressSpec& spec : addresses()) text += formatted("{}\n    {}\n", signature(spec), spec.sentence);
  return text;
}

std::string markdown() {
  std::string text(kHead);
  for (auto at = text.find("{port}"); at != text.npos; at = text.find("{port}", at))
    text.replace(at, 6, std::to_string(kDefaultPort));
  text += "## Requests\n\n";
  for (const AddressSpec& spec : addresses()) text += section(spec);
  text += "## Answers\n\nAnswers use the OSC types `i`, `f`, `s` and, for bytes and samples, `b`.\n\n";
  for (const AddressSpec& spec : reply_addresses()) text += section(spec);
  text.pop_back();
  return text;
}

std::string oscsend_command(const AddressSpec& spec) {
  std::string types, words;
  for (const wire::Argument& argument : spec.example.arguments) {
    if (std::holds_alternative<wire::Blob>(argument)) return "";
    const auto [type, word] = as_word(argument);
    types += type;
    words += " " + word;
  }
  const std::string target = formatted("oscsend osc.udp://127.0.0.1:{} {}", kDefaultPort, spec.example.address);
  return types.empty() ? target : target + " " + types + words;
}

}  // namespace ringdown::protocol
