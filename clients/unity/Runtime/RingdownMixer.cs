// Plays the RingingBody components of a scene. Put it on the object with the AudioListener: it adds to what is heard there.
using UnityEngine;

namespace Ringdown {

public sealed class RingdownMixer : MonoBehaviour {
  readonly object playing_ = new object();  // held by the audio thread while it renders, so that the mixer lives as long

  public Mixer Mixer { get; private set; }

  void Awake() { Mixer = new Mixer(AudioSettings.outputSampleRate); }

  void OnDestroy() {
    lock (playing_) {
      Mixer.Dispose();
      Mixer = null;
    }
  }

  void Update() { Mixer.Collect(); }

  // Unity calls this on its audio thread. Only OnDestroy can make it wait.
  void OnAudioFilterRead(float[] data, int channels) {
    lock (playing_) {
      if (Mixer != null) Mixer.Render(data, channels);
    }
  }
}

}  // namespace Ringdown
