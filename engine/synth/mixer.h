// Everything that rings, summed to a stereo mix and to buses: what the JACK callback runs.
//
// Threads. One audio thread calls render(). Each Producer is one thread that pushes events through its own ring. One
// worker thread installs and collects voices. None of them ever waits for another, and the audio thread neither
// allocates, locks, makes system calls nor frees.
//
// Time. Frame 0 is the first frame ever rendered. An event happens at its own frame whatever the block size; one whose
// frame has passed happens at once and is counted as late.
//
// Banks. install() gives an object a new voice at the start of the next block, while the voice it had rings out beside
// it. Voices that have died away come back through collect(), which frees them on the worker. Objects whose voices
// share a table share their states too (family.h).
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/agenda.h"
#include "engine/synth/budget.h"
#include "engine/synth/crew.h"
#include "engine/synth/desk.h"
#include "engine/synth/drives.h"
#include "engine/synth/event.h"
#include "engine/synth/family.h"
#include "engine/synth/hearing.h"
#include "engine/synth/limiter.h"
#include "engine/synth/mixer_counters.h"
#include "engine/synth/mode_watch.h"
#include "engine/synth/outputs.h"
#include "engine/synth/ramp.h"
#include "engine/synth/sound_tap.h"
#include "engine/synth/test_tone.h"
#include "engine/synth/voice.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::synth {

// Capacities. Past one, a push or install returns false and nothing changes.
inline constexpr std::size_t kMaxObjects = 1024;
inline constexpr std::size_t kMaxVoices = 4096;             // playing, ringing out or waiting for collect()
inline constexpr std::size_t kMaxEventsPerChunk = 512;      // more in one chunk happen up to kChunkFrames later
inline constexpr std::size_t kMaxBuses = kMaxChannels - 2;  // outputs beside the stereo mix

inline constexpr std::size_t kMinModesToMask = 2048;  // modes that ring; with fewer none is hidden by set_masking()

class Mixer {
 public:
  explicit Mixer(double sample_rate_hz);
  ~Mixer();
  Mixer(const Mixer&) = delete;
  Mixer& operator=(const Mixer&) = delete;

  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_.load(std::memory_order_relaxed); }

  // Goes on at another sample rate: what rings keeps pitch, decay, phase and loudness; events, gains and pans on their
  // way come as many seconds from now as before. The frames go on counting. Takes about as long as installing every
  // voice anew. [worker, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz);

  // Spreads big scenes over so many threads, the audio thread among them; 1 unless set. With more than one, rounding
  // depends on who does what. [worker, while nothing is rendered]
  void set_threads(std::size_t threads);

  // Keeps the mix, but not the buses, below a ceiling in dB of full scale, and latency_frames() late (limiter.h);
  // nullopt: samples go out as they are, as in the beginning. [worker, while nothing is rendered]
  void limit(std::optional<double> ceiling_db);

  // By how much the mix comes later than events say. [any, but not while limit() runs]
  [[nodiscard]] std::size_t latency_frames() const { return limiter_ ? limiter_->delay_frames() : 0; }

  // Hands an event over. False when the producer's ring is full: the event was not taken. The event's object is
  // < kMaxObjects and its numbers are finite. [the producer's thread]
  [[nodiscard]] bool push(Producer producer, const Event& event) RINGDOWN_REALTIME {
    return agenda_.push(producer, event);
  }

  // The table that voices of this bank, material, dampers and choice of modes share; a new one if there is none.
  // [worker]
  [[nodiscard]] std::shared_ptr<ModeTable> table_for(const std::shared_ptr<const modal::StrikeMap>& map,
                                                     const modal::MaterialScale& material,
                                                     const modal::Dampers& dampers = {},
                                                     modal::ModeRange modes = {}) const;

  enum class Install {
    replace,  // the old voice rings out, the new one takes the strikes to come
    retune,   // the new voice, of the same bank, takes over what rings of its modes; the others fade out
  };
  // Gives `object` a new voice from frame `at` on, or as soon as that is past; what is ordered later waits for it.
  // False when kMaxVoices are alive. [worker]
  [[nodiscard]] bool install(ObjectNumber object, std::unique_ptr<Voice> voice, Install how, Frame at = 0);

  // Takes the object away: what rings fades out within Voice::kFadeFrames. False when the worker's ring is full.
  // [worker]
  [[nodiscard]] bool remove(ObjectNumber object);

  // Sends the object, at its gain, to a bus as well as to the mix, from the next block on; nullopt: to the mix only, as
  // in the beginning. Several objects may share a bus. False when the worker's ring is full. [worker]
  [[nodiscard]] bool assign(ObjectNumber object, std::optional<std::size_t> bus);

  // Frees the voices that have died away. [worker]
  void collect();

  // True while `object` has a voice that is playing, ringing out or not yet collected. [worker]
  [[nodiscard]] bool in_use(ObjectNumber object) const { return voices_of_[object] > 0; }

  // Modes whose amplitude, at the gain of their object, lies so far below full scale rest until the next strike; 120 dB
  // unless set. [any thread]
  void set_floor(double decibels) { floor_.store(std::pow(10.0, -decibels / 20), std::memory_order_relaxed); }

  // Whether a strike's contact pulse drives the modes sample by sample, from the strike's frame on; otherwise, as in
  // the beginning, each mode gets at that frame what the spectrum of the pulse holds for it. They differ while the
  // contact lasts; after it only in the phase. Driving costs more while the contact lasts, and serves kMaxDrives
  // strikes at a time. [any thread]
  void set_exact_contacts(bool on) { exact_contacts_.store(on, std::memory_order_relaxed); }

  // From the next block on, input `input` < kMaxInputs excites an object: a sample of 1 is the impulse of `place`, a
  // strike without contact time, in one frame. An input excites one object, an object takes kMaxForces inputs and
  // pulses at a time; nothing happens when it does not exist. False when the worker's ring is full. [worker]
  [[nodiscard]] bool connect_input(std::size_t input, const Event& place);
  [[nodiscard]] bool disconnect_input(std::size_t input);

  // Leaves out what louder modes hide (hearing.h); off unless set. With fewer modes than that, looking for what is
  // hidden would cost more than it saves. [any thread]
  void set_masking(bool on, std::size_t fewest_modes = kMinModesToMask) {
    masking_from_.store(on ? fewest_modes : kNever, std::memory_order_relaxed);
  }

  // What render() may use of the time that a block lasts, 0 ... 1; 0, as in the beginning: as long as it takes. When
  // time is short, masked modes and then the quietest ones are not computed, strikes wait for the next chunks, and if
  // that was not enough objects fall silent for a chunk. Nothing is lost: states move on, and what was left out comes
  // back when there is time. [any thread]
  void set_budget(double share) { budget_.set_share(share); }
  void set_clock(Budget::Clock clock) { budget_.set_clock(clock); }  // for tests [worker, while nothing is rendered]

  // Whether blocks are due at a certain time, as they are unless set; without, the budget does not count. [audio]
  void keep_deadlines(bool on) RINGDOWN_REALTIME { deadlines_ = on; }

  // Writes the next frames; any number of frames. [audio]
  void render(const Outputs& outputs, const Inputs& inputs, std::size_t frames) RINGDOWN_REALTIME;
  void render(const Outputs& outputs, std::size_t frames) RINGDOWN_REALTIME { render(outputs, {}, frames); }
  void render(std::span<float> left, std::span<float> right) RINGDOWN_REALTIME;  // the mix only

  // Whether the objects' own levels are kept; costs nothing unless set, and 2048 modes at most in a chunk then, so that
  // many objects are looked at in turn: 64 in each chunk, or fewer. What sounds does not depend on it. [any thread]
  void watch_objects(bool on) { watch_objects_.store(on, std::memory_order_relaxed); }

  // What no sample of the object, at its gain, has exceeded since the last call, as far as it was looked at: the sum of
  // its modes' amplitudes. Of one mode it is the peak; many do not peak together. [one thread that is not audio]
  [[nodiscard]] float take_reach(ObjectNumber object);

  // A sine in the mix; what the mix sounds like; the amplitudes of objects' modes, at their gain and before pan.
  [[nodiscard]] TestTone& test_tone() { return test_tone_; }
  [[nodiscard]] SoundTap& sound_tap() { return sound_tap_; }
  [[nodiscard]] ModeWatch& mode_watch() { return mode_watch_; }

  [[nodiscard]] const MixerCounters& counters() const { return counters_; }

  // The largest |sample| since the last call. [one thread that is not audio]
  [[nodiscard]] float take_peak() { return counters_.peak_since.exchange(0, std::memory_order_relaxed); }

 private:
  template <class T>
  static void count(std::atomic<T>& counter, std::size_t times = 1) RINGDOWN_REALTIME {
    if (times > 0) counter.fetch_add(times, std::memory_order_relaxed);
  }
  struct DueEvent {
    Event event;
    std::size_t offset;  // frames into the chunk
    std::int32_t next;   // the object's next event in this chunk, -1 for none
    Frame frame;         // as the agenda had it
    std::uint64_t order;
  };
  // What work costs, in units of what moments cost for a mode, 1.4 ns: moments cost kMomentsFixed more, tables 1 for a
  // mode and kFramesPerMode frames. Measured by `./run bench mixer`, with AVX-512.
  static constexpr std::size_t kMomentsFixed = 1100, kFramesPerMode = 28;
  static constexpr double kComingPerMode = 1.5, kSurveyPerMode = 0.3;
  static constexpr std::size_t kNever = ~std::size_t{0};
  static constexpr double kCentre = 0.70710678118654752;              // equal power: cos 45 degrees
  static constexpr std::size_t kLeft = 0, kRight = 1, kFirstBus = 2;  // channels
  static constexpr std::size_t kNoBus = 0;
  struct Object {
    std::size_t bus = kNoBus;  // its channel
    Voice* current = nullptr;  // takes strikes
    Voice* tails = nullptr;    // ring out
    Ramp gain{1, 1}, left{kCentre, kCentre}, right{kCentre, kCentre};
    bool active = false;  // listed in active_
    bool shared = false;  // its states stand in its family's, and the rest is about that:
    Family::Shares shares{};
    Frame parted = -1;                  // the chunk in which something else than strikes happens to it
    Frame anchor = 0;                   // the frame that the states it keeps for itself have reached
    std::uint32_t round = 0, lost = 0;  // its family's, when it was last struck, or lost its states
    std::array<std::uint8_t, kMaxForces> drives{};
    std::size_t drive_count = 0;
    std::int32_t first_due = -1, last_due = -1;
  };
  // What one thread renders with.
  struct Place {
    Desk desk;
    std::array<double, kChunkFrames> mono{};
    std::array<std::array<double, kChunkFrames>, kMaxForces> impulses{};
    std::uint32_t ringing_voices = 0, ringing_modes = 0, hidden_modes = 0;  // of the chunk being rendered
    std::size_t slow_modes = 0;                                             // of these, that take moments
    double units = 0;                                                       // of work (budget.h)
    bool missed = false;                                                    // there was no time for all
    std::size_t most_coming = 0;                                            // hidden modes that may come back
  };
  enum class After : std::uint8_t { keep, drop, look_at_tails };  // of an active object when the chunk is done
  struct Order {
    enum class Kind { replace, retune, remove, assign, found_family, connect, disconnect } kind;
    ObjectNumber object;
    Frame at = 0;  // not before; nor is what was ordered after it
    Voice* voice = nullptr;
    std::size_t channel = kNoBus;
    Family* family = nullptr;
    std::size_t input = 0;
    Event place{};
  };
  struct Kin {
    std::weak_ptr<ModeTable> table;
    std::unique_ptr<Family> family;  // null while the table has one voice
  };
  struct Retired {
    ObjectNumber object;
    Voice* voice;
  };

  void accept_orders(Frame until) RINGDOWN_REALTIME;
  void carry_out(const Order& order) RINGDOWN_REALTIME;
  void render_chunk(std::size_t frames) RINGDOWN_REALTIME;
  void prepare_tables(std::size_t frames) RINGDOWN_REALTIME;
  [[nodiscard]] bool choose_path(std::size_t frames) RINGDOWN_REALTIME;
  // mixer_events.cpp
  void take_due_events(std::size_t frames) RINGDOWN_REALTIME;
  void link_due_events(std::int32_t count) RINGDOWN_REALTIME;
  void put_back(std::int32_t& first_due) RINGDOWN_REALTIME;
  void apply(Object& object, const Event& event) RINGDOWN_REALTIME;
  static void fade_out(Object& object, std::size_t frames) RINGDOWN_REALTIME;

  // mixer_masking.cpp
  void survey(std::size_t frames) RINGDOWN_REALTIME;
  void attend(Object& object) RINGDOWN_REALTIME;
  void attend(Family& family) RINGDOWN_REALTIME;
  [[nodiscard]] double survey_item(std::size_t item) RINGDOWN_REALTIME;
  void decide(bool masking) RINGDOWN_REALTIME;
  void listen(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME;
  void listen(Family& family, bool in_turn, Place& place) RINGDOWN_REALTIME;
  void listen(Ringing& states, Level loudness, bool in_turn, Place& place) RINGDOWN_REALTIME;
  [[nodiscard]] static Level loudness_of(const Object& object) RINGDOWN_REALTIME;

  // mixer_budget.cpp
  [[nodiscard]] double units_of(std::size_t modes) const RINGDOWN_REALTIME;
  [[nodiscard]] double units_of(const Event& event) const RINGDOWN_REALTIME;
  [[nodiscard]] static double units_to_share(const Object& object) RINGDOWN_REALTIME;
  [[nodiscard]] double units_to_drive(const Object& object, std::size_t frames) const RINGDOWN_REALTIME;
  [[nodiscard]] double units_of_item(std::size_t item) const RINGDOWN_REALTIME;
  [[nodiscard]] bool can_afford(const Event& event) RINGDOWN_REALTIME;
  [[nodiscard]] bool must_wait(const Event& event, Place& place) const RINGDOWN_REALTIME;
  [[nodiscard]] bool must_miss(std::size_t item) const RINGDOWN_REALTIME;
  void miss(std::size_t item, Place& place) RINGDOWN_REALTIME;
  [[nodiscard]] std::size_t most_coming() const RINGDOWN_REALTIME;
  [[nodiscard]] double most_modes() const RINGDOWN_REALTIME;
  void count_work(double units, Place& place) const RINGDOWN_REALTIME;
  void close_budget() RINGDOWN_REALTIME;

  void open_places(std::size_t frames) RINGDOWN_REALTIME;
  void gather_places() RINGDOWN_REALTIME;
  void render_item(std::size_t item, Place& place) RINGDOWN_REALTIME;
  void visit(std::size_t item, Place& place) RINGDOWN_REALTIME;
  void keep_active() RINGDOWN_REALTIME;
  void activate(Object& object) RINGDOWN_REALTIME;
  void keep_as_tail(Object& object, Voice* voice) RINGDOWN_REALTIME;
  void retire_silent_tails(Object& object) RINGDOWN_REALTIME;
  void reset(Object& object) RINGDOWN_REALTIME;
  [[nodiscard]] ObjectNumber number_of(const Object& object) const RINGDOWN_REALTIME;

  // mixer_objects.cpp
  void render_object(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME;
  [[nodiscard]] bool plain_in_chunk(const Object& object) const RINGDOWN_REALTIME;
  [[nodiscard]] static bool still(const Object& object, Frame at) RINGDOWN_REALTIME;
  void render_in_segments(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME;
  void render_together(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME;
  void add_strikes(Object& object, Place& place) RINGDOWN_REALTIME;
  [[nodiscard]] double floor_of(const Object& object) const RINGDOWN_REALTIME;
  void render_segment(Object& object, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME;
  void mix_segment(const Object& object, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME;
  [[nodiscard]] bool heard(const Object& object) const RINGDOWN_REALTIME;

  // mixer_drives.cpp
  [[nodiscard]] bool start_pulse(const Event& event) RINGDOWN_REALTIME;
  [[nodiscard]] Drive* find_contact(const Object& object, std::uint32_t number) RINGDOWN_REALTIME;
  [[nodiscard]] bool open_contact(const Event& event) RINGDOWN_REALTIME;
  [[nodiscard]] static Event place_of(const Event& event) RINGDOWN_REALTIME;
  void tell(Object& object, const Event& event) RINGDOWN_REALTIME;
  void stop_pulses(const Object& object, Frame end) RINGDOWN_REALTIME;
  void connect(const Order& order) RINGDOWN_REALTIME;
  void disconnect(std::size_t input) RINGDOWN_REALTIME;
  [[nodiscard]] bool place_drive(Object& object, std::uint8_t drive) RINGDOWN_REALTIME;
  void place_drives_again(Object& object) RINGDOWN_REALTIME;
  void drop_drive(Object& object, std::size_t which) RINGDOWN_REALTIME;
  void drop_pulse(Object& object) RINGDOWN_REALTIME;
  void keep_drives(Object& object, Frame end) RINGDOWN_REALTIME;
  [[nodiscard]] bool has_pulse(const Object& object) const RINGDOWN_REALTIME;
  [[nodiscard]] bool driven(const Object& object) const RINGDOWN_REALTIME;
  [[nodiscard]] std::size_t wake_inputs(std::size_t frames) RINGDOWN_REALTIME;
  void start_click(const Event& event) RINGDOWN_REALTIME;
  void render_clicks() RINGDOWN_REALTIME;
  void drive(Object& object, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME;

  // mixer_output.cpp
  [[nodiscard]] Outputs with_tap(Outputs outputs, std::size_t frames) RINGDOWN_REALTIME;
  struct Peaks {  // the largest |sample|
    float mix = 0, buses = 0;
  };
  void write(const Outputs& outputs, std::size_t at, std::size_t frames, Peaks& peaks) RINGDOWN_REALTIME;
  [[nodiscard]] float finish_mix(const Outputs& outputs, std::size_t frames, Peaks written) RINGDOWN_REALTIME;

  // mixer_reach.cpp
  void measure_modes() RINGDOWN_REALTIME;
  void measure_objects() RINGDOWN_REALTIME;
  std::size_t tell_modes(const Object& object, ModeWatch::Place& place) const RINGDOWN_REALTIME;
  [[nodiscard]] double reach_of(const Object& object, std::size_t& modes) const RINGDOWN_REALTIME;

  // mixer_families.cpp
  void found_family(ObjectNumber object, const std::shared_ptr<ModeTable>& table);
  [[nodiscard]] static bool can_share(const Object& object, Frame now) RINGDOWN_REALTIME;
  void share(Object& object, Frame now) RINGDOWN_REALTIME;
  void part(Object& object) RINGDOWN_REALTIME;
  static void catch_up(Object& object, Frame now) RINGDOWN_REALTIME;
  static void note_struck(Object& object, Family& family) RINGDOWN_REALTIME;
  void activate(Family& family) RINGDOWN_REALTIME;
  void keep_active_families() RINGDOWN_REALTIME;
  // Calls `each(sum, channel)` for the outputs that the family has.
  template <class Each>
  static void for_outputs(Family& family, const Each& each) RINGDOWN_REALTIME {
    each(family.sums[0], kLeft);
    each(family.sums[1], kRight);
    if (family.bus != kNoBus) each(family.sums[2], family.bus);
  }
  [[nodiscard]] bool strike(Family& family, const Event& event, std::size_t left) RINGDOWN_REALTIME;
  void render_family(Family& family, bool in_turn, Place& place) RINGDOWN_REALTIME;
  void render_together(Family& family, Place& place) RINGDOWN_REALTIME;
  void render_segment(Family& family, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME;
  void render_aside(Family& family, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME;
  void keep_if(bool sane, Family& family) RINGDOWN_REALTIME;

  std::atomic<double> sample_rate_hz_;
  std::atomic<double> floor_{1e-6};
  std::atomic<bool> exact_contacts_{false};
  std::atomic<std::size_t> masking_from_{kNever};  // so many modes
  std::atomic<bool> watch_objects_{false};
  MixerCounters counters_;
  struct Reach {
    std::atomic<float> now{0}, since{0};
  };
  std::vector<Reach> reaches_ = std::vector<Reach>(kMaxObjects);
  Agenda agenda_;
  SpscRing<Order> orders_{2 * kMaxVoices + kMaxObjects};
  SpscRing<Retired> retired_{kMaxVoices};

  std::optional<double> ceiling_db_;
  std::optional<Limiter> limiter_;
  TestTone test_tone_;
  SoundTap sound_tap_;
  ModeWatch mode_watch_;

  // The audio thread's own.
  std::vector<Object> objects_{kMaxObjects};
  std::vector<ObjectNumber> active_ = std::vector<ObjectNumber>(kMaxObjects);
  std::size_t active_count_ = 0;
  std::vector<Family*> active_families_ = std::vector<Family*>(kMaxVoices);
  std::size_t active_family_count_ = 0;
  std::vector<After> after_ = std::vector<After>(kMaxObjects);
  std::size_t slow_modes_ = 0;  // that took moments, or could have, in the last chunk
  std::vector<DueEvent> due_ = std::vector<DueEvent>(kMaxEventsPerChunk);
  std::vector<Place> places_ = std::vector<Place>(1);  // the audio thread's, then its helpers'
  ChannelSet wanted_ = 0;                              // channels that are listened to in this block
  DrivePool drives_;
  Clicks clicks_;
  Inputs inputs_{};  // at the chunk being rendered
  std::array<bool, kMaxInputs> input_sounds_{};
  std::array<std::optional<ObjectNumber>, kMaxInputs> excites_;
  std::size_t numbers_ = 0;  // that objects have had: all lower than this
  std::size_t next_measured_ = 0;
  std::size_t next_watched_ = 0;  // place of mode_watch_
  Frame watch_round_ = 0;         // when its first was written last
  std::vector<float> spare_left_ = std::vector<float>(kMaxSpare), spare_right_ = spare_left_;
  std::size_t frames_ = 0;  // of the chunk being rendered
  bool together_ = false;   // whether this chunk's slow modes are summed as moments
  Frame now_ = 0;
  Hearing hearing_;
  Cut cut_;                                            // what passes since the last survey
  std::size_t since_survey_ = 0;                       // frames
  std::size_t survey_at_ = 0;                          // the next item
  std::size_t sample_ = 0;                             // the item whose visit is timed in this chunk
  std::size_t survey_begin_ = 0, survey_end_ = 0;      // items that are surveyed in this chunk
  std::size_t hidden_modes_ = 0, sounding_modes_ = 0;  // in the last chunk
  Level least_ = Cut::kNothing;                        // quieter modes are shed
  std::size_t since_lowered_ = 0;                      // frames
  Budget budget_;
  bool deadlines_ = true;
  bool tight_ = false;        // in the last chunk time was short, or nearly so
  bool light_ = false;        // in the last chunk there was little to do
  bool put_off_ = false;      // some events of this chunk are
  double event_units_ = 0;    // of work, in this chunk
  double event_reserve_ = 0;  // the same, lately

  // The worker's own.
  std::unique_ptr<Crew> crew_;  // null: the audio thread is alone
  std::vector<Kin> families_;
  std::array<std::uint32_t, kMaxObjects> voices_of_{};
  std::size_t voices_alive_ = 0;
};

}  // namespace ringdown::synth
