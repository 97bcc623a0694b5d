#include "server/session/rack.h"

#include "protocol/names.h"

#include <utility>

namespace ringdown::session {
namespace {

using protocol::ObjectRef;
using synth::Event;

std::string shown(const ObjectRef& object) {
  return object.number ? formatted("number {}", *object.number) : "\"" + object.name + "\"";
}

Result<synth::ObjectNumber> free_number(const ObjectTable& objects, const synth::Mixer& mixer) {
  for (synth::ObjectNumber number = 0; number < synth::kMaxObjects; ++number) {
    if (!objects.find(number) && !mixer.in_use(number)) return number;
  }
  return fail(ErrorKind::too_large, "all {} objects are in use; remove one, and try again when it has faded out",
              synth::kMaxObjects);
}

// Gives an object the bus of its name and group.
Result<void> assign(const ObjectState& object, Buses& buses, Rack::Warn& warn, synth::Mixer& mixer) {
  const std::size_t before = buses.overflow();
  const auto bus = buses.join(object.number, object.name, object.group);
  if (buses.overflow() > before) {
    warn(formatted("{} is heard in the mix only: all {} ports are taken", object.name, synth::kMaxBuses));
  }
  if (mixer.assign(object.number, bus)) return {};
  return fail(ErrorKind::refused, "too many changes of objects at once; try again");
}

}  // namespace

Result<ObjectSnapshot> Rack::find(const ObjectRef& ref) const {
  if (ObjectSnapshot object = ref.number ? objects_.find(*ref.number) : objects_.find(ref.name)) return object;
  return fail(ErrorKind::bad_input, "there is no object " + shown(ref) + "; it was never loaded, or has been removed");
}

bool Rack::push(synth::Producer producer, const Event& described) {
  Event event = described;
  if (vary_) vary_(event);
  if (!mixer_.push(producer, event)) return false;
  const auto* const gain = event.verb.get_if<synth::verb::Gain>();
  const auto* const pan = event.verb.get_if<synth::verb::Pan>();
  const auto* const fan = event.verb.get_if<synth::verb::Fan>();
  if (const ObjectSnapshot object = gain || pan || fan ? objects_.find(event.object) : nullptr) {
    if (gain) object->gain.set(gain->gain);
    if (pan) object->pan.set(pan->pan);
    if (fan) object->fan_hz.set(fan->rate_hz), object->fan_depth.set(fan->depth);
  }
  if (const auto* const pickup = event.verb.get_if<synth::verb::Pickup>()) pickups_ |= 1u << (pickup->number - 1);
  listener_.keep(event);
  observers_.keep(producer, event);
  return true;
}

Result<synth::ObjectNumber> Rack::load(const std::string& name, const std::filesystem::path& bank) {
  auto file = banks_.read(bank);
  if (!file) return fail(file);
  return add(name, bank, *std::move(file));
}

Result<synth::ObjectNumber> Rack::add(const std::string& name, const std::filesystem::path& path, BankFile bank) {
  ObjectState object{.name = name,
                     .bank = path,
                     .bank_bytes = bank.bytes,
                     .bank_content = bank.content,
                     .bank_alone = std::move(bank.alone),
                     .bank_version = last_bank_version_ + 1,
                     .map = bank.map,
                     .baked_map = bank.map};
  const ObjectSnapshot old = objects_.find(name);
  if (old) {
    object.number = old->number;
    object.group = old->group;
    object.gain = old->gain;
    object.pan = old->pan;
    object.fan_hz = old->fan_hz;
    object.fan_depth = old->fan_depth;
    object.mute = old->mute;
    object.solo = old->solo;
  } else {
    const auto number = free_number(objects_, mixer_);
    if (!number) return fail(number);
    object.number = *number;
  }
  if (const auto silenced = silences_.update(objects_.all(), &object); !silenced) return fail(silenced);
  if (const auto installed = install(object, synth::Mixer::Install::replace); !installed) return fail(installed);
  fading_.erase(object.number);
  if (const auto assigned = assign(object, buses_, warn, mixer_); !assigned) return fail(assigned);
  last_bank_version_ = object.bank_version;
  if (old) {
    change(*old, [&](ObjectState& present) { present = object; });
  } else {
    observers_.report_change(nullptr, objects_.add(object).get(), 0);
  }
  return object.number;
}

void Rack::change(const ObjectState& object, const Edit& edit, synth::Frame at) {
  const auto [before, after] = objects_.replace(object.number, edit);
  observers_.report_change(before.get(), after.get(), at);
}

Result<void> Rack::retune(const ObjectState& object, const Edit& edit, synth::Frame at) {
  ObjectState next = object;
  edit(next);
  auto installed = install(next, synth::Mixer::Install::retune, at, mode_change(object, next));
  if (!installed) return installed;
  change(object, edit, at);
  return {};
}

Result<void> Rack::set_material(const ObjectRef& ref, const modal::MaterialScale& scale,
                                std::optional<double> untuned_size) {
  const auto object = find(ref);
  if (!object) return fail(object);
  return retune(**object, [&](ObjectState& o) {
    if (untuned_size) {
      o.untuned_size = untuned_size;
    } else if (o.untuned_size) {
      *o.untuned_size *= scale.size / o.material.size;  // the tuning goes on to change the size by as much
    }
    o.material = scale;
  });
}

Result<void> Rack::set_dampers(const ObjectRef& ref, const modal::Dampers& dampers, synth::Frame at) {
  const auto object = find(ref);
  if (!object) return fail(object);
  modal::Dampers all = (*object)->dampers;
  for (const auto& [number, damper] : dampers) {
    if (damper.damping_ns_m > 0) {
      all.insert_or_assign(number, damper);
    } else {
      all.erase(number);
    }
  }
  if (all == (*object)->dampers) return {};
  return retune(
      **object, [&](ObjectState& o) { o.dampers = all; }, at);
}

Result<void> Rack::set_level(const ObjectRef& ref, double level_m, synth::Frame at) {
  const auto object = find(ref);
  if (!object) return fail(object);
  auto found = modal::at_level((*object)->baked_map->bank(), level_m / (*object)->material.size);
  if (!found) return fail("level", found);
  const auto map =
      std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(found->bank)));
  const auto modes = std::make_shared<const modal::LevelModes>(std::move(found->modes));
  return retune(
      **object, [&](ObjectState& o) { o.map = map, o.at_level = modes; }, at);
}

Result<void> Rack::set_tubes(const ObjectRef& ref, const modal::TubeTuning& tuning, synth::Frame at) {
  const auto object = find(ref);
  if (!object) return fail(object);
  auto found = modal::at_tuning((*object)->baked_map->bank(), tuning);
  if (!found) return fail("resonator", found);
  const auto map =
      std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(found->bank)));
  const auto modes = std::make_shared<const modal::TubeModes>(std::move(found->modes));
  return retune(
      **object, [&](ObjectState& o) { o.map = map, o.tubes = modes; }, at);
}

Result<void> Rack::select_modes(const ObjectRef& ref, modal::ModeRange modes) {
  const auto object = find(ref);
  if (!object) return fail(object);
  return retune(**object, [&](ObjectState& o) { o.modes = modes; });
}

Result<void> Rack::set_group(const ObjectRef& ref, const std::string& group) {
  const auto object = find(ref);
  if (!object) return fail(object);
  ObjectState next = **object;
  next.group = group;
  if (const auto assigned = assign(next, buses_, warn, mixer_); !assigned) return assigned;
  change(next, [&](ObjectState& o) { o.group = group; });
  return {};
}

Result<void> Rack::set_heard(const ObjectRef& ref, bool ObjectState::*flag, bool on) {
  const auto object = find(ref);
  if (!object) return fail(object);
  if ((**object).*flag == on) return {};
  ObjectState next = **object;
  next.*flag = on;
  if (const auto silenced = silences_.update(objects_.all(), &next); !silenced) return silenced;
  change(next, [&](ObjectState& o) { o.*flag = on; });
  return {};
}

static_assert(protocol::kMaxInputs == synth::kMaxInputs && protocol::kMaxPickups == synth::kMaxPickups);

Result<void> Rack::excite(std::size_t input, const ObjectRef& ref, const Vec3& point_m, const Vec3& force_n) {
  const auto found = find(ref);
  if (!found) return fail(found);
  const ObjectState& object = **found;
  std::optional<Excitation>& excitation = excitations_[input];
  const bool ends = force_n == Vec3{};
  if (ends && (!excitation || excitation->object != object.number)) {
    return fail(ErrorKind::bad_input, "the input does not excite \"" + object.name + "\", so there is nothing to end");
  }
  if (const auto good = ends ? Result<void>() : check_point(point_m, object); !good) return good;
  if (object.map->bank().mode_count() > synth::kMaxDrivenColumns) {
    return fail(ErrorKind::too_large,
                "\"{}\" has more than the {} modes that an input can excite; bake it with `ringdown bake --keep`",
                object.name, synth::kMaxDrivenColumns);
  }
  const std::scoped_lock lock(rate_mutex_);
  const Vec3 impulse_ns = (1 / mixer_.sample_rate_hz()) * force_n;
  const bool taken =
      ends ? mixer_.disconnect_input(input) : mixer_.connect_input(input, object.number, point_m, impulse_ns);
  if (!taken) return fail(ErrorKind::refused, "too many changes of inputs at once; try again");
  excitation = ends ? std::nullopt : std::optional(Excitation{object.number, point_m, force_n});
  inputs_ |= 1u << input;
  observers_.report_change();
  return {};
}

std::map<std::size_t, std::string> Rack::ports() const {
  std::map<std::size_t, std::string> ports = buses_.names();
  for (std::size_t pickup = 0; pickup < synth::kMaxPickups; ++pickup) {
    if ((pickups_ >> pickup & 1) != 0) ports[synth::kMaxBuses + pickup] = formatted("pickup_{}", pickup + 1);
  }
  return ports;
}

void Rack::collect() {
  {
    const std::scoped_lock lock(rate_mutex_);
    mixer_.collect();
  }
  objects_.collect();
  observers_.report_events();
  banks_.forget_unused();
  const std::size_t faded = std::erase_if(fading_, [this](synth::ObjectNumber number) {
    if (mixer_.in_use(number)) return false;
    buses_.leave(number);
    return true;
  });
  const std::uint32_t pickups = pickups_;
  if (faded > 0 || std::exchange(shown_pickups_, pickups) != pickups) observers_.report_change();
}

Result<void> Rack::free(const ObjectRef& ref) {
  const auto found = find(ref);
  if (!found) return fail(found);
  const ObjectSnapshot& object = *found;
  if (!mixer_.remove(object->number)) return fail(ErrorKind::refused, "too many changes of objects at once; try again");
  fading_.insert(object->number);
  for (auto& excitation : excitations_) {
    if (excitation && excitation->object == object->number) excitation.reset();
  }
  observers_.report_events();  // while the object's name can still be found
  objects_.remove(object->number);
  silences_.forget(object->number);
  observers_.report_change(object.get(), nullptr, 0);
  return silences_.update(objects_.all());
}

void Rack::change_sample_rate(double sample_rate_hz) {
  const std::scoped_lock lock(rate_mutex_);
  mixer_.change_sample_rate(sample_rate_hz);
}

Result<void> Rack::install(const ObjectState& object, synth::Mixer::Install how, synth::Frame at,
                           std::shared_ptr<const modal::ModeTransfer> mode_change) {
  const std::scoped_lock lock(rate_mutex_);
  auto voice =
      std::make_unique<synth::Voice>(mixer_.table_for(object.map, object.material, object.dampers, object.modes));
  voice->mode_change = std::move(mode_change);
  if (!mixer_.install(object.number, std::move(voice), how, at)) {
    return fail(ErrorKind::refused, "{} voices are still ringing out; try again later", synth::kMaxVoices);
  }
  return {};
}

}  // namespace ringdown::session
