#include "clients/viewer/link/model.h"

#include "protocol/wire/floats.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace ringdown::viewer {
namespace {

// "/object/bell/gain" in two; nothing when it is no address of an object.
struct ObjectAddress {
  std::string name;
  std::string_view verb;
};
std::optional<ObjectAddress> of_object(std::string_view address) {
  constexpr std::string_view kBegin = "/object/";
  if (!address.starts_with(kBegin)) return std::nullopt;
  address.remove_prefix(kBegin.size());
  const std::size_t slash = address.find('/');
  if (slash == address.npos) return std::nullopt;
  return ObjectAddress{std::string(address.substr(0, slash)), address.substr(slash + 1)};
}

// What the model asks by itself: nobody needs to be told how that went.
bool is_own_question(std::string_view address) {
  if (address == "/notify" || address == "/watch/sound" || address == "/scene/describe" || address == "/browse") {
    return true;
  }
  const auto object = of_object(address);
  return object && (object->verb == "describe" || object->verb == "bank" || object->verb == "watch");
}

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};

}  // namespace

Model::Model(double notice_rate_hz, std::size_t most_bank_bytes)
    : notice_rate_hz_(notice_rate_hz), most_bank_bytes_(most_bank_bytes), scene_(1 / notice_rate_hz) {}

void Model::restart() {
  Model anew(notice_rate_hz_, most_bank_bytes_);
  anew.chosen_ = std::move(chosen_);
  anew.sound_wanted_ = sound_wanted_;
  *this = std::move(anew);
}

const KnownObject* Model::object(const std::string& name) const {
  const auto found = objects_.find(name);
  return found == objects_.end() ? nullptr : &found->second;
}

void Model::apply(const protocol::Reply& reply, double now_s) {
  told_ = true;
  std::visit(
      Overloaded{[&](const protocol::SceneReply& told) { scene_.on(told); },
                 [&](const protocol::SceneBody& told) { scene_.on(told); },
                 [&](const protocol::SceneStatic& told) { scene_.on(told); },
                 [&](const protocol::NotifyScene& told) { scene_.on(told, now_s); },
                 [&](const protocol::NotifyBody& told) { scene_.on(told); }, [&](const protocol::VersionReply&) {},
                 [&](const protocol::Synced&) {}, [&](const auto& told) { on(told, now_s); }},
      reply);
}

void Model::on(const protocol::Done& reply, double now_s) {
  if (is_own_question(reply.address)) return;
  add_message({.address = reply.address, .number = reply.number, .at_s = now_s});
}

void Model::on(const protocol::Fail& reply, double now_s) {
  if (!is_own_question(reply.address)) {
    return add_message({.failed = true, .address = reply.address, .sentence = reply.sentence, .at_s = now_s});
  }
  const auto object = of_object(reply.address);
  if (!object) return;
  if (object->verb == "describe") forget(object->name);
  if (object->verb == "bank" && transfer_ && transfer_->subject().object == object->name) {
    transfer_->refuse(reply.sentence);
  }
}

void Model::add_message(KnownMessage message) {
  messages_.push_back(std::move(message));
  if (messages_.size() > kMaxMessages) messages_.pop_front();
}

void Model::on(const protocol::StatusReply& reply, double) { status_ = reply; }

void Model::on(const protocol::ObjectReply& reply, double) {
  undescribed_.erase(reply.name);
  if (!objects_.contains(reply.name) && objects_.size() == kMaxObjects) return;
  KnownObject& object = objects_[reply.name];
  if (object.version != reply.version || object.bank_content != reply.bank_content || object.bank_path != reply.bank) {
    object = {};
  }
  object.name = reply.name;
  object.number = reply.number;
  object.version = reply.version;
  object.bank_bytes = reply.bank_bytes;
  object.bank_content = reply.bank_content;
  object.bank_path = reply.bank;
  object.modes = reply.modes;
  object.selected = {static_cast<std::uint32_t>(std::max(0, reply.first_mode)),
                     static_cast<std::uint32_t>(std::max(0, reply.selected_modes))};
  object.scale = reply.scale;
  object.gain = reply.gain;
  object.pan = reply.pan;
  object.group = reply.group;
}

void Model::on(const protocol::BankReply& reply, double) {
  if (transfer_) transfer_->take(reply);
}

KnownObject* Model::find(const std::string& name) {
  const auto found = objects_.find(name);
  if (found != objects_.end()) return &found->second;
  if (undescribed_.size() < kMaxObjects) undescribed_.try_emplace(name);
  return nullptr;
}

void Model::forget(const std::string& name) {
  undescribed_.erase(name);
  objects_.erase(name);
  watched_.erase(name);
}

void Model::on(const protocol::NotifyObject& reply, double) {
  if (!reply.loaded) return forget(reply.name);
  if (undescribed_.size() < kMaxObjects) undescribed_[reply.name] = {};
}

void Model::on(const protocol::NotifyGroup& reply, double) {
  if (KnownObject* object = find(reply.name)) object->group = reply.group;
}

void Model::on(const protocol::NotifyContact& reply, double now_s) {
  find(reply.object);
  contacts_.push_back({reply.object, reply.point_m, reply.impulse_ns, reply.contact_time_s, now_s});
  if (contacts_.size() > kMaxContacts) contacts_.pop_front();
}

void Model::on(const protocol::NotifyPeak& reply, double now_s) {
  peak_.now = reply.peak;
  if (reply.peak >= peak_.held || now_s - peak_.held_at_s > kPeakHold_s) {
    peak_.held = reply.peak;
    peak_.held_at_s = now_s;
  }
}

void Model::on(const protocol::NotifyObjectPeak& reply, double now_s) {
  if (KnownObject* object = find(reply.object)) {
    object->peak = reply.peak;
    object->peak_at_s = now_s;
  }
}

void Model::on(const protocol::NotifyLoad& reply, double) { load_ = reply; }

void Model::on(const protocol::NotifySound& reply, double now_s) {
  sound_at_s_ = now_s;
  if (sound_wanted_) sound_.take(reply);
}

void Model::on(const protocol::NotifyModes& reply, double now_s) {
  KnownObject* object = find(reply.object);
  if (!object || reply.first < 0) return;
  const auto modes = std::min(static_cast<std::size_t>(std::max(0, object->modes)), kMaxModes);
  const std::vector<float> told = wire::decode_floats(reply.amplitudes);
  if (static_cast<std::size_t>(reply.first) + told.size() > modes) return;
  object->amplitudes.resize(modes);
  std::ranges::copy(told, object->amplitudes.begin() + reply.first);
  object->amplitudes_at_s = now_s;
}

void Model::on(const protocol::BrowseReply& reply, double) {
  if (browse_.complete) return;
  if (browse_.files && *browse_.files != reply.files) browse_.found.clear();
  browse_.files = reply.files;
  finish_browsing();
}

void Model::on(const protocol::BrowseFile& reply, double) {
  if (browse_.complete || browse_.found.size() == kMaxFiles) return;
  browse_.found.insert_or_assign(reply.number, reply);
  finish_browsing();
}

void Model::finish_browsing() {
  if (!browse_.files) return;
  if (browse_.found.size() < std::min(static_cast<std::size_t>(std::max(0, *browse_.files)), kMaxFiles)) return;
  scene_files_.clear();
  bank_files_.clear();
  for (const auto& [number, file] : browse_.found) {
    if (file.kind == "scene") scene_files_.push_back(file.path);
    if (file.kind == "bank") bank_files_.push_back(file.path);
  }
  browse_ = {.complete = true};
}

}  // namespace ringdown::viewer
