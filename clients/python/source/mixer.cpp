// The class Mixer. Python's global lock is what makes the library's worker and control threads one: every method holds
// it, but render, which lets other threads go on and which only one thread at a time may call.
#include <channels.h>

#include <ringdown_python.h>

#include <pybind11/numpy.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>

namespace ringdown::python {

const ringdown_bank* native_bank(const py::handle& bank);  // core.cpp

namespace {

using Number = Whole<std::uint32_t>;
using Object = Number;
using FrameOrNow = std::optional<Whole<std::int64_t>>;

struct Mixer {
  explicit Mixer(const ringdown_settings& settings) : sample_rate_hz(settings.sample_rate_hz) {
    call_without_lock(ringdown_mixer_create, &settings, &handle);
  }
  ~Mixer() { ringdown_mixer_destroy(handle); }
  Mixer(const Mixer&) = delete;
  Mixer& operator=(const Mixer&) = delete;

  ringdown_mixer* handle = nullptr;
  double sample_rate_hz;
  std::size_t ambisonic_channels = 0;
  std::atomic<bool> is_rendering = false;
};

// Holds the mixer for the only thread that may render or change the sample rate.
class Rendering {
 public:
  explicit Rendering(Mixer& mixer) : mixer_(mixer) {
    if (mixer.is_rendering.exchange(true)) raise(RINGDOWN_REFUSED, "another thread is rendering with this mixer");
  }
  ~Rendering() { mixer_.is_rendering = false; }
  Rendering(const Rendering&) = delete;
  Rendering& operator=(const Rendering&) = delete;

 private:
  Mixer& mixer_;
};

using Inputs = std::optional<py::array_t<float, py::array::f_style | py::array::forcecast>>;

// The arrays that one call fills, each of frames x channels; what is missing is not rendered.
struct Sound {
  std::optional<py::array> mix, ambisonics, pickups;
};

void fill(Mixer& self, py::ssize_t frames, const Sound& sound, const Inputs& inputs) {
  std::optional<Channels> mix, sphere, motion;
  ringdown_block block{};
  block.size = sizeof block;
  block.frames = static_cast<std::size_t>(frames);
  if (sound.mix) {
    mix.emplace(*sound.mix, "the array", frames, 2);
    for (std::size_t c = 0; c < 2; ++c) block.mix[c] = mix->channel(c);
  }
  if (sound.ambisonics) {
    if (self.ambisonic_channels == 0) refuse("the mixer was made without ambisonic_order");
    sphere.emplace(*sound.ambisonics, "ambisonics", frames, self.ambisonic_channels);
    for (std::size_t c = 0; c < self.ambisonic_channels; ++c) block.ambisonics[c] = sphere->channel(c);
  }
  if (sound.pickups) {
    motion.emplace(*sound.pickups, "pickups", frames, RINGDOWN_MAX_PICKUPS);
    for (std::size_t c = 0; c < RINGDOWN_MAX_PICKUPS; ++c) block.pickups[c] = motion->channel(c);
  }
  if (inputs && frames > 0) {
    if (inputs->ndim() != 2 || inputs->shape(0) != frames || inputs->shape(1) > RINGDOWN_MAX_INPUTS) {
      refuse("inputs must be an array of frames x at most 4 numbers");
    }
    for (py::ssize_t c = 0; c < inputs->shape(1); ++c) block.inputs[c] = inputs->data(0, c);
  }
  const Rendering rendering(self);
  {
    const py::gil_scoped_release released;
    ringdown_render_all(self.handle, &block);
    if (mix) mix->write_back();
    if (sphere) sphere->write_back();
    if (motion) motion->write_back();
  }
  ringdown_collect(self.handle);
}

// The next frames as an array whose columns are contiguous, so that the library writes into it directly.
py::array render(Mixer& self, py::ssize_t frames, const Inputs& inputs, std::optional<py::array> Sound::*which,
                 std::size_t channels) {
  constexpr py::ssize_t kMaxFrames = py::ssize_t{1} << 40;
  if (frames < 0 || frames > kMaxFrames) refuse("frames must be from 0 to 2^40");
  const auto size = static_cast<py::ssize_t>(sizeof(float));
  const py::array_t<float> samples({frames, static_cast<py::ssize_t>(channels)}, {size, size * frames});
  Sound sound;
  sound.*which = samples;
  fill(self, frames, sound, inputs);
  return samples;
}

std::int64_t at(const Mixer& mixer, const FrameOrNow& frame) { return frame ? *frame : ringdown_now(mixer.handle); }

std::unique_ptr<Mixer> make(double sample_rate_hz, double full_scale_pa, std::optional<double> limiter_db,
                            double floor_db, bool exact_contacts, bool travel_time, Whole<int> ambisonic_order,
                            Whole<int> threads, const py::object& head) {
  constexpr double kNoLimiter_db = 1;
  ringdown_settings settings;
  ringdown_settings_init(&settings, sizeof settings);
  settings.sample_rate_hz = sample_rate_hz;
  settings.full_scale_pa = full_scale_pa;
  settings.limiter_db = limiter_db.value_or(kNoLimiter_db);
  settings.floor_db = floor_db;
  settings.exact_contacts = exact_contacts ? 1 : 0;
  settings.travel_time = travel_time ? 1 : 0;
  settings.ambisonic_order = ambisonic_order;
  settings.threads = threads;
  const std::string file = head.is_none() ? std::string() : path_of(head);
  if (!head.is_none()) settings.head = c_string(file);
  if (limiter_db && *limiter_db > 0) refuse("limiter_db must be from -60 to 0, or None");
  auto mixer = std::make_unique<Mixer>(settings);
  const auto order = static_cast<std::size_t>(ambisonic_order);
  if (order > 0) mixer->ambisonic_channels = (order + 1) * (order + 1);
  return mixer;
}

py::object status_of(const Mixer& self) {
  ringdown_status status{};
  status.size = sizeof status;
  ringdown_get_status(self.handle, &status);
  return py::module_::import("ringdown.values")
      .attr("Status")(status.strikes, status.late, status.dropped, status.refused, status.not_finite, status.objects,
                      status.sounding, status.ringing_modes, status.peak);
}

using Class = py::class_<Mixer>;

void add_sound(Class& mixer) {
  mixer
      .def(
          "render",
          [](Mixer& self, Whole<py::ssize_t> frames, const Inputs& inputs) {
            return render(self, frames, inputs, &Sound::mix, 2);
          },
          py::arg("frames"), py::arg("inputs") = py::none(),
          "The next frames of sound, frames x 2 numbers of type float32. While it computes, other threads "
          "run.\n\n`inputs`, frames x at most 4 numbers, push the objects that excite() names.")
      .def(
          "render_into",
          [](Mixer& self, const py::array& array, const std::optional<py::array>& ambisonics, const Inputs& inputs,
             const std::optional<py::array>& pickups) {
            fill(self, array.ndim() > 0 ? array.shape(0) : 0, {array, ambisonics, pickups}, inputs);
          },
          py::arg("array"), py::arg("ambisonics") = py::none(), py::arg("inputs") = py::none(),
          py::arg("pickups") = py::none(),
          "Fills an array of frames x 2 numbers of type float32 with the next frames, without a copy if its columns "
          "are contiguous (order='F'); and `ambisonics`, if given, with the ambisonic channels, and `pickups`, frames "
          "x "
          "8, with the motion that pickups feel.")
      .def(
          "render_ambisonics",
          [](Mixer& self, Whole<py::ssize_t> frames, const Inputs& inputs) {
            return render(self, frames, inputs, &Sound::ambisonics, self.ambisonic_channels);
          },
          py::arg("frames"), py::arg("inputs") = py::none(),
          "The next frames as (ambisonic_order + 1)^2 channels: AmbiX, channels in ACN order, SN3D.")
      .def(
          "render_pickups",
          [](Mixer& self, Whole<py::ssize_t> frames, const Inputs& inputs) {
            return render(self, frames, inputs, &Sound::pickups, RINGDOWN_MAX_PICKUPS);
          },
          py::arg("frames"), py::arg("inputs") = py::none(),
          "The next frames of the 8 pickups, without the sound: frames x 8 numbers of type float32. Column 0 is "
          "pickup 1.")
      .def_property_readonly(
          "now", [](const Mixer& self) { return ringdown_now(self.handle); },
          "Frames rendered so far: the first frame of the next block.")
      .def_property_readonly(
          "latency_frames", [](const Mixer& self) { return ringdown_latency(self.handle); },
          "Frames by which the limiter delays left and right.")
      .def_property(
          "sample_rate_hz", [](const Mixer& self) { return self.sample_rate_hz; },
          [](Mixer& self, double sample_rate_hz) {
            const Rendering rendering(self);
            call(ringdown_set_sample_rate, self.handle, sample_rate_hz);
            self.sample_rate_hz = sample_rate_hz;
          },
          "The sample rate; ringing sounds keep their pitch when it changes.")
      .def_property_readonly("status", &status_of, "The mixer's state, as a ringdown.Status.");
}

void add_objects(Class& mixer) {
  mixer
      .def(
          "add",
          [](Mixer& self, const py::object& bank, const std::optional<std::string>& name) {
            std::uint32_t object = 0;
            call(ringdown_add, self.handle, name ? c_string(*name) : nullptr, native_bank(bank), &object);
            return object;
          },
          py::arg("bank"), py::arg("name") = py::none(),
          "Adds an object that plays a bank and returns its number, which all other methods take.")
      .def(
          "remove", [](Mixer& self, Object object) { call(ringdown_remove, self.handle, object); }, py::arg("object"),
          "Removes an object; its sound fades out within some milliseconds.")
      .def(
          "material",
          [](Mixer& self, Object object, double stiffness, double density, double size, double alpha, double beta,
             double heat, double air) {
            const ringdown_material material{sizeof material, stiffness, density, size, alpha, beta, heat, air};
            call(ringdown_set_material, self.handle, object, &material);
          },
          py::arg("object"), py::kw_only(), py::arg("stiffness") = 1.0, py::arg("density") = 1.0, py::arg("size") = 1.0,
          py::arg("alpha") = 1.0, py::arg("beta") = 1.0, py::arg("heat") = 1.0, py::arg("air") = 1.0,
          "Factors on the bank's own Young's modulus, density and lengths, and on the losses to supports (alpha), to "
          "the material (beta), to heat that flows in the body and to the air. Ringing sounds are retuned.")
      .def(
          "fill",
          [](Mixer& self, Object object, double level_m, const FrameOrNow& frame) {
            call(ringdown_fill, self.handle, at(self, frame), object, level_m);
          },
          py::arg("object"), py::arg("level_m"), py::kw_only(), py::arg("frame") = py::none(),
          "Lets the liquid in the object stand at a level, in the object's frame; ringing sounds are retuned. The bank "
          "must know its levels (bake it with [fill] and levels = 16).")
      .def(
          "resonator",
          [](Mixer& self, Object object, double detune_cents, double opening, const FrameOrNow& frame) {
            call(ringdown_resonator, self.handle, at(self, frame), object, detune_cents, opening);
          },
          py::arg("object"), py::arg("detune_cents"), py::arg("opening") = 1.0, py::kw_only(),
          py::arg("frame") = py::none(),
          "Tunes the tubes under the object from their tuning as baked, with a share of their mouths open; ringing "
          "sounds are retuned. The bank must have a tube (bake it with [[resonator]]).")
      .def(
          "hold",
          [](Mixer& self, Object object, const Vector& point_m, double damping_ns_m, const Vector& direction,
             Number number, const FrameOrNow& frame) {
            call(ringdown_hold, self.handle, at(self, frame), object, number, point_m.data(), direction.data(),
                 damping_ns_m);
          },
          py::arg("object"), py::arg("point_m"), py::arg("damping_ns_m") = 10.0, py::kw_only(),
          py::arg("direction") = Vector{}, py::arg("number") = 0, py::arg("frame") = py::none(),
          "Lays a damper, such as a hand or a table, on the object: damper `number`, 0 to 7, resists motion along "
          "`direction` (0 0 0: any) with a damping in N s/m. A finger is about 0.1, a hand 10; 0 removes the damper.")
      .def(
          "mute", [](Mixer& self, Object object, bool on) { call(ringdown_mute, self.handle, object, on ? 1 : 0); },
          py::arg("object"), py::arg("on") = true, "A muted object is not heard.")
      .def(
          "solo", [](Mixer& self, Object object, bool on) { call(ringdown_solo, self.handle, object, on ? 1 : 0); },
          py::arg("object"), py::arg("on") = true, "While any object is soloed, only soloed ones are heard.")
      .def(
          "excite",
          [](Mixer& self, Number input, Object object, const Vector& point_m, const Vector& force_n) {
            call(ringdown_excite, self.handle, input, object, point_m.data(), force_n.data());
          },
          py::arg("input"), py::arg("object"), py::arg("point_m"), py::arg("force_n"),
          "From the next block on, a sample of 1 of an input of render() is a force [N] on the object. A force of 0 0 "
          "0 disconnects it.");
}

py::tuple pieces_of(const Mixer& self, std::uint32_t object) {
  py::list pieces;
  ringdown_piece_info info{};
  info.size = sizeof info;
  do {
    call(ringdown_piece, self.handle, object, static_cast<std::uint32_t>(pieces.size()), &info);
    pieces.append(piece_of(info));
  } while (pieces.size() < info.pieces);
  return py::tuple(pieces);
}

void add_breaking(Class& mixer) {
  mixer
      .def(
          "arm",
          [](Mixer& self, Object object, const std::optional<Whole<std::int32_t>>& pattern) {
            std::uint32_t pieces = 0;
            call(ringdown_arm, self.handle, object, pattern ? pattern->value : -1, &pieces);
            return pieces;
          },
          py::arg("object"), py::arg("pattern") = py::none(),
          "Loads the pieces that the object breaks into and returns their number: those of a pattern of its bank, or of"
          " the finest at the place of the first.")
      .def(
          "break_",
          [](Mixer& self, Object object, const Vector& point_m, const Vector& impulse_ns, double contact_time_s,
             const FrameOrNow& frame) {
            call(ringdown_break, self.handle, at(self, frame), object, point_m.data(), impulse_ns.data(),
                 contact_time_s, nullptr);
            return pieces_of(self, object);
          },
          py::arg("object"), py::arg("point_m"), py::arg("impulse_ns"), py::arg("contact_time_s") = 0.0002,
          py::arg("frame") = py::none(),
          "Breaks an armed object at the peak of a blow: it falls silent, and its pieces go on with its motion. Returns"
          " a ringdown.Piece for each, whose velocity has the first half of the blow.")
      .def(
          "pieces", [](Mixer& self, Object object) { return pieces_of(self, object); }, py::arg("object"),
          "A ringdown.Piece for each piece of an armed or broken object.")
      .def(
          "stress_pa",
          [](Mixer& self, Object object, const Vector& point_m, const Vector& impulse_ns, double contact_time_s,
             const FrameOrNow& frame) {
            double stress_pa = 0;
            call(ringdown_stress, self.handle, at(self, frame), object, point_m.data(), impulse_ns.data(),
                 contact_time_s, &stress_pa);
            return stress_pa;
          },
          py::arg("object"), py::arg("point_m"), py::arg("impulse_ns"), py::arg("contact_time_s") = 0.0002,
          py::arg("frame") = py::none(),
          "The largest tensile stress that a blow would cause in an armed object; 0 if its bank does not know.")
      .def(
          "mend", [](Mixer& self, Object object) { call(ringdown_mend, self.handle, object); }, py::arg("object"),
          "Removes the pieces of an object; it can be struck again.");
}

#include <verbs.inc>

}  // namespace

void add_mixer(py::module_& module) {
  Class mixer(module, "Mixer",
              "Plays banks: objects, events with frames, and blocks of sound.\n\nUnits are SI. Points and impulses are "
              "in the object's own frame. Time is counted in sample frames from the first frame that the mixer "
              "renders; an event without a frame happens at the beginning of the next block. At most 4096 events may "
              "come between two blocks, and at most 1024 happen in 128 frames. Failures raise ringdown.Error.");
  mixer.def(py::init(&make), py::arg("sample_rate_hz") = 48000.0, py::kw_only(), py::arg("full_scale_pa") = 20.0,
            py::arg("limiter_db") = -1.0, py::arg("floor_db") = 120.0, py::arg("exact_contacts") = false,
            py::arg("travel_time") = false, py::arg("ambisonic_order") = 0, py::arg("threads") = 1,
            py::arg("head") = py::none(),
            "full_scale_pa: the sound pressure at 1 m that becomes a sample of 1; of an object in the middle, 0.707 on "
            "either side. limiter_db: ceiling of left and right, -60 to 0 dB, or None. floor_db: modes this many dB "
            "below full scale rest. exact_contacts: a strike's pulse drives the modes sample by sample. travel_time: "
            "delay each event by the travel time of its sound to the listener. ambisonic_order: 1 to 3, for "
            "render_ambisonics(). head: a SOFA file for binaural sound, or '' for libmysofa's own head.");
  add_objects(mixer);
  add_breaking(mixer);
  add_verbs(mixer);
  add_sound(mixer);
  mixer.def("_capsule", [](Mixer& self) { return py::capsule(self.handle, kMixerCapsule); });
}

}  // namespace ringdown::python
