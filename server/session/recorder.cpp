#include "server/session/recorder.h"

#include "protocol/schema.h"

#include <algorithm>

namespace ringdown::session {
namespace {

using synth::Event;
using synth::EventType;
using synth::Frame;
using wire::Message;

protocol::SetGroup group_of(const RackObject& object) {
  return {{.name = object.name}, object.group.empty() ? std::nullopt : std::optional(object.group)};
}

}  // namespace

Recorder::Recorder(Rack& rack, Write write) : rack_(rack), write_(std::move(write)) { rack.observe(*this); }

Result<void> Recorder::start(const std::filesystem::path& path, Frame frame) {
  const std::scoped_lock lock(mutex_);
  if (records_)
    return fail(ErrorKind::refused, "path: " + path_.string() + " is being recorded already; end it with /record/stop");
  path_ = path;
  first_ = frame;
  left_out_ = 0;
  entries_.clear();
  records_ = true;
  add_present_state();
  return {};
}

void Recorder::add_present_state() {
  for (const RackObject& object : rack_.objects()) {
    const protocol::ObjectRef ref{.name = object.name};
    const GainAndPan& level = levels_[object.number].now;
    add(first_, protocol::format(protocol::LoadObject{object.name, object.bank->string()}));
    if (object.material != modal::MaterialScale{}) {
      add(first_, protocol::format(protocol::SetMaterial{ref, object.material}));
    }
    if (object.modes != modal::ModeRange{}) {
      add(first_, protocol::format(protocol::SelectModes{ref, object.modes}));
    }
    for (const auto& [number, damper] : object.dampers) {
      add(first_, protocol::format(protocol::SetDamper{ref, damper, number}));
    }
    if (!object.group.empty()) add(first_, protocol::format(group_of(object)));
    if (level.gain != 1) add(first_, protocol::format(protocol::SetGain{ref, level.gain, 0}));
    if (level.pan != 0) add(first_, protocol::format(protocol::SetPan{ref, level.pan}));
  }
}

Result<std::size_t> Recorder::stop(Frame frame) {
  rack_.tell_of_notes();
  std::vector<wire::ScoreEvent> score;
  std::size_t left_out = 0;
  {
    const std::scoped_lock lock(mutex_);
    if (!records_) return fail(ErrorKind::refused, "nothing is being recorded; begin with /record/start");
    records_ = false;
    left_out = left_out_;
    std::ranges::stable_sort(entries_, {}, &Entry::frame);
    const double rate = rack_.mixer().sample_rate_hz();
    for (const Entry& entry : entries_) {
      if (entry.frame >= frame) break;  // it has not sounded yet
      score.push_back({static_cast<double>(entry.frame - first_) / rate, message_of(entry)});
    }
    entries_ = {};
    score.push_back({static_cast<double>(std::max(frame, first_) - first_) / rate, {"/c_set", {0, 0.f}}});
  }
  if (left_out > 0) {
    rack_.warn(path_.string() + ": " + std::to_string(left_out) + " events beyond " + std::to_string(kMaxRecorded) +
               " are not in it");
  }
  if (const auto written = write_(score, path_); !written) return fail(written.error());
  return score.size() - 1;
}

void Recorder::add(Frame frame, std::variant<Played, Message> what) {
  if (entries_.size() == kMaxRecorded) {
    ++left_out_;
  } else {
    entries_.push_back({std::max(frame, first_), std::move(what)});
  }
}

std::size_t Recorder::left_out() const {
  const std::scoped_lock lock(mutex_);
  return left_out_;
}

Recorder::GainAndPan Recorder::level(synth::ObjectNumber object) const {
  const std::scoped_lock lock(mutex_);
  return levels_[object].now;
}

Message Recorder::message_of(const Entry& entry) const {
  if (const auto* message = std::get_if<Message>(&entry.what)) return *message;
  const auto& [event, name] = std::get<Played>(entry.what);
  return protocol::format(protocol::request_for(event, {.name = *name}));
}

void Recorder::played(const Event& event) {
  const bool is_level = event.type == EventType::gain || event.type == EventType::pan;
  if (!records_ && !is_level) return;
  const std::scoped_lock lock(mutex_);
  Level& level = levels_[event.object];
  if (event.type == EventType::gain) level.now.gain = event.value;
  if (event.type == EventType::pan) level.now.pan = event.value;
  if (records_ && level.name) add(event.frame, Played{event, level.name});
}

void Recorder::loaded(const RackObject& object) {
  const std::scoped_lock lock(mutex_);
  Level& level = levels_[object.number];
  if (!level.name || *level.name != object.name) level = {.name = std::make_shared<const std::string>(object.name)};
  add_change(protocol::LoadObject{object.name, object.bank->string()});
}

void Recorder::retuned(const RackObject& object) {
  const std::scoped_lock lock(mutex_);
  add_change(protocol::SetMaterial{{.name = object.name}, object.material});
}

void Recorder::selected(const RackObject& object) {
  const std::scoped_lock lock(mutex_);
  add_change(protocol::SelectModes{{.name = object.name}, object.modes});
}

void Recorder::held(const RackObject& object, const modal::Dampers& changed, Frame at) {
  const std::scoped_lock lock(mutex_);
  for (const auto& [number, damper] : changed)
    add_change(protocol::SetDamper{{.name = object.name}, damper, number}, at);
}

void Recorder::regrouped(const RackObject& object) {
  const std::scoped_lock lock(mutex_);
  add_change(group_of(object));
}

void Recorder::freed(const RackObject& object) {
  const std::scoped_lock lock(mutex_);
  add_change(protocol::FreeObject{{.name = object.name}});
  levels_[object.number] = {};
}

void Recorder::add_change(const protocol::Request& request, Frame at) {
  if (records_) add(std::max(at, rack_.mixer().counters().frames.load()), protocol::format(request));
}

}  // namespace ringdown::session
