#include "clients/plugin/window/edits.h"

namespace ringdown::plugin {

Edits::Edits(HostLink& host) : host_(host) {
  for (std::size_t i = 0; i < kParameters; ++i) values_.parameters[i] = kParameterInfo[i].standard;
}

void Edits::on_parameter(std::size_t parameter, float value) {
  if (parameter < kParameters) values_.parameters[parameter] = value;
}

void Edits::begin(Parameter parameter) {
  history_.record(values_);
  host_.begin_edit(static_cast<std::size_t>(parameter));
}

void Edits::move(Parameter parameter, double value) {
  const auto number = static_cast<std::size_t>(parameter);
  values_.parameters[number] = static_cast<float>(value);
  host_.set_parameter(number, values_.parameters[number]);
}

void Edits::end(Parameter parameter) { host_.end_edit(static_cast<std::size_t>(parameter)); }

void Edits::set(Parameter parameter, double value) {
  begin(parameter);
  move(parameter, value);
  end(parameter);
}

void Edits::set(std::initializer_list<std::pair<Parameter, double>> values) {
  history_.record(values_);
  for (const auto& [parameter, value] : values) send(static_cast<std::size_t>(parameter), static_cast<float>(value));
}

void Edits::set_point(const StrikePoint& point, Which which) {
  history_.record(values_);
  on_point(which, to_text(point));
  host_.set_point(which, to_text(point));
}

void Edits::play_file(const std::string& path) {
  history_.record(values_);
  values_.file = path;
  host_.set_file(path);
  send(static_cast<std::size_t>(Parameter::object), 0);
}

std::optional<StrikePoint> Edits::point_on(const std::string& source, Which which) const {
  auto point = strike_point_of(values_.points[static_cast<std::size_t>(which)]);
  const auto percent = static_cast<double>(values_[Parameter::strike_point]);
  return point && point->source == source && point->is_at(percent) ? std::move(point) : std::nullopt;
}

void Edits::send(std::size_t parameter, float value) {
  values_.parameters[parameter] = value;
  host_.begin_edit(parameter);
  host_.set_parameter(parameter, value);
  host_.end_edit(parameter);
}

void Edits::go_to(const std::optional<Values>& target) {
  if (!target) return;
  if (target->file != values_.file) host_.set_file(values_.file = target->file);
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (target->points[i] != values_.points[i]) {
      host_.set_point(static_cast<Which>(i), values_.points[i] = target->points[i]);
    }
  }
  for (std::size_t i = 0; i < kParameters; ++i) {
    const bool differs = target->parameters[i] != values_.parameters[i];
    if (differs && kParameterInfo[i].scale != Scale::output) send(i, target->parameters[i]);
  }
}

}  // namespace ringdown::plugin
