// A scene as text: a bell hangs in the air, and a ball falls on it once a second. Put the script on an empty object of an
// empty scene, and bronze-bell.glb from Ringdown's presets into Assets/StreamingAssets.
using Ringdown;
using UnityEngine;

public sealed class Drop : MonoBehaviour {
  RingingBody bell_;
  float next_;

  void Start() {
    var ear = new GameObject("Ear", typeof(AudioListener), typeof(RingdownMixer));
    var bell = GameObject.CreatePrimitive(PrimitiveType.Cylinder);
    bell.transform.localScale = new Vector3(0.2f, 0.1f, 0.2f);
    bell.AddComponent<Rigidbody>().isKinematic = true;
    bell_ = bell.AddComponent<RingingBody>();
    bell_.Mixer = ear.GetComponent<RingdownMixer>();
    bell_.BankFile = "bronze-bell.glb";
  }

  void Update() {
    if (Time.time < next_) return;
    next_ = Time.time + 1;
    var ball = GameObject.CreatePrimitive(PrimitiveType.Sphere);
    ball.transform.localScale = 0.03f * Vector3.one;
    ball.transform.position = new Vector3(0.02f, 0.6f, 0);
    ball.AddComponent<Rigidbody>().mass = 0.05f;
    Destroy(ball, 3);
  }
}
