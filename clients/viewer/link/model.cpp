#include "clients/viewer/link/model.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace ringdown::viewer {
namespace {

// The two parts of "/object/bell/gain"; nothing for other addresses.
struct ObjectAddress {
  std::string name;
  std::string_view verb;
};
std::optional<ObjectAddress> object_address(std::string_view address) {
  constexpr std::string_view kBegin = "/object/";
  if (!address.starts_with(kBegin)) return std::nullopt;
  address.remove_prefix(kBegin.size());
  const std::size_t slash = address.find('/');
  if (slash == address.npos) return std::nullopt;
  return ObjectAddress{std::string(address.substr(0, slash)), address.substr(slash + 1)};
}

// Returns whether the model itself makes this request: the user need not be told how such a request ended.
bool is_own_question(std::string_view address) {
  if (address == "/notify" || address == "/watch/sound" || address == "/scene/describe" || address == "/browse") {
    return true;
  }
  const auto object = object_address(address);
  return object && (object->verb == "describe" || object->verb == "bank" || object->verb == "watch");
}

}  // namespace

Model::Model(double notice_rate_hz, std::size_t max_bank_bytes)
    : notice_rate_hz_(notice_rate_hz),
      max_bank_bytes_(max_bank_bytes),
      banks_(max_bank_bytes),
      scene_(1 / notice_rate_hz) {}

void Model::restart() {
  Model fresh(notice_rate_hz_, max_bank_bytes_);
  fresh.chosen_ = std::move(chosen_);
  fresh.sound_watch_.want(sound_watch_.wanted());
  *this = std::move(fresh);
}

// Each kind of reply goes to the part that it concerns. A kind that is missing here does not compile.
void Model::apply(const protocol::Reply& reply, double now_s) {
  has_daemon_ = true;
  visit(
      Overloaded{
          [&](const protocol::Done& r) { on(r, now_s); }, [&](const protocol::Fail& r) { on(r, now_s); },
          [&](const protocol::VersionReply&) {}, [&](const protocol::Synced&) {},
          [&](const protocol::StatusReply& r) { status_ = r; }, [&](const protocol::ObjectReply& r) { objects_.on(r); },
          [&](const protocol::BankReply& r) { banks_.take(r); }, [&](const protocol::BrowseReply& r) { files_.on(r); },
          [&](const protocol::BrowseFile& r) { files_.on(r); }, [&](const protocol::SceneReply& r) { scene_.on(r); },
          [&](const protocol::SceneBody& r) { scene_.on(r); }, [&](const protocol::SceneStatic& r) { scene_.on(r); },
          [&](const protocol::NotifyScene& r) { scene_.on(r, now_s); },
          [&](const protocol::NotifyBody& r) { scene_.on(r); }, [&](const protocol::NotifyObject& r) { on(r); },
          [&](const protocol::NotifyGroup& r) { objects_.on(r); },
          [&](const protocol::NotifyContact& r) { on(r, now_s); }, [&](const protocol::NotifyPeak& r) { on(r, now_s); },
          [&](const protocol::NotifyObjectPeak& r) { objects_.on(r, now_s); },
          [&](const protocol::NotifyLoad& r) { load_ = r; }, [&](const protocol::NotifySound& r) { on(r, now_s); },
          [&](const protocol::NotifyModes& r) { objects_.on(r, now_s); },
          // The window does not ask for pieces: they are objects like any other.
          [](const protocol::PiecesReply&) {}, [](const protocol::PatternReply&) {}, [](const protocol::PieceReply&) {},
          [](const protocol::BrokenReply&) {}},
      reply);
}

Requests Model::wants(double now_s) {
  while (!contacts_.empty() && now_s - contacts_.front().at_s > kContactLife_s) contacts_.pop_front();
  Requests requests;
  if (!has_daemon_) return requests;
  objects_.add_requests(now_s, status_ ? std::optional(status_->objects) : std::nullopt, requests);
  if (auto request = scene_.wants(now_s)) requests.push_back(std::move(*request));
  banks_.add_requests(objects_, chosen_, now_s, requests);
  watches_.add_requests(objects_, chosen_, now_s, requests);
  sound_watch_.add_requests(now_s, requests);
  files_.add_requests(now_s, requests);
  return requests;
}

void Model::on(const protocol::Done& reply, double now_s) {
  if (is_own_question(reply.address)) return;
  add_message({.address = reply.address, .number = reply.number, .at_s = now_s});
}

void Model::on(const protocol::Fail& reply, double now_s) {
  if (!is_own_question(reply.address)) {
    return add_message({.failed = true, .address = reply.address, .sentence = reply.sentence, .at_s = now_s});
  }
  const auto object = object_address(reply.address);
  if (!object) return;
  if (object->verb == "describe") forget(object->name);
  if (object->verb == "bank") banks_.refuse(object->name, reply.sentence);
}

void Model::add_message(KnownMessage message) {
  message.order = message_count_++;
  messages_.push_back(std::move(message));
  if (messages_.size() > kMaxMessages) messages_.pop_front();
}

bool Model::has_whole_scene() const {
  const auto is_seen = [&](const auto& entry) {
    if (entry.second.object.empty()) return true;
    const KnownObject* const found = object(entry.second.object);
    return found && (found->bank || !found->bank_fault.empty());
  };
  return scene_.up_to_date() && scene_.description().file && std::ranges::all_of(scene_.bodies(), is_seen);
}

void Model::forget(const std::string& object) {
  objects_.forget(object);
  watches_.forget(object);
}

void Model::on(const protocol::NotifyObject& notice) {
  if (!notice.loaded) return forget(notice.name);
  objects_.on(notice);
}

void Model::on(const protocol::NotifyContact& notice, double now_s) {
  objects_.find_or_ask(notice.object);
  contacts_.push_back({notice.object, notice.point_m, notice.impulse_ns, notice.contact_time_s, now_s});
  if (contacts_.size() > kMaxContacts) contacts_.pop_front();
}

void Model::on(const protocol::NotifyPeak& notice, double now_s) {
  peak_.now = notice.peak;
  if (notice.peak >= peak_.held || now_s - peak_.held_at_s > kPeakHold_s) {
    peak_.held = notice.peak;
    peak_.held_at_s = now_s;
  }
}

void Model::on(const protocol::NotifySound& notice, double now_s) {
  sound_watch_.note_piece(now_s);
  if (sound_watch_.wanted()) sound_.take(notice);
}

}  // namespace ringdown::viewer
