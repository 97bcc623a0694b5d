#include "server/session/recorder.h"

#include "protocol/schema.h"

#include <algorithm>
#include <utility>

namespace ringdown::session {
namespace {

using synth::Event;
using synth::Frame;
using wire::Message;

// Returns the requests that take an object from one state to another. An object that did not exist, or has another
// bank, is loaded first; a load keeps only the object's group, gain, pan, fan, mute and solo.
std::vector<protocol::Request> requests_between(const ObjectState* before, const ObjectState& after) {
  std::vector<protocol::Request> requests;
  const protocol::ObjectRef ref{.name = after.name};
  ObjectState from = before ? *before : ObjectState{};
  if (!before || before->bank_version != after.bank_version) {
    requests.emplace_back(protocol::LoadObject{after.name, after.bank.string()});
    from = {.group = from.group,
            .gain = from.gain,
            .pan = from.pan,
            .fan_hz = from.fan_hz,
            .fan_depth = from.fan_depth,
            .mute = from.mute,
            .solo = from.solo};
  }
  if (after.material != from.material) requests.emplace_back(protocol::SetMaterial{ref, after.material});
  if (const auto level = level_m(after); level && level != level_m(from))
    requests.emplace_back(protocol::SetFill{ref, *level});
  if (const auto tuning = tube_tuning(after); tuning && tuning != tube_tuning(from))
    requests.emplace_back(protocol::SetResonator{ref, *tuning});
  if (after.modes != from.modes) requests.emplace_back(protocol::SelectModes{ref, after.modes});
  modal::Dampers dampers = after.dampers;
  for (const auto& [number, damper] : from.dampers) dampers.try_emplace(number);  // no damping: removed
  for (const auto& [number, damper] : dampers) {
    const auto present = from.dampers.find(number);
    if (present != from.dampers.end() && present->second == damper) continue;
    requests.emplace_back(protocol::Hold{ref, damper, number});
  }
  if (after.group != from.group) {
    requests.emplace_back(protocol::SetGroup{ref, after.group.empty() ? std::nullopt : std::optional(after.group)});
  }
  if (after.gain != from.gain) requests.emplace_back(protocol::SetGain{ref, {after.gain, 0}});
  if (after.pan != from.pan) requests.emplace_back(protocol::SetPan{ref, {after.pan}});
  if (after.fan_hz != from.fan_hz || after.fan_depth != from.fan_depth)
    requests.emplace_back(protocol::SetFan{ref, {after.fan_hz, after.fan_depth}});
  if (after.mute != from.mute) requests.emplace_back(protocol::SetMute{ref, after.mute});
  if (after.solo != from.solo) requests.emplace_back(protocol::SetSolo{ref, after.solo});
  return requests;
}

}  // namespace

Recorder::Recorder(Rack& rack, Write write) : rack_(rack), write_(std::move(write)) { rack.observers().add(*this); }

Result<void> Recorder::start(const std::filesystem::path& path, Frame frame) {
  if (records_) {
    return fail(ErrorKind::refused, "path: " + path_.string() + " is being recorded already; end it with /record/stop");
  }
  rack_.observers().report_events();  // events from before the start do not belong to the recording
  const std::scoped_lock lock(mutex_);
  path_ = path;
  first_ = frame;
  left_out_ = 0;
  entries_.clear();
  records_ = true;
  for (const ObjectSnapshot& object : rack_.objects()) {
    for (const auto& request : requests_between(nullptr, *object)) add(first_, protocol::format(request));
  }
  return {};
}

Result<std::size_t> Recorder::stop(Frame frame, std::optional<std::filesystem::path> path) {
  rack_.observers().report_events();
  std::vector<wire::ScoreEvent> score;
  {
    const std::scoped_lock lock(mutex_);
    if (!records_) return fail(ErrorKind::refused, "nothing is being recorded; begin with /record/start");
    if (!path) path = path_;
    score = score_until(frame);
  }
  if (const auto written = write_(score, *path); !written) return fail(written);
  const std::scoped_lock lock(mutex_);
  records_ = false;
  entries_ = std::vector<Entry>();
  if (left_out_ > 0) {
    rack_.warn(formatted("{}: {} events beyond {} are not in it", path->string(), left_out_, kMaxRecorded));
  }
  return score.size() - 1;
}

std::vector<wire::ScoreEvent> Recorder::score_until(Frame frame) {
  const double rate = rack_.mixer().sample_rate_hz();
  const auto seconds = [&](Frame at) { return static_cast<double>(at - first_) / rate; };
  std::ranges::stable_sort(entries_, {}, &Entry::frame);
  std::vector<wire::ScoreEvent> score;
  score.reserve(entries_.size() + 1);
  for (const Entry& entry : entries_) score.push_back({seconds(entry.frame), message_of(entry)});
  Frame end = std::max(frame, first_);
  if (!entries_.empty()) end = std::max(end, entries_.back().frame + 1);
  score.push_back({seconds(end), {"/c_set", {0, 0.f}}});
  return score;
}

void Recorder::add(Frame frame, What what) {
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

Message Recorder::message_of(const Entry& entry) const {
  if (const auto* message = entry.what.get_if<Message>()) return *message;
  const auto& [event, name] = entry.what.get<Played>();
  return protocol::format(protocol::request_for(event, {.name = name}));
}

void Recorder::played(const Event& event) {
  if (!records_) return;
  const bool of_object = !synth::is_of_listener(event);
  const auto object = rack_.find({.number = event.object});
  if (of_object && !object) return;  // the object has been freed a moment ago
  const std::scoped_lock lock(mutex_);
  if (records_) add(event.frame, Played{event, of_object ? (*object)->name : std::string()});
}

void Recorder::changed(const ObjectState* before, const ObjectState* after, Frame at) {
  rack_.observers().report_events();  // these events came before the change
  const std::scoped_lock lock(mutex_);
  if (!records_) return;
  const Frame frame = std::max(at, rack_.mixer().counters().frames.load());
  if (!after) return add(frame, protocol::format(protocol::FreeObject{{.name = before->name}}));
  for (const auto& request : requests_between(before, *after)) add(frame, protocol::format(request));
}

}  // namespace ringdown::session
