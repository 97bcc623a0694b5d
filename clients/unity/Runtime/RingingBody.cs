// A rigid body that sounds: each collision strikes its object. Its own frame must be that of the mesh that the bank was
// baked from, as Unity imports it: with z negated.
using UnityEngine;

namespace Ringdown {

public sealed class RingingBody : MonoBehaviour {
  public RingdownMixer Mixer;
  public string BankFile = "bell.glb";  // in Assets/StreamingAssets, or an absolute path
  public double ContactTime = 0.0002;   // seconds: 0.0001 is steel on steel, 0.001 a rubber mallet

  uint body_;

  void Start() {
    string path = System.IO.Path.Combine(Application.streamingAssetsPath, BankFile);
    using (var bank = new Bank(path)) body_ = Mixer.Mixer.Add(name + GetInstanceID(), bank);
  }

  void OnDestroy() {
    if (Mixer != null && Mixer.Mixer != null) Mixer.Mixer.Remove(body_);
  }

  void OnCollisionEnter(Collision collision) {
    // Unity has one impulse for all contacts of a collision, and does not say on which of the bodies it acts; a contact's
    // normal points at this one.
    Vector3 impulse = collision.impulse / collision.contactCount;
    for (int i = 0; i < collision.contactCount; ++i) {
      ContactPoint contact = collision.GetContact(i);
      float sign = Vector3.Dot(impulse, contact.normal) < 0 ? -1 : 1;
      Quaternion back = Quaternion.Inverse(transform.rotation);  // not the transform's own inverse, which divides by its scale
      Vector3 point = back * (contact.point - transform.position), push = back * (sign * impulse);
      Mixer.Mixer.Strike(body_, Vector.FromUnity(point.x, point.y, point.z), Vector.FromUnity(push.x, push.y, push.z), ContactTime);
    }
  }
}

}  // namespace Ringdown
