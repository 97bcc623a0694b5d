#include "server/osc_namespace.h"

#include "protocol/convert.h"
#include "protocol/help.h"
#include "protocol/names.h"
#include "protocol/schema.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

namespace ringdown::server {
namespace {

using nlohmann::json;
using protocol::AddressSpec;
using protocol::ArgumentSpec;
using protocol::ValueType;

constexpr std::string_view kPlaceholder = "{object}";
constexpr int kContainer = 0, kWriteOnly = 2;  // OSCQuery's ACCESS

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

// The attributes of an address that are the same for every object.
json leaf(const AddressSpec& spec) {
  std::string types;
  json ranges = json::array(), units = json::array();
  for (const ArgumentSpec& argument : std::span(spec.arguments).subspan(spec.arguments_in_address())) {
    types += type_of(argument);
    ranges.push_back(has_range(argument) ? json{{"MIN", argument.least}, {"MAX", argument.most}} : json(nullptr));
    units.push_back(argument.unit);
  }
  json node = {{"ACCESS", kWriteOnly}, {"DESCRIPTION", signature(spec) + ": " + std::string(spec.sentence)}};
  if (types.empty()) return node;
  node.update({{"TYPE", types}, {"RANGE", ranges}, {"UNIT", units}});
  return node;
}

// Puts `node` at `path`, and makes the containers above it.
void place(json& root, const std::string& path, const json& node) {
  json* at = &root;
  for (std::size_t slash = 0; slash != path.npos;) {
    const std::size_t next = path.find('/', slash + 1);
    json& child = (*at)["CONTENTS"][path.substr(slash + 1, next == path.npos ? next : next - slash - 1)];
    if (child.is_null()) child = {{"ACCESS", kContainer}, {"FULL_PATH", path.substr(0, next)}};
    at = &child;
    slash = next;
  }
  at->update(node);  // it may be a container as well: /clear, /scene/clear
}

json make_namespace(bool with_object) {
  json root = {{"FULL_PATH", "/"}, {"ACCESS", kContainer}, {"DESCRIPTION", "Ringdown: solid objects that ring"}};
  for (const AddressSpec& spec : protocol::addresses()) {
    std::string path(spec.address);
    if (spec.arguments_in_address() > 0) {
      if (!with_object) continue;
      path.replace(path.find(kPlaceholder), kPlaceholder.size(), 1, Description::kAnyObject);
    }
    place(root, path, leaf(spec));
  }
  return root;
}

// The namespace without objects, or with one whose name is kAnyObject.
const json& whole_namespace(bool with_object) {
  static const json without = make_namespace(false), with = make_namespace(true);
  return with_object ? with : without;
}

struct Node {
  const json* tree;
  std::string object;  // the name that stands for kAnyObject; empty where the path names no object
};

Result<Node> node_at(const std::string& path, const std::vector<std::string>& names) {
  Node node{&whole_namespace(!names.empty()), ""};
  for (std::size_t slash = 0; slash + 1 < path.size();) {
    const std::size_t next = std::min(path.find('/', slash + 1), path.size());
    std::string name = path.substr(slash + 1, next - slash - 1);
    const bool asks_for_any = name.find(Description::kAnyObject) != name.npos;
    if (path.substr(0, slash + 1) == protocol::kObjectPrefix && std::ranges::find(names, name) != names.end()) {
      node.object = std::exchange(name, std::string(1, Description::kAnyObject));
    }
    const auto contents = node.tree->find("CONTENTS");
    if (asks_for_any || contents == node.tree->end() || !contents->contains(name)) {
      return fail(ErrorKind::bad_input, "there is no address " + path);
    }
    node.tree = &(*contents)[name];
    slash = next;
  }
  return node;
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
  const auto node = node_at(std::string(path), *names);
  if (!node) return fail(node.error());
  std::string text;
  if (attribute.empty()) {
    text = node->tree->dump();
  } else if (const auto found = node->tree->find(attribute); found != node->tree->end()) {
    text = json{{std::string(attribute), *found}}.dump();
  }
  if (!node->object.empty()) return Description(with_name(std::move(text), node->object));
  const std::string key = std::string("\"") + Description::kAnyObject + "\":";
  const std::size_t at = text.find(key);
  if (at == text.npos) return Description(std::move(text));
  const json& object = whole_namespace(true)["CONTENTS"]["object"]["CONTENTS"][std::string(1, Description::kAnyObject)];
  std::string each = key + object.dump();
  return Description(text.substr(0, at), each, text.substr(at + each.size()), names);
}

std::string describe_host(const std::string& name, const std::string& osc_address, std::uint16_t osc_port) {
  return json{
      {"NAME", name},
      {"OSC_IP", osc_address},
      {"OSC_PORT", osc_port},
      {"OSC_TRANSPORT", "UDP"},
      {"EXTENSIONS", {{"ACCESS", true}, {"DESCRIPTION", true}, {"RANGE", true}, {"TYPE", true}, {"UNIT", true}}}}
      .dump();
}

}  // namespace ringdown::server
