// The daemon: one session, and around it the audio driver, the servers and the threads that serve it.
//
//   auto daemon = Daemon::start(options);               // opens, loads, then plays
//   if (!daemon) return report(daemon.error());
//   while (!(*daemon)->quits()) sleep_a_little();       // it runs on threads of its own
//   const Result<void> finished = (*daemon)->finish();  // silence; writes what is being recorded and captured
//
// A Daemon owns everything below it, and its members are declared in order of their lifetimes: each is made after those
// above it, which it may use, and ends before them. Threads: the driver renders on an audio thread; Service holds the
// worker, the OSC server's threads, the scene's and the session manager's. All public functions are for the main
// thread.
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/socket.h"
#include "server/driver.h"
#include "server/nsm_client.h"
#include "server/options.h"
#include "server/osc_stream.h"
#include "server/query_server.h"
#include "server/session/midi_player.h"
#include "server/session/note_map.h"
#include "server/session/note_tuner.h"
#include "server/session/recorder.h"
#include "server/session/session.h"
#include "server/session/sound_capture.h"
#include "server/session/state.h"
#include "server/worker.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

namespace ringdown::server {

class Daemon {
 public:
  // Binds the ports, joins the session manager if one started us, opens the driver, then loads and plays everything
  // that the options name. The driver is not `wav`. The error's kind is usage for invalid options, port_busy for ports
  // that others hold, no_sound_server if there is none, and bad_input for files.
  static Result<std::unique_ptr<Daemon>> start(DaemonOptions options);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  // Returns whether a client has sent /quit.
  [[nodiscard]] bool quits() const { return quits_; }

  // Return the frames rendered and the rounds of the worker so far: they show systemd that both threads run.
  [[nodiscard]] std::uint64_t frames() const { return session_.rack().mixer().counters().frames; }
  [[nodiscard]] std::uint64_t worker_rounds() const { return worker_rounds_; }

  // Ends all threads, then writes any recording and capture in progress. A recording that cannot be written to its
  // place goes to the folder for temporary files; the error says so. Call once.
  Result<void> finish();

 private:
  struct Ports;    // sockets and the driver, opened before there is a session
  struct Files;    // data read from files before there is a session
  struct Service;  // the daemon's own threads

  static Result<Ports> open_ports(DaemonOptions& options);
  static Result<Files> read_files(const DaemonOptions& options);
  Daemon(DaemonOptions options, Ports ports, Files files);
  void configure();
  void do_chores();  // runs on the worker's thread, after each task and at least every 10 ms
  Result<void> prepare(std::uint16_t osc_port);
  Result<void> load();
  Result<void> load_notes();
  Result<void> connect_inputs();
  Result<void> play(wire::OscSocket socket);
  Result<void> write_results();
  Result<void> write_recording();

  const DaemonOptions options_;
  const session::State state_;          // the state from --state
  std::unique_ptr<NsmClient> manager_;  // null: there is no session manager
  std::atomic<bool> quits_ = false;     // set by the OSC server
  std::atomic<std::uint64_t> worker_rounds_ = 0;
  session::Session session_;
  session::Notes notes_;                       // notes of the session's rack
  std::shared_ptr<session::MidiPlayer> midi_;  // plays the driver's MIDI input; its threads share it
  session::NoteTuner tuner_;                   // tunes the session's rack
  session::Recorder recorder_;                 // observes the session's rack
  session::SoundCapture capture_;              // captures the session's mixer
  std::shared_ptr<OscStream> stream_;          // null: no --tcp
  std::unique_ptr<QueryServer> query_;         // null: no --query; reads the rack's names
  WorkerLine worker_line_;                     // for the driver and the scene, which outlive the worker
  std::unique_ptr<Driver> driver_;             // renders the session's mixer
  std::unique_ptr<Service> service_;
};

}  // namespace ringdown::server
