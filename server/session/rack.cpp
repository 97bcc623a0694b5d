#include "server/session/rack.h"

#include "engine/modal/bank_file.h"
#include "protocol/names.h"

#include <algorithm>
#include <span>

namespace ringdown::session {
namespace {

using protocol::ObjectRef;
using synth::Event;
using synth::EventType;

std::string shown(const ObjectRef& object) {
  return object.number ? "number " + std::to_string(*object.number) : "\"" + object.name + "\"";
}

// Two loads of one unchanged file share its memory.
std::string file_key(const std::filesystem::path& path) {
  std::error_code error;
  const auto canonical = std::filesystem::weakly_canonical(path, error);
  const auto time = std::filesystem::last_write_time(path, error).time_since_epoch().count();
  return canonical.string() + "@" + std::to_string(time);
}

}  // namespace

Result<RackObject> Rack::find(const ObjectRef& object) const {
  const std::scoped_lock lock(mutex_);
  std::size_t number = objects_.size();
  if (object.number) {
    number = *object.number;
  } else if (const auto found = numbers_.find(object.name); found != numbers_.end()) {
    number = found->second;
  }
  if (number < objects_.size() && objects_[number]) return *objects_[number];
  return fail(ErrorKind::bad_input, "object: there is no object " + shown(object) + "; load one with /load");
}

std::vector<RackObject> Rack::objects() const {
  std::vector<RackObject> objects;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [name, number] : numbers_) objects.push_back(*objects_[number]);
  }
  std::ranges::sort(objects, {}, &RackObject::name);
  return objects;
}

std::shared_ptr<const Rack::Names> Rack::names() const {
  const std::scoped_lock lock(mutex_);
  return names_;
}

// After a name has come or gone.
void Rack::list_names() {
  auto names = std::make_shared<Names>();
  for (const auto& [name, number] : numbers_) names->push_back(name);
  std::ranges::sort(*names);
  names_ = std::move(names);
}

void Rack::keep(RackObject object) {
  {
    const std::scoped_lock lock(mutex_);
    const bool is_new = numbers_.insert_or_assign(object.name, object.number).second;
    if (is_new) list_names();
    objects_[object.number] = std::move(object);
  }
  note_change();
}

bool Rack::push(synth::Producer producer, const Event& event) {
  if (!mixer_.push(producer, event)) return false;
  for (Observer* observer : observers_) observer->played(event);
  return true;
}

void Rack::tell_of_notes() {
  const std::scoped_lock lock(notes_mutex_);
  while (const Event* event = notes_played_.front()) {
    for (Observer* observer : observers_) observer->played(*event);
    notes_played_.pop();
  }
}

Result<synth::ObjectNumber> Rack::load(const std::string& name, const std::filesystem::path& bank) {
  auto file = read(bank);
  if (!file) return fail(file.error());
  RackObject object{.name = name,
                    .bank = std::make_shared<const std::filesystem::path>(bank),
                    .bank_bytes = file->bytes,
                    .bank_content = file->content,
                    .bank_version = last_bank_version_ + 1,
                    .map = std::move(file->map)};
  if (const auto old = find({.name = name}); old) {
    object.number = old->number;
    object.group = old->group;
  } else {
    const auto number = free_number();
    if (!number) return fail(number.error());
    object.number = *number;
  }
  if (const auto installed = install(object, synth::Mixer::Install::replace); !installed)
    return fail(installed.error());
  if (const auto assigned = assign(object); !assigned) return fail(assigned.error());
  last_bank_version_ = object.bank_version;
  keep(object);
  for (Observer* observer : observers_) observer->loaded(object);
  return object.number;
}

Result<void> Rack::set_material(const ObjectRef& ref, const modal::MaterialScale& scale) {
  auto object = find(ref);
  if (!object) return fail(object.error());
  object->material = scale;
  if (const auto installed = install(*object, synth::Mixer::Install::retune); !installed) return installed;
  keep(*object);
  for (Observer* observer : observers_) observer->retuned(*object);
  return {};
}

Result<void> Rack::set_dampers(const ObjectRef& ref, const modal::Dampers& dampers, synth::Frame at) {
  auto object = find(ref);
  if (!object) return fail(object.error());
  modal::Dampers changed;
  for (const auto& [number, damper] : dampers) {
    const auto present = object->dampers.find(number);
    const bool same = present == object->dampers.end() ? damper.damping_ns_m == 0 : damper == present->second;
    if (same) continue;
    changed.emplace(number, damper);
    if (damper.damping_ns_m > 0) {
      object->dampers.insert_or_assign(number, damper);
    } else {
      object->dampers.erase(number);
    }
  }
  if (changed.empty()) return {};
  if (const auto installed = install(*object, synth::Mixer::Install::retune, at); !installed) return installed;
  keep(*object);
  for (Observer* observer : observers_) observer->held(*object, changed, at);
  return {};
}

Result<void> Rack::select_modes(const ObjectRef& ref, modal::ModeRange modes) {
  auto object = find(ref);
  if (!object) return fail(object.error());
  object->modes = modes;
  if (const auto installed = install(*object, synth::Mixer::Install::retune); !installed) return installed;
  keep(*object);
  for (Observer* observer : observers_) observer->selected(*object);
  return {};
}

Result<void> Rack::set_group(const ObjectRef& ref, const std::string& group) {
  auto object = find(ref);
  if (!object) return fail(object.error());
  object->group = group;
  if (const auto assigned = assign(*object); !assigned) return assigned;
  keep(*object);
  for (Observer* observer : observers_) observer->regrouped(*object);
  return {};
}

static_assert(protocol::kMaxInputs == synth::kMaxInputs);

Result<void> Rack::excite(std::size_t input, const ObjectRef& ref, const Vec3& point_m, const Vec3& force_n) {
  const auto object = find(ref);
  if (!object) return fail(object.error());
  std::optional<Excitation>& excitation = excitations_[input];
  const bool ends = force_n == Vec3{};
  if (ends && (!excitation || excitation->object != object->number)) {
    return fail(ErrorKind::bad_input,
                "input: " + std::to_string(input + 1) + " does not excite \"" + object->name + "\"");
  }
  if (object->map->bank().mode_count() > synth::kMaxDrivenColumns) {
    return fail(ErrorKind::too_large, "object: \"" + object->name + "\" has more than the " +
                                          std::to_string(synth::kMaxDrivenColumns) +
                                          " modes that an input can excite; bake it with --keep");
  }
  const std::scoped_lock lock(rate_mutex_);
  const Vec3 impulse_ns = (1 / mixer_.sample_rate_hz()) * force_n;
  const bool taken =
      ends ? mixer_.disconnect_input(input)
           : mixer_.connect_input(input, {.object = object->number, .point_m = point_m, .impulse_ns = impulse_ns});
  if (!taken) return fail(ErrorKind::refused, "input: too many changes at once; try again");
  excitation = ends ? std::nullopt : std::optional(Excitation{object->number, point_m, force_n});
  inputs_ |= 1u << input;
  note_change();
  return {};
}

Result<void> Rack::assign(const RackObject& object) {
  fading_.erase(object.number);
  const std::size_t before = buses_.overflow();
  const auto bus = buses_.join(object.number, object.name, object.group);
  if (buses_.overflow() > before) {
    warn(object.name + " is heard in the mix only: all " + std::to_string(synth::kMaxBuses) + " ports are taken");
  }
  if (mixer_.assign(object.number, bus)) return {};
  return fail(ErrorKind::refused, "object: too many changes at once; try again");
}

void Rack::collect() {
  {
    const std::scoped_lock lock(rate_mutex_);
    mixer_.collect();
  }
  std::erase_if(banks_, [](const auto& entry) { return entry.second.map.expired(); });
  const std::size_t faded = std::erase_if(fading_, [this](synth::ObjectNumber number) {
    if (mixer_.in_use(number)) return false;
    buses_.leave(number);
    return true;
  });
  if (faded > 0) note_change();
}

void Rack::note_change() {
  ++version_;
  if (on_change_) on_change_();
}

Result<void> Rack::free(const ObjectRef& ref) {
  const auto object = find(ref);
  if (!object) return fail(object.error());
  if (!mixer_.remove(object->number)) return fail(ErrorKind::refused, "object: too many changes at once; try again");
  fading_.insert(object->number);
  for (auto& excitation : excitations_) {
    if (excitation && excitation->object == object->number) excitation.reset();
  }
  {
    const std::scoped_lock lock(mutex_);
    numbers_.erase(object->name);
    list_names();
    objects_[object->number].reset();
  }
  for (Observer* observer : observers_) observer->freed(*object);
  note_change();
  return {};
}

Result<Rack::BankFile> Rack::read(const std::filesystem::path& path) {
  const std::string key = file_key(path);
  if (const auto known = banks_.find(key); known != banks_.end()) {
    if (auto map = known->second.map.lock())
      return BankFile{std::move(map), known->second.bytes, known->second.content};
  }
  const auto bytes = roots_.read(path, modal::kMaxBankFileBytes);
  if (!bytes) return fail(bytes.error());
  auto bank = modal::parse_bank(std::as_bytes(std::span(*bytes)), path.string());
  if (!bank) return fail(bank.error());
  auto map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(*bank)));
  const ContentHash content = hash_of(*bytes);
  banks_[key] = {map, bytes->size(), content};
  return BankFile{std::move(map), bytes->size(), content};
}

Result<synth::ObjectNumber> Rack::free_number() const {
  const std::scoped_lock lock(mutex_);
  for (synth::ObjectNumber number = 0; number < synth::kMaxObjects; ++number) {
    if (!objects_[number] && !mixer_.in_use(number)) return number;
  }
  return fail(ErrorKind::refused, "name: all " + std::to_string(synth::kMaxObjects) +
                                      " objects are in use; free one with /object/.../free");
}

void Rack::change_sample_rate(double sample_rate_hz) {
  const std::scoped_lock lock(rate_mutex_);
  mixer_.change_sample_rate(sample_rate_hz);
}

Result<void> Rack::install(const RackObject& object, synth::Mixer::Install how, synth::Frame at) {
  const std::scoped_lock lock(rate_mutex_);
  auto voice =
      std::make_unique<synth::Voice>(mixer_.table_for(object.map, object.material, object.dampers, object.modes));
  if (!mixer_.install(object.number, std::move(voice), how, at)) {
    return fail(ErrorKind::refused,
                "object: " + std::to_string(synth::kMaxVoices) + " voices are still ringing out; try again later");
  }
  return {};
}

Result<Event> event_for(const protocol::Request& request, const RackObject& object, synth::Frame frame) {
  Event event{.frame = frame, .object = object.number};
  if (const auto* strike = std::get_if<protocol::Strike>(&request)) {
    event.point_m = strike->point_m;
    event.impulse_ns = strike->impulse_ns;
    event.contact_time_s = strike->contact_time_s;
  } else if (const auto* at_vertex = std::get_if<protocol::StrikeVertex>(&request)) {
    const std::size_t points = object.map->bank().point_count();
    if (at_vertex->vertex >= points) {
      return fail(ErrorKind::bad_input, "vertex: " + std::to_string(at_vertex->vertex) + " is not one of the " +
                                            std::to_string(points) + " sample points of \"" + object.name +
                                            "\", which are numbered from 0");
    }
    event.type = EventType::strike_vertex;
    event.vertex = at_vertex->vertex;
    event.impulse_ns = at_vertex->impulse_ns;
    event.contact_time_s = at_vertex->contact_time_s;
  } else if (const auto* gain = std::get_if<protocol::SetGain>(&request)) {
    event.type = EventType::gain;
    event.value = gain->gain;
    event.ramp_s = gain->ramp_s;
  } else if (const auto* pan = std::get_if<protocol::SetPan>(&request)) {
    event.type = EventType::pan;
    event.value = pan->pan;
  } else if (const auto* contact = std::get_if<protocol::SetContact>(&request)) {
    event.type = EventType::contact;
    event.point_m = contact->point_m;
    event.contact = contact->contact;
  } else if (const auto* ring = std::get_if<protocol::RingModes>(&request)) {
    const std::size_t modes = object.map->bank().mode_count();
    if (ring->first >= modes) {
      return fail(ErrorKind::bad_input, "first: " + std::to_string(ring->first) + " is not one of the " +
                                            std::to_string(modes) + " modes of \"" + object.name +
                                            "\", which are numbered from 0");
    }
    event.type = EventType::ring;
    event.vertex = ring->first;
    event.count = ring->count;
    event.value = ring->amplitude;
  } else if (const auto* click = std::get_if<protocol::Click>(&request)) {
    event.type = EventType::click;
    event.impulse_ns = click->impulse_ns;
    event.contact_time_s = click->contact_time_s;
  } else {
    const auto* clear = std::get_if<protocol::ClearObject>(&request);
    event.type = EventType::clear;
    event.ramp_s = clear ? clear->ramp_s : 0;
  }
  return event;
}

}  // namespace ringdown::session
