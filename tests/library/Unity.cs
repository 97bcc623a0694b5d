// Stands for the parts of Unity that clients/unity uses, and plays a collision: Unity.exe BANK exits with 0 if the package
// sounds like the same blow on a mixer, whose numbers were worked out by hand.
using System;
using System.Reflection;
using Ringdown;
using UnityEngine;

namespace UnityEngine {

public struct Vector3 {
  public float x, y, z;
  public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
  public static Vector3 one { get { return new Vector3(1, 1, 1); } }
  public static float Dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  public static Vector3 operator -(Vector3 a, Vector3 b) { return new Vector3(a.x - b.x, a.y - b.y, a.z - b.z); }
  public static Vector3 operator *(float s, Vector3 a) { return new Vector3(s * a.x, s * a.y, s * a.z); }
  public static Vector3 operator /(Vector3 a, float s) { return new Vector3(a.x / s, a.y / s, a.z / s); }
}

// Only quarter turns about y, which in Unity's left-handed world take z to x and x to -z.
public struct Quaternion {
  public int QuarterTurns;
  public static Quaternion Inverse(Quaternion turn) { return new Quaternion { QuarterTurns = 4 - turn.QuarterTurns }; }
  public static Vector3 operator *(Quaternion turn, Vector3 a) {
    for (int i = 0; i < turn.QuarterTurns; ++i) a = new Vector3(a.z, a.y, -a.x);
    return a;
  }
}

public class Transform {
  public Vector3 position, localScale = Vector3.one;
  public Quaternion rotation;
}
public struct ContactPoint {
  public Vector3 point, normal;
}
public class Collision {
  public Vector3 impulse;
  public ContactPoint[] contacts;
  public int contactCount { get { return contacts.Length; } }
  public ContactPoint GetContact(int i) { return contacts[i]; }
}
public class Component {
  public string name = "bell";
  public Transform transform = new Transform();
  public int GetInstanceID() { return 7; }
}
public class MonoBehaviour : Component {
  public static void Destroy(GameObject dead, float after) {}
}
public class Rigidbody : Component {
  public bool isKinematic;
  public float mass;
}
public class AudioListener : Component {}
public enum PrimitiveType { Cylinder, Sphere }
public class GameObject : Component {
  public GameObject(string name, params Type[] components) {}
  public static GameObject CreatePrimitive(PrimitiveType type) { return new GameObject("" + type); }
  public T AddComponent<T>() where T : new() { return new T(); }
  public T GetComponent<T>() where T : new() { return new T(); }
}
public static class AudioSettings { public static int outputSampleRate = 48000; }
public static class Application { public static string streamingAssetsPath = "/assets"; }
public static class Time { public static float time = 0; }

}  // namespace UnityEngine

static class Program {
  // As Unity calls the methods of scripts: by their names, though they are private.
  static void Call(object script, string method, params object[] arguments) {
    script.GetType().GetMethod(method, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(script, arguments);
  }

  static int Main(string[] arguments) {
    var mixer = new RingdownMixer();
    Call(mixer, "Awake");
    var body = new RingingBody { Mixer = mixer, BankFile = arguments[0], ContactTime = 0.001 };
    Call(body, "Start");
    // The body stands at (1, 2, 3), a quarter turn about y, drawn at another scale. Two contacts share an impulse that Unity
    // gives with the sign of the other body.
    body.transform.position = new Vector3(1, 2, 3);
    body.transform.rotation = new Quaternion { QuarterTurns = 1 };
    body.transform.localScale = new Vector3(5, 5, 5);
    var down = new Vector3(0, -1, 0);
    Call(body, "OnCollisionEnter", new Collision { impulse = new Vector3(0, 0.02f, 0), contacts = new[] {
      new ContactPoint { point = new Vector3(1.0625f, 2.03125f, 3), normal = down },
      new ContactPoint { point = new Vector3(1, 2.03125f, 3.125f), normal = down } } });
    var heard = new float[2 * 4800];
    Call(mixer, "OnAudioFilterRead", heard, 2);

    // In the body's frame the first contact is (0, 0.03125, 0.0625), the second (-0.125, 0.03125, 0); the bank's z is -z.
    var expected = new float[2 * 4800];
    using (var bank = new Bank(arguments[0]))
    using (var other = new Mixer(48000)) {
      uint bell = other.Add("bell", bank);
      other.Strike(bell, new Vector(0, 0.03125, -0.0625), new Vector(0, -0.01f, 0), 0.001);
      other.Strike(bell, new Vector(-0.125, 0.03125, 0), new Vector(0, -0.01f, 0), 0.001);
      other.Render(expected, 2);
    }
    float loudest = 0;
    for (int i = 0; i < heard.Length; ++i) {
      loudest = Math.Max(loudest, Math.Abs(expected[i]));
      if (heard[i] != expected[i]) return Fault("sample " + i + " is " + heard[i] + ", not " + expected[i]);
    }
    if (loudest == 0) return Fault("nothing is heard");
    Call(mixer, "Update");
    Call(body, "OnDestroy");
    Call(mixer, "OnDestroy");
    Call(mixer, "OnAudioFilterRead", heard, 2);
    return 0;
  }

  static int Fault(string sentence) {
    Console.WriteLine(sentence);
    return 1;
  }
}
