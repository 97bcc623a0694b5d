#include "server/osc_namespace.h"

#include "protocol/convert.h"
#include "protocol/help.h"
#include "protocol/schema.h"

#include <nlohmann/json.hpp>

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

json whole_namespace(std::span<const std::string> objects) {
  json root = {{"FULL_PATH", "/"}, {"ACCESS", kContainer}, {"DESCRIPTION", "Ringdown: solid objects that ring"}};
  for (const AddressSpec& spec : protocol::addresses()) {
    const json node = leaf(spec);
    if (spec.arguments_in_address() == 0) {
      place(root, std::string(spec.address), node);
      continue;
    }
    const std::size_t at = spec.address.find(kPlaceholder);
    for (const std::string& name : objects) {
      place(root, std::string(spec.address).replace(at, kPlaceholder.size(), name), node);
    }
  }
  return root;
}

Result<json> node_at(std::string_view path, std::span<const std::string> objects) {
  json node = whole_namespace(objects);
  while (path.size() > 1) {
    const std::size_t next = path.find('/', 1);
    const std::string name(path.substr(1, next == path.npos ? next : next - 1));
    if (!node.contains("CONTENTS") || !node["CONTENTS"].contains(name)) {
      return fail(ErrorKind::bad_input, "there is no address " + std::string(path));
    }
    node = json(node["CONTENTS"][name]);
    path = next == path.npos ? "" : path.substr(next);
  }
  return node;
}

}  // namespace

Result<std::string> describe_namespace(std::string_view path, std::span<const std::string> objects) {
  return node_at(path, objects).map([](const json& node) { return node.dump(); });
}

Result<std::string> describe_attribute(std::string_view path, std::string_view attribute,
                                       std::span<const std::string> objects) {
  return node_at(path, objects).map([&](const json& node) {
    const auto found = node.find(std::string(attribute));
    return found == node.end() ? std::string() : json{{std::string(attribute), *found}}.dump();
  });
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
