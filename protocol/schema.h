// The protocol: every address with its arguments, what it does, and what is answered.
//
// All of it comes from one table (table.cpp), written once: the parser, the formatter, docs/reference/protocol.md, the
// help texts of the `ringdown` program, and the conversion of command-line words. Nothing else lists an
// argument.
//
//   Result<Request> request = parse(message);            // the daemon
//   if (!request) reply(format(Fail{message.address, request.error().message}));
//   wire::Message message = format(Request(Strike{...}));   // a client, or the scene striking another daemon
//
// Strict where it matters: a number may come as any of the OSC types i h f d, but must be finite and in
// range, and whole where an integer is wanted (Pure Data sends 3 as the float 3.0). The 32-bit float nearest to a limit
// counts as the limit. A switch may also be T or F. Nil (N) in place of an optional argument leaves it out, and a
// single impulse (I) is a message without arguments. Text is never read as a number. Every refusal is one sentence that
// names the address and the argument. [any thread but audio: allocates]
#pragma once

#include "engine/base/result.h"
#include "protocol/lanes.h"
#include "protocol/reply.h"
#include "protocol/request.h"
#include "protocol/wire/message.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::protocol {

enum class ValueType {
  number,          // finite, least <= value <= most
  integer,         // whole, least <= value <= most
  flag,            // 0 or 1
  text,            // 1 to 4096 bytes without control characters
  any_text,        // whatever the daemon says
  name,            // the name of an object, new or old (names.h)
  object,          // an object by name or number
  object_or_none,  // the same, or "-" for none
  blob,            // bytes, a whole number of records of `min` of them, at most `max` records
};

// An argument's value after all checks; monostate where an optional object or number is absent.
using Value = std::variant<std::monostate, double, std::int32_t, std::string, ObjectRef, wire::Blob>;

struct ArgumentSpec {
  std::string_view name = "";   // "contact_time"
  std::string_view group = "";  // "impulse", of the three arguments of a vector; "" of one that stands alone
  ValueType type = ValueType::number;
  std::string_view unit = "";      // SI, "" for a pure number or text
  double min = 0, max = 0;         // for numbers and integers
  std::string_view sentence = "";  // what it means
  bool optional = false;           // may be left out, together with all that follow
  Value fallback = {};             // then it is this
};

struct AddressSpec {
  std::string_view address;             // "/object/{object}/strike": {object} is filled from the argument of that name
  std::string_view sentence;            // what it does
  std::vector<ArgumentSpec> arguments;  // those in the address first, then those of the message, in order
  std::string_view reply;               // the address of the answer when it succeeds, "" when silence is success
  std::string_view reply_number;        // what the number in /done is, "" for none
  wire::Message example;                // valid, and worth trying
  std::optional<Lane> lane;             // who handles a request, and when; none for a reply

  [[nodiscard]] std::size_t arguments_in_address() const { return address.find('{') == address.npos ? 0 : 1; }
};

// Every address a client may send, in the order of Request's alternatives.
std::span<const AddressSpec> addresses();
// Those of the verbs of the mixer (engine/synth/events/verbs.h), in the order of PublicVerbs.
std::span<const AddressSpec> verb_addresses();
// Every address the daemon may answer with, in the order of Reply's alternatives.
std::span<const AddressSpec> reply_addresses();

const AddressSpec& spec_of(const Request& request);
const AddressSpec& spec_of(const Reply& reply);

// The row that a concrete address belongs to ("/object/bell/gain"), or a sentence that suggests the nearest
// known one.
Result<const AddressSpec*> find_address(std::string_view address);

Result<Request> parse(const wire::Message& message);
Result<Reply> parse_reply(const wire::Message& message);

// A number of a request that lies outside of the table's range.
struct OutOfRange {
  std::size_t argument = 0;  // index in spec_of(request).arguments
  std::string complaint;     // "is 3; it must be a number from 0 to 0.1 s"
};

// The first such number, for requests that were made otherwise than by parse(). In the numbers before it, a 32-bit
// float nearest to a limit has become the limit, as in parse(). Allocates nothing if there is none.
std::optional<OutOfRange> find_out_of_range(Request& request);

// Fills the request of a verb: one number for each of its arguments, in order; an object is given by its number. Like
// find_out_of_range(), returns the first number that is wrong, and allocates nothing if there is none.
std::optional<OutOfRange> fill(MixerRequest& request, std::span<const double> numbers);

// Returns the name of an argument as a member or a parameter, with its unit: "contact_time_s". The arguments of a
// vector are one member: "impulse_ns".
std::string member_name(const ArgumentSpec& argument);

// The inverse of parse. Requests carry numbers as d, so that nothing is lost; replies as f (reply.h).
wire::Message format(const Request& request);
wire::Message format(const Reply& reply);

// A message from command-line words: each is converted to the type its argument wants, then everything is
// checked as parse() does. compose("/object/bell/gain", {"0.5"}).
Result<wire::Message> compose(std::string_view address, std::span<const std::string> words);

}  // namespace ringdown::protocol
