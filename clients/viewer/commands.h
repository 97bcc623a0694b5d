// Turns the user's actions into requests to the daemon. Knows nothing of windows: it reads the model, sends requests,
// and keeps the user's choice. [UI]
#pragma once

#include "clients/viewer/edits.h"
#include "clients/viewer/keys.h"
#include "clients/viewer/link/model.h"
#include "clients/viewer/scene_loader.h"
#include "protocol/request.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::viewer {

// The target of actions, as the user has chosen it.
struct Choice {
  std::string object;      // empty: there is no object
  std::uint32_t node = 0;  // the sample point that test forces strike
  std::uint32_t mode = 0;  // rank by ascending frequency
  bool vibrate = false;    // whether the object is shown vibrating in that mode
  bool tone = false;       // whether the test tone sounds
  double impulse_ns = 0.05;
  double contact_time_s = 0.0005;
  Vec3 drop_m{0, 0, 1};  // where new bodies start
};

// Returns the present time for use in a file name: "20110516-142501".
std::string time_of_day();

class Commands {
 public:
  using Send = Edits::Send;
  Commands(Model& model, Send send)
      : model_(model), send_(std::move(send)), edits_(model, send_), loader_(model, send_) {}

  // Call at every frame. Chooses the object with the most modes until the user chooses an existing one.
  void update(double now_s);

  // Call when another daemon answers: its objects have no history.
  void restart();

  // Performs actions on sound, objects and bodies. Returns false for actions of the window and the camera.
  bool perform(Action action);

  [[nodiscard]] Choice& choice() { return choice_; }
  [[nodiscard]] const Choice& choice() const { return choice_; }
  [[nodiscard]] const Edits& edits() const { return edits_; }
  [[nodiscard]] Edits& edits() { return edits_; }
  void choose_object(const std::string& name);

  // Strikes the object at a point in its frame, against the outward `normal` of the surface there.
  void strike(const std::string& object, Vec3 point_m, Vec3 normal, double impulse_ns);
  // Throws a mallet or pushes a body, which cannot be undone.
  void act_once(const protocol::Request& blow) { send_(blow); }
  // Selects only the mode of this rank and rings it; if only this mode is selected already, selects all modes again.
  void hear_alone(const KnownObject& object, std::uint32_t rank);

  // Loads a scene, which begins when its geometry has arrived. Undo forgets the old scene's bodies.
  void load_scene(const std::string& path);
  void load_bank(const std::string& path);
  void toggle_recording();

  // Muting and soloing cannot be undone, because other clients may do it too.
  void set_mute(const KnownObject& object, bool on);
  void set_solo(const KnownObject& object, bool on);

  // Records the sound into a file that does not exist yet; nullopt ends the recording.
  void capture_to(const std::optional<std::string>& path) {
    path ? send_(protocol::CaptureStart{*path}) : send_(protocol::CaptureStop{});
  }
  void save_scene(const std::string& path, bool replace) { send_(protocol::SaveScene{path, replace}); }

 private:
  [[nodiscard]] const KnownObject* chosen() const { return model_.object(choice_.object); }
  bool perform_choice(Action action);
  bool perform_material(Action action);
  bool perform_modes(Action action);
  bool perform_scene(Action action);
  void step_object(int by);
  void step_node(int by);
  void step_mode(int by);
  void scale_material(double modal::MaterialScale::*factor, double by);
  void step_mode_count(int by);
  void play_modes(modal::ModeRange range);
  void project_test_force();

  Model& model_;
  Send send_;
  Choice choice_;
  Edits edits_;
  SceneLoader loader_;
  bool chosen_by_hand_ = false;
};

}  // namespace ringdown::viewer
