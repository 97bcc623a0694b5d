#include "server/osc_namespace.h"

#include "protocol/convert.h"
#include "protocol/help.h"
#include "protocol/names.h"
#include "protocol/schema.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace ringdown::server {
namespace {

using protocol::AddressSpec;
using protocol::ArgumentSpec;
using protocol::ValueType;

constexpr std::string_view kPlaceholder = "{object}";
constexpr const char *kContainer = "0", *kWriteOnly = "2";  // OSCQuery's ACCESS

char type_of(const ArgumentSpec& argument) {
  switch (argument.type) {
    case ValueType::number:
      return 'f';
    case ValueType::integer:
    case ValueType::flag:
      return 'i';
    case ValueType::blob:
      return 'b';
    case ValueType::text:
    case ValueType::any_text:
    case ValueType::name:
    case ValueType::object:
    case ValueType::object_or_none:
      break;
  }
  return 's';
}

bool has_range(const ArgumentSpec& argument) {
  return argument.type == ValueType::number || argument.type == ValueType::integer || argument.type == ValueType::flag;
}

// JSON's texts: a string, a number, an array of values, an object of values.
std::string json_of(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < ' ') {
      json += formatted("\\u{:04x}", static_cast<unsigned>(c));
      continue;
    }
    if (c == '"' || c == '\\') json += '\\';
    json += c;
  }
  return json + '"';
}

std::string json_of(double number) {
  char text[64];
  const double size = std::abs(number);
  const bool is_short = size == 0 || (size >= 1e-4 && size < 1e15);
  const auto format = is_short ? std::chars_format::fixed : std::chars_format::scientific;
  std::string json(text, std::to_chars(text, std::end(text), number, format).ptr);
  if (json.find_first_of(".e") == json.npos) json += ".0";
  return json;
}

std::string array_of(const std::vector<std::string>& values) {
  std::string json;
  for (const std::string& value : values) json += (json.empty() ? "" : ",") + value;
  return "[" + json + "]";
}

using Attributes = std::map<std::string, std::string>;  // name, value as JSON

std::string object_of(const Attributes& attributes) {
  std::string json;
  for (const auto& [name, value] : attributes) json += (json.empty() ? "" : ",") + json_of(name) + ":" + value;
  return "{" + json + "}";
}

// A place in the namespace.
struct Node {
  Attributes attributes;
  std::map<std::string, Node> contents;

  // With CONTENTS, includes everything below the node.
  [[nodiscard]] Attributes all() const {
    Attributes all = attributes;
    Attributes below;
    for (const auto& [name, node] : contents) below[name] = object_of(node.all());
    if (!below.empty()) all["CONTENTS"] = object_of(below);
    return all;
  }
};

// The attributes of an address that are equal for all objects.
Attributes attributes_of(const AddressSpec& spec) {
  std::string types;
  std::vector<std::string> ranges, units;
  for (const ArgumentSpec& argument : std::span(spec.arguments).subspan(spec.arguments_in_address())) {
    types += type_of(argument);
    ranges.push_back(has_range(argument) ? object_of({{"MIN", json_of(argument.min)}, {"MAX", json_of(argument.max)}})
                                         : "null");
    units.push_back(json_of(argument.unit));
  }
  Attributes attributes = {{"ACCESS", kWriteOnly},
                           {"DESCRIPTION", json_of(formatted("{}: {}", signature(spec), spec.sentence))}};
  if (types.empty()) return attributes;
  attributes["TYPE"] = json_of(types);
  attributes["RANGE"] = array_of(ranges);
  attributes["UNIT"] = array_of(units);
  return attributes;
}

// Puts an address at `path`, and makes the containers above it.
void place(Node& root, const std::string& path, const Attributes& attributes) {
  Node* at = &root;
  for (std::size_t slash = 0; slash != path.npos;) {
    const std::size_t next = path.find('/', slash + 1);
    Node& child = at->contents[path.substr(slash + 1, next == path.npos ? next : next - slash - 1)];
    if (child.attributes.empty()) {
      child.attributes = {{"ACCESS", kContainer}, {"FULL_PATH", json_of(path.substr(0, next))}};
    }
    at = &child;
    slash = next;
  }
  // It may be a container as well: /clear, /scene/clear.
  for (const auto& [name, value] : attributes) at->attributes[name] = value;
}

Node make_namespace(bool with_object) {
  Node root;
  root.attributes = {{"FULL_PATH", json_of("/")},
                     {"ACCESS", kContainer},
                     {"DESCRIPTION", json_of("Ringdown: solid objects that ring")}};
  for (const AddressSpec& spec : protocol::addresses()) {
    std::string path(spec.address);
    if (spec.arguments_in_address() > 0) {
      if (!with_object) continue;
      path.replace(path.find(kPlaceholder), kPlaceholder.size(), 1, Description::kAnyObject);
    }
    place(root, path, attributes_of(spec));
  }
  return root;
}

// The namespace without objects, or with one whose name is kAnyObject.
const Node& whole_namespace(bool with_object) {
  static const Node without = make_namespace(false), with = make_namespace(true);
  return with_object ? with : without;
}

struct Place {
  const Node* node;
  std::string object;  // the name that stands for kAnyObject; empty where the path names no object
};

Result<Place> place_at(const std::string& path, const std::vector<std::string>& names) {
  Place place{&whole_namespace(!names.empty()), ""};
  for (std::size_t slash = 0; slash + 1 < path.size();) {
    const std::size_t next = std::min(path.find('/', slash + 1), path.size());
    std::string name = path.substr(slash + 1, next - slash - 1);
    const bool asks_for_any = name.find(Description::kAnyObject) != name.npos;
    if (path.substr(0, slash + 1) == protocol::kObjectPrefix && std::ranges::find(names, name) != names.end()) {
      place.object = std::exchange(name, std::string(1, Description::kAnyObject));
    }
    const auto below = place.node->contents.find(name);
    if (asks_for_any || below == place.node->contents.end()) {
      return fail(ErrorKind::bad_input, "there is no address " + path);
    }
    place.node = &below->second;
    slash = next;
  }
  return place;
}

std::string with_name(std::string text, std::string_view name) {
  for (std::size_t at = 0; (at = text.find(Description::kAnyObject, at)) != text.npos; at += name.size()) {
    text.replace(at, 1, name);
  }
  return text;
}

}  // namespace

Description::Description(std::string before, std::string each, std::string after, ObjectNames names)
    : before_(std::move(before)), each_(std::move(each)), after_(std::move(after)), names_(std::move(names)) {}

std::size_t Description::size() const {
  std::size_t size = before_.size() + after_.size();
  if (!names_) return size;
  const auto places = static_cast<std::size_t>(std::ranges::count(each_, kAnyObject));
  for (const std::string& name : *names_) size += each_.size() - places + places * name.size() + 1;
  return size - 1;  // no comma before the first
}

bool Description::next_piece() {
  const std::size_t count = names_ ? names_->size() : 0, piece = next_++;
  done_ = 0;
  piece_.clear();
  if (piece == 0) {
    piece_ = before_;
  } else if (piece <= count) {
    piece_ = (piece > 1 ? "," : "") + with_name(each_, (*names_)[piece - 1]);
  } else if (piece == count + 1) {
    piece_ = after_;
  }
  return piece <= count + 1;
}

std::size_t Description::read(std::span<char> target) {
  std::size_t filled = 0;
  while (filled < target.size() && (done_ < piece_.size() || next_piece())) {
    const std::size_t count = piece_.copy(target.data() + filled, target.size() - filled, done_);
    done_ += count;
    filled += count;
  }
  return filled;
}

Result<Description> describe(std::string_view path, std::string_view attribute, const ObjectNames& names) {
  const auto place = place_at(std::string(path), *names);
  if (!place) return fail(place);
  const Attributes all = place->node->all();
  std::string text;
  if (attribute.empty()) {
    text = object_of(all);
  } else if (const auto found = all.find(std::string(attribute)); found != all.end()) {
    text = object_of(Attributes{*found});
  }
  if (!place->object.empty()) return Description(with_name(std::move(text), place->object));
  const std::string any_object(1, Description::kAnyObject);
  const std::string key = json_of(any_object) + ":";
  const std::size_t at = text.find(key);
  if (at == text.npos) return Description(std::move(text));
  const Node& objects = whole_namespace(true).contents.at("object");
  std::string each = key + object_of(objects.contents.at(any_object).all());
  return Description(text.substr(0, at), each, text.substr(at + each.size()), names);
}

std::string describe_host(const std::string& name, const std::string& osc_address, std::uint16_t osc_port) {
  const std::string yes = "true";
  return object_of(
      {{"NAME", json_of(name)},
       {"OSC_IP", json_of(osc_address)},
       {"OSC_PORT", std::to_string(osc_port)},
       {"OSC_TRANSPORT", json_of("UDP")},
       {"EXTENSIONS",
        object_of({{"ACCESS", yes}, {"DESCRIPTION", yes}, {"RANGE", yes}, {"TYPE", yes}, {"UNIT", yes}})}});
}

}  // namespace ringdown::server
