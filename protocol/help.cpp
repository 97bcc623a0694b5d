#include "protocol/help.h"

#include "protocol/convert.h"
#include "protocol/defaults.h"

#include <cctype>

namespace ringdown::protocol {
namespace {

constexpr std::string_view kHead = R"(# The protocol

<!-- Written by `ringdown protocol --markdown` from the table in protocol/table.cpp. Change it there. -->

Ringdown is played over OSC 1.0 by UDP, on port {port} of this computer unless the daemon was started with others. With
`--tcp PORT` it is as well over TCP, in SLIP frames as OSC 1.1 has it; with `--query PORT` the table below is served as
JSON over HTTP, as OSCQuery has it, for hosts that list what there is to control.

- **Units** are SI: m, kg, s, N s. Points and impulses are in the object's own frame, the one of its mesh.
- **Numbers** may be sent as any of the OSC types `i` `h` `f` `d`. They must be finite and in range, and whole where a
  whole number is wanted: Pure Data's 3.0 is 3. Text is type `s`, records are a blob, type `b`. Arguments in [brackets]
  may be left out, from the right.
- **Objects** have a name (1 to 64 of `A-Z a-z 0-9 _ . -`, not digits only) and a number; both serve in an address:
  `/object/bell/strike`, `/object/0/strike`.
- **Contact time**: a strike that names none lasts 0.2 ms. An ideal impulse (0 s) excites every mode up to 20 kHz alike,
  which is brighter than any real mallet; a blow of length T falls off above 1/T. By Hertz's law (K. L. Johnson, Contact
  Mechanics, equation 11.24) a ball that meets steel at 1 m/s stays 0.07 ms if it is steel of 10 mm radius, and at 15 mm
  0.1 ms if it is hardwood, 0.2 ms hard plastic, 0.7 ms hard rubber.
- **Time**: a message outside a bundle is played at once, that is a fixed short latency after it arrived, so that the
  time between two messages is kept (`--latency`; one block of audio and a sixteenth unless set). A bundle's timetag says
  when its messages are played, to the sample; one whose time is past is played at once, and counted. It may lie up to an
  hour ahead. Bundles nest up to 4 deep, and an inner one is never earlier than the one around it.
- **Answers** go to the port the request came from. Every refusal is `/fail address sentence`, and the sentence names
  the argument. Where no answer is listed, silence is success; send `/sync` to be sure that all before it has arrived.
- **Patterns** of OSC 1.0 stand for objects, and for what follows them: `/object/glass*/gain`,
  `/object/{bell,bowl}/[!f]*`. `?` is one character, `*` any number, `[a-z]` and `[!a-z]` a set, `{low,high}` words. They
  are matched with names, not numbers; one that matches nothing is a `/fail`.
- **Limits**: 64 arguments, an address of 256 characters; [limits.md](../use/limits.md) has them all. A datagram with any fault in
  it is refused whole. In a flood, strikes on one point of an object less than `--merge` apart (1 ms unless set) become
  one of their summed impulse, so that none is lost; below 64 strikes in that time all pass as they are.

)";

std::string accepted_text(const ArgumentSpec& spec) {
  std::string text = expectation(spec);
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string fallback_text(const ArgumentSpec& spec) {
  const bool absent = std::holds_alternative<std::monostate>(spec.fallback);
  return absent ? "absent" : value_text(spec.fallback);
}

std::string argument_table(const AddressSpec& spec) {
  if (spec.arguments.empty()) return "";
  std::string table = "\n| argument | meaning | accepted | if left out |\n|---|---|---|---|\n";
  for (const ArgumentSpec& argument : spec.arguments) {
    table.append("| `").append(argument.name).append("` | ").append(argument.sentence).append(" | ");
    table += expectation(argument) + " | " + (argument.optional ? fallback_text(argument) : "") + " |\n";
  }
  return table;
}

std::string answer_text(const AddressSpec& spec) {
  if (spec.reply.empty()) return "Answer: none.";
  std::string text = "Answer: `" + std::string(spec.reply);
  if (spec.reply == "/done") text.append(" ").append(spec.address);
  text += "`";
  if (!spec.reply_number.empty()) text.append(" and ").append(spec.reply_number);
  return text + ".";
}

// When a request happens, if a bundle's time tag says when it should.
std::string_view time_text(Lane lane) {
  switch (lane) {
    case Lane::mixer:
    case Lane::timed_worker:
      return "Happens at its time tag.";
    case Lane::worker:
    case Lane::file:
    case Lane::question:
      return "Happens after all that was sent before; a time tag does not delay it.";
    case Lane::subscription:
    case Lane::daemon:
      return "Happens on arrival; a time tag does not delay it.";
  }
  return "";
}

std::string example_text(const AddressSpec& spec) {
  if (const std::string command = oscsend_command(spec); !command.empty()) return "```\n" + command + "\n```";
  return "`oscsend` sends no blobs; [clients/python/strike.py](../../clients/python/strike.py) does.";
}

std::string request_section(const AddressSpec& spec) {
  return "### `" + signature(spec) + "`\n\n" + std::string(spec.sentence) + "\n" + argument_table(spec) + "\n" +
         answer_text(spec) + " " + std::string(time_text(*spec.lane)) + "\n\n" + example_text(spec) + "\n\n";
}

std::string reply_section(const AddressSpec& spec) {
  return "### `" + signature(spec) + "`\n\n" + std::string(spec.sentence) + "\n" + argument_table(spec) + "\n";
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
  std::string text = std::string(spec.sentence) + " " + accepted_text(spec);
  if (spec.optional) text += "; " + fallback_text(spec) + " if left out";
  return text + ".";
}

std::string overview() {
  std::string text;
  for (const AddressSpec& spec : addresses()) text += signature(spec) + "\n    " + std::string(spec.sentence) + "\n";
  return text;
}

std::string markdown() {
  std::string text(kHead);
  text.replace(text.find("{port}"), 6, std::to_string(kDefaultPort));
  text += "## What you can send\n\n";
  for (const AddressSpec& spec : addresses()) text += request_section(spec);
  text += "## What is answered\n\nAnswers use the OSC types `i`, `f` and `s` only.\n\n";
  for (const AddressSpec& spec : reply_addresses()) text += reply_section(spec);
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
  const std::string target = "oscsend osc.udp://127.0.0.1:" + std::to_string(kDefaultPort) + " " + spec.example.address;
  return types.empty() ? target : target + " " + types + words;
}

}  // namespace ringdown::protocol
