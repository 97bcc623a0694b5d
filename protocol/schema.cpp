#include "protocol/schema.h"

#include "protocol/convert.h"
#include "protocol/fields.h"
#include "protocol/names.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <charconv>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace ringdown::protocol {
namespace {

constexpr std::string_view kPlaceholder = "{object}";

std::vector<AddressSpec> specs_of(const std::vector<Row>& rows) {
  std::vector<AddressSpec> specs;
  for (const Row& row : rows) specs.push_back(row.spec);
  return specs;
}

// "/object/bell/gain" -> "bell"; empty for an address without an object.
std::string_view object_in(std::string_view address) {
  if (!address.starts_with(kObjectPrefix)) return {};
  address.remove_prefix(kObjectPrefix.size());
  return address.substr(0, address.find('/'));
}

std::string replace_once(std::string_view text, std::string_view what, std::string_view with) {
  const std::size_t at = text.find(what);
  if (what.empty() || at == text.npos) return std::string(text);
  return std::string(text.substr(0, at)).append(with).append(text.substr(at + what.size()));
}

// "/object/bell/gain" -> "/gain"; nothing else changes.
std::string_view without_object(std::string_view address) {
  if (!address.starts_with(kObjectPrefix)) return address;
  return address.substr(kObjectPrefix.size() + object_in(address).size());
}

// "/object/bell/gain" -> "/object/{object}/gain"
std::string skeleton_of(std::string_view address) {
  if (!address.starts_with(kObjectPrefix)) return std::string(address);
  return std::string(kObjectPrefix).append(kPlaceholder).append(without_object(address));
}

// Levenshtein's distance: the fewest letters to insert, remove or change.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

// Finds the row of an address by hashing, in a time that does not depend on the number of rows or objects.
struct Index {
  std::unordered_map<std::string_view, std::size_t> plain, of_object;  // the latter by what follows the object

  explicit Index(const std::vector<Row>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const AddressSpec& spec = rows[i].spec;
      (spec.arguments_in_address() ? of_object : plain)[without_object(spec.address)] = i;
    }
  }
  [[nodiscard]] std::optional<std::size_t> find(std::string_view address) const {
    const auto& rows = address.starts_with(kObjectPrefix) ? of_object : plain;
    const auto found = rows.find(without_object(address));
    return found == rows.end() ? std::nullopt : std::optional(found->second);
  }
};

// The number of the row.
Result<std::size_t> find_row(const std::vector<Row>& rows, const Index& index, std::string_view address) {
  constexpr std::size_t kMaxAddress = 256;
  if (address.size() > kMaxAddress)
    return fail(ErrorKind::bad_input, quote(address) + " is not an address: it is too long");
  if (const auto row = index.find(address)) return *row;
  const std::string skeleton = skeleton_of(address);
  const auto distance = [&](const Row& row) { return edit_distance(skeleton, row.spec.address); };
  const Row& nearest = *std::ranges::min_element(rows, {}, distance);
  return fail(ErrorKind::bad_input, "{} is not an address; the nearest is {}", quote(address), nearest.spec.address);
}

// "x y z [contact_time]"
std::string argument_names(const AddressSpec& spec) {
  std::string names;
  for (const ArgumentSpec& argument : std::span(spec.arguments).subspan(spec.arguments_in_address())) {
    const std::string name(argument.name);
    names += (names.empty() ? "" : " ") + (argument.optional ? "[" + name + "]" : name);
  }
  return names.empty() ? "no arguments" : names;
}

// Sentences about one argument: `position` counts from 1 in the message, 0 stands for the one in the address.
std::string about(const wire::Message& message, const ArgumentSpec& spec, std::size_t position,
                  const std::string& what) {
  const std::string where = position == 0 ? "" : formatted("argument {} ", position);
  return formatted("{}: {}({}) {}", message.address, where, spec.name, what);
}

bool is_tag(const wire::Argument& argument, char type) {
  const auto* tag = std::get_if<wire::Tag>(&argument);
  return tag && tag->type == type;
}

// Fills the row's struct at `base` from the address and the arguments.
Result<void> parse_row(const Row& row, const wire::Message& message, void* base) {
  const AddressSpec& spec = row.spec;
  const std::size_t in_address = spec.arguments_in_address();
  const std::size_t max = spec.arguments.size() - in_address;
  const bool is_trigger = message.arguments.size() == 1 && is_tag(message.arguments[0], 'I');
  const std::size_t given_count = is_trigger ? 0 : message.arguments.size();
  if (given_count > max) {
    return fail(ErrorKind::bad_input, "{}: argument {} is one too many; it takes {}", message.address, max + 1,
                argument_names(spec));
  }
  for (std::size_t i = 0; i < spec.arguments.size(); ++i) {
    const ArgumentSpec& argument = spec.arguments[i];
    const std::size_t position = i < in_address ? 0 : i - in_address + 1;
    if (position > given_count) {
      if (argument.optional) break;
      return fail(ErrorKind::bad_input,
                  about(message, argument, position, "is missing; it takes " + argument_names(spec)));
    }
    if (position > 0 && argument.optional && is_tag(message.arguments[position - 1], 'N')) continue;
    const wire::Argument given =
        position == 0 ? wire::Argument(std::string(object_in(message.address))) : message.arguments[position - 1];
    const Result<Value> value = convert(argument, given);
    if (!value) return fail(value.error().kind, about(message, argument, position, value.error().message));
    row.fields[i].write(base, *value);
  }
  return {};
}

// Requests keep every digit; replies use only what Pure Data can read.
wire::Argument to_argument(const Value& value, bool is_request) {
  if (const auto* number = std::get_if<double>(&value)) {
    return is_request ? wire::Argument(*number) : wire::Argument(static_cast<float>(*number));
  }
  if (const auto* integer = std::get_if<std::int32_t>(&value)) return *integer;
  if (const auto* blob = std::get_if<wire::Blob>(&value)) return *blob;
  if (const auto* object = std::get_if<ObjectRef>(&value); object && object->number) {
    return static_cast<std::int32_t>(*object->number);
  }
  return value_text(value);
}

// A word as the argument wants it; one that does not fit stays text, and the parser says why.
wire::Argument from_word(const ArgumentSpec& spec, const std::string& word) {
  const bool is_text =
      spec.type != ValueType::number && spec.type != ValueType::integer && spec.type != ValueType::flag;
  double number = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool is_number = error == std::errc() && stop == word.data() + word.size();
  if (is_text || !is_number) return word;
  return number;
}

}  // namespace

wire::Message format_row(const Row& row, const void* base) {
  wire::Message message{std::string(row.spec.address), {}};
  for (std::size_t i = 0; i < row.fields.size(); ++i) {
    const Value value = row.fields[i].read(base);
    const ArgumentSpec& spec = row.spec.arguments[i];
    const bool absent = std::holds_alternative<std::monostate>(value);
    if (absent && spec.type != ValueType::object_or_none) break;
    if (i < row.spec.arguments_in_address()) {
      message.address = replace_once(message.address, kPlaceholder, value_text(value));
    } else {
      message.arguments.push_back(to_argument(value, row.spec.lane.has_value()));
    }
  }
  return message;
}

std::span<const AddressSpec> addresses() {
  static const std::vector<AddressSpec> specs = specs_of(request_table().rows);
  return specs;
}

std::span<const AddressSpec> verb_addresses() { return addresses().first(VerbRequests::kCount); }

std::span<const AddressSpec> reply_addresses() {
  static const std::vector<AddressSpec> specs = specs_of(reply_table().rows);
  return specs;
}

const AddressSpec& spec_of(const Request& request) { return addresses()[request.index()]; }
const AddressSpec& spec_of(const Reply& reply) { return reply_addresses()[reply.index()]; }

namespace {

Result<std::size_t> find_request(std::string_view address) {
  static const Index index(request_table().rows);
  return find_row(request_table().rows, index, address);
}

template <class List>
Result<OneOf<List>> parse_any(const Table<List>& table, std::size_t row, const wire::Message& message) {
  OneOf<List> any = table.blanks[row];
  if (const auto good = parse_row(table.rows[row], message, any.address()); !good) return fail(good);
  return any;
}

}  // namespace

Result<const AddressSpec*> find_address(std::string_view address) {
  return find_request(address).map([](std::size_t row) { return &request_table().rows[row].spec; });
}

std::optional<OutOfRange> find_out_of_range(Request& request) {
  const Row& row = request_table().rows[request.index()];
  for (std::size_t i = 0; i < row.fields.size(); ++i) {
    const ArgumentSpec& argument = row.spec.arguments[i];
    if (argument.type != ValueType::number && argument.type != ValueType::integer) continue;
    Value value = row.fields[i].read(request.address());
    const Result<void> good = fit(argument, value);
    if (!good) return OutOfRange{i, good.error().message};
    row.fields[i].write(request.address(), value);
  }
  return std::nullopt;
}

std::optional<OutOfRange> fill(MixerRequest& request, std::span<const double> numbers) {
  const Row& row = request_table().rows[request.index()];  // verbs come first in both lists
  assert(request.index() < VerbRequests::kCount && numbers.size() == row.fields.size());
  for (std::size_t i = 0; i < row.fields.size(); ++i) {
    const ArgumentSpec& argument = row.spec.arguments[i];
    if (argument.type == ValueType::object) {
      row.fields[i].write_number(request.address(), numbers[i]);
    } else if (const std::optional<double> fitted = fitted_number(argument, numbers[i])) {
      row.fields[i].write_number(request.address(), *fitted);
    } else {
      Value wrong = numbers[i];
      return OutOfRange{i, fit(argument, wrong).error().message};
    }
  }
  return std::nullopt;
}

std::string member_name(const ArgumentSpec& argument) {
  std::string name(argument.group.empty() ? argument.name : argument.group);
  std::string_view unit = argument.unit;
  if (unit == "degrees C") unit = "c";
  if (unit.empty() || unit.find('^') != unit.npos) return name;
  name += '_';
  for (const char c : unit) {
    if (c != ' ') name += c == '/' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return name;
}

Result<Request> parse(const wire::Message& message) {
  const auto row = find_request(message.address);
  if (!row) return fail(row);
  return parse_any(request_table(), *row, message);
}

Result<Reply> parse_reply(const wire::Message& message) {
  static const Index index(reply_table().rows);
  const auto row = find_row(reply_table().rows, index, message.address);
  if (!row) return fail(row);
  return parse_any(reply_table(), *row, message);
}

wire::Message format(const Request& request) {
  return format_row(request_table().rows[request.index()], request.address());
}
wire::Message format(const Reply& reply) { return format_row(reply_table().rows[reply.index()], reply.address()); }

Result<wire::Message> compose(std::string_view address, std::span<const std::string> words) {
  const auto row = find_request(address);
  if (!row) return fail(row);
  const AddressSpec& spec = request_table().rows[*row].spec;
  const auto wanted = std::span(spec.arguments).subspan(spec.arguments_in_address());
  wire::Message message{std::string(address), {}};
  for (std::size_t i = 0; i < words.size(); ++i) {
    message.arguments.push_back(i < wanted.size() ? from_word(wanted[i], words[i]) : wire::Argument(words[i]));
  }
  if (const auto request = parse_any(request_table(), *row, message); !request) return fail(request);
  return message;
}

}  // namespace ringdown::protocol
