#include "clients/library/terms.h"

#include "protocol/schema.h"

#include <array>
#include <cstdio>
#include <optional>
#include <span>
#include <string>

namespace ringdown::library {
namespace {

// A parameter or a struct's member, and how many of the protocol's arguments it stands for.
struct Name {
  const char* text;
  std::size_t numbers = 1;
};

constexpr Name kObject{"object"}, kPoint{"point_m", 3}, kImpulse{"impulse_ns", 3}, kForce{"force_n", 3},
    kDirection{"direction", 3}, kPosition{"position_m", 3}, kRotation{"rotation_wxyz", 4}, kNumber{"number"},
    kContactTime{"contact_time_s"}, kRamp{"ramp_s"};

// The names for each request that the library makes, in the order of the arguments in the protocol's table.
template <class Request>
constexpr std::array<Name, 0> kNames = {};
template <>
constexpr std::array kNames<protocol::Strike> = {kObject, kPoint, kImpulse, kContactTime};
template <>
constexpr std::array kNames<protocol::StrikeVertex> = {kObject, Name{"point"}, kImpulse, kContactTime};
template <>
constexpr std::array kNames<protocol::Click> = {kObject, kImpulse, kContactTime};
template <>
constexpr std::array kNames<protocol::SetContact> = {kObject,
                                                     kPoint,
                                                     kForce,
                                                     Name{"slip_m_s"},
                                                     Name{"roll_m_s"},
                                                     kNumber,
                                                     Name{"roughness_m"},
                                                     Name{"correlation_m"},
                                                     Name{"spectral_slope"}};
template <>
constexpr std::array kNames<protocol::SetBow> = {kObject,         kPoint,          kDirection,    Name{"speed_m_s"},
                                                 Name{"force_n"}, Name{"width_m"}, Name{"rosin"}, kNumber};
template <>
constexpr std::array kNames<protocol::HitMallet> = {kObject,         kPoint,       Name{"velocity_m_s", 3},
                                                    Name{"mass_kg"}, Name{"head"}, Name{"bounce"}};
template <>
constexpr std::array kNames<protocol::SetCoupling> = {
    kObject,          kPoint,           Name{"other"},   Name{"other_point_m", 3},
    kDirection,       Name{"weight_n"}, Name{"gap_m"},   Name{"stiffness"},
    Name{"friction"}, Name{"bounce"},   Name{"mass_kg"}, kNumber};
template <>
constexpr std::array kNames<protocol::RingModes> = {kObject, Name{"first"}, Name{"count"}, Name{"amplitude"}};
template <>
constexpr std::array kNames<protocol::SetGain> = {kObject, Name{"gain"}, kRamp};
template <>
constexpr std::array kNames<protocol::SetPan> = {kObject, Name{"pan"}};
template <>
constexpr std::array kNames<protocol::ClearObject> = {kObject, kRamp};
template <>
constexpr std::array kNames<protocol::SetPose> = {kObject, kPosition, kRotation};
template <>
constexpr std::array kNames<protocol::SetListener> = {kPosition, kRotation};
template <>
constexpr std::array kNames<protocol::SetListenerAir> = {Name{"temperature_c"}, Name{"humidity_percent"}};
template <>
constexpr std::array kNames<protocol::SetMaterial> = {kObject,         Name{"alpha"},     Name{"beta"},
                                                      Name{"density"}, Name{"stiffness"}, Name{"size"}};
template <>
constexpr std::array kNames<protocol::SetDamper> = {kObject, kPoint, Name{"damping_ns_m"}, kDirection, kNumber};
template <>
constexpr std::array kNames<protocol::Excite> = {kObject, Name{"input"}, kPoint, kForce};
template <>
constexpr std::array kNames<protocol::ScenePush> = {Name{"body"}, kImpulse};

template <class... Structs>
std::span<const Name> names_of(std::size_t index, Types<Structs...>) {
  static constexpr std::span<const Name> kAll[] = {kNames<Structs>...};
  return kAll[index];
}

std::optional<std::string> name_of(const protocol::Request& request, std::size_t argument) {
  for (const Name& name : names_of(request.index(), protocol::Requests())) {
    if (argument < name.numbers) {
      return name.numbers == 1 ? name.text : std::string(name.text) + "[" + std::to_string(argument) + "]";
    }
    argument -= name.numbers;
  }
  return std::nullopt;
}

std::string text_of(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}

}  // namespace

Result<void> check(protocol::Request& request) {
  const auto wrong = protocol::find_out_of_range(request);
  if (!wrong) return {};
  const std::string theirs(protocol::spec_of(request).arguments[wrong->argument].name);
  return fail(ErrorKind::bad_input, name_of(request, wrong->argument).value_or(theirs) + " " + wrong->complaint);
}

Result<void> check_index(const char* name, std::size_t index, std::size_t count) {
  if (index < count) return {};
  return fail(ErrorKind::bad_input, std::string(name) + " is " + std::to_string(index) +
                                        "; it must be a whole number from 0 to " + std::to_string(count - 1));
}

Result<void> check_within(const char* name, double value, double min, double max, const char* or_else) {
  if (value >= min && value <= max) return {};  // false for NaN
  return fail(ErrorKind::bad_input, std::string(name) + " is " + text_of(value) + "; it must be from " + text_of(min) +
                                        " to " + text_of(max) + or_else);
}

tl::unexpected<Error> missing(const char* name) {
  return fail(ErrorKind::bad_input, std::string(name) + " must not be NULL");
}

const char* first_null(std::initializer_list<std::pair<const char*, const void*>> pointers) {
  for (const auto& [name, pointer] : pointers) {
    if (!pointer) return name;
  }
  return nullptr;
}

}  // namespace ringdown::library
