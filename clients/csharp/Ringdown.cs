// libringdown for C#: Unity, Godot's C#, MonoGame, plain .NET. Copy this file and put libringdown beside the program (in
// Unity: Assets/Plugins).
//
//   using var bank = new Ringdown.Bank("bell.glb");
//   using var mixer = new Ringdown.Mixer(AudioSettings.outputSampleRate);
//   uint bell = mixer.Add("bell", bank);                                       // while a level loads
//   mixer.Strike(bell, Vector.FromUnity(p.x, p.y, p.z), Vector.FromUnity(j.x, j.y, j.z));  // in a collision callback
//   void OnAudioFilterRead(float[] data, int channels) { mixer.Render(data, channels); }   // Unity's audio callback
//
// Units are SI: metres, newton seconds, in the object's own frame. ringdown.h is the manual: which thread may call what,
// and what each number may be. Errors are exceptions with the library's sentence. Unity's world is left-handed and
// Unreal's in centimetres, too: Vector.FromUnity and the like convert. Events, and rendering left and right, allocate nothing.
using System;
using System.Runtime.InteropServices;

namespace Ringdown {

public sealed class RingdownException : Exception {
  public RingdownException(string sentence) : base(sentence) {}
}

// A point [m], an impulse [N s] or a direction in a right-handed frame.
[StructLayout(LayoutKind.Sequential)]
public struct Vector {
  public double X, Y, Z;
  public Vector(double x, double y, double z) { X = x; Y = y; Z = z; }

  // Unity: left-handed, y up, metres.
  public static Vector FromUnity(double x, double y, double z) { return new Vector(x, y, -z); }
  // Unreal: left-handed, z up, centimetres; impulses are kg cm/s.
  public static Vector FromUnreal(double x, double y, double z) { return new Vector(x / 100, -y / 100, z / 100); }
  // Godot and glTF: right-handed, y up, metres.
  public static Vector FromGodot(double x, double y, double z) { return new Vector(x, y, z); }
}

// A turn, as a unit quaternion, real part first: (1, 0, 0, 0) is not turned.
[StructLayout(LayoutKind.Sequential)]
public struct Turn {
  public double W, X, Y, Z;
  public Turn(double w, double x, double y, double z) { W = w; X = x; Y = y; Z = z; }

  public static Turn FromUnity(double x, double y, double z, double w) { return new Turn(w, -x, -y, z); }
  public static Turn FromUnreal(double x, double y, double z, double w) { return new Turn(w, -x, y, -z); }
  public static Turn FromGodot(double x, double y, double z, double w) { return new Turn(w, x, y, z); }

  // Of the listener, by the turn of the engine's camera: Mixer.Listener() wants x to the front, y to the left and z up,
  // while cameras look along z in Unity, along x in Unreal, and along -z in Godot.
  public static Turn ListenerFromUnity(double x, double y, double z, double w) { return FromUnity(x, y, z, w) * kAlongMinusZ; }
  public static Turn ListenerFromUnreal(double x, double y, double z, double w) { return FromUnreal(x, y, z, w); }
  public static Turn ListenerFromGodot(double x, double y, double z, double w) { return FromGodot(x, y, z, w) * kAlongMinusZ; }
  static readonly Turn kAlongMinusZ = new Turn(0.5, -0.5, 0.5, 0.5);  // x to -z, y to -x, z to y

  // First b, then a.
  public static Turn operator *(Turn a, Turn b) {
    return new Turn(a.W * b.W - a.X * b.X - a.Y * b.Y - a.Z * b.Z, a.W * b.X + a.X * b.W + a.Y * b.Z - a.Z * b.Y,
                    a.W * b.Y - a.X * b.Z + a.Y * b.W + a.Z * b.X, a.W * b.Z + a.X * b.Y - a.Y * b.X + a.Z * b.W);
  }
}

// A piece of a body that can break, in the body's frame. Object is Piece.kNone where it never rings, and of a bank's.
// Velocity and spin are beyond the motion that the body had before the blow. Axes turns the principal axes into the frame.
[StructLayout(LayoutKind.Sequential)]
public struct Piece {
  public const uint kNone = 0xffffffff;
  UIntPtr size_;
  public uint Object;
  internal uint Count;
  public double Mass;
  public Vector Center, Inertia;
  public Turn Axes;
  public Vector Velocity, Spin;
  UIntPtr modes_;
  internal UIntPtr Points, Triangles;
  internal IntPtr PointsAt, TrianglesAt;

  internal static Piece Empty() { return new Piece { size_ = (UIntPtr)Marshal.SizeOf(typeof(Piece)) }; }
}

// Room for one struct ringdown_error.
sealed class Failure : IDisposable {
  const int kBytes = 512;
  public readonly IntPtr Room = Marshal.AllocHGlobal(kBytes);

  public void Check(int result) {
    if (result == 0) return;
    throw new RingdownException(Text(IntPtr.Add(Room, sizeof(int))));
  }
  public void Dispose() { Marshal.FreeHGlobal(Room); }

  internal static string Text(IntPtr utf8) {
    int length = 0;
    while (Marshal.ReadByte(utf8, length) != 0) ++length;
    var bytes = new byte[length];
    Marshal.Copy(utf8, bytes, 0, length);
    return System.Text.Encoding.UTF8.GetString(bytes);
  }
  // A string as C takes it.
  internal static byte[] Utf8(string text) { return text == null ? null : System.Text.Encoding.UTF8.GetBytes(text + "\0"); }
}

// The modes of a body, from a file or from memory.
public sealed class Bank : IDisposable {
  internal IntPtr Handle;

  public Bank(string path) {
    using (var failure = new Failure()) {
      failure.Check(Native.ringdown_bank_open(Failure.Utf8(path), out Handle, failure.Room));
    }
  }
  public Bank(byte[] glb, string name) {
    using (var failure = new Failure()) {
      failure.Check(Native.ringdown_bank_parse(glb, (UIntPtr)glb.Length, Failure.Utf8(name), out Handle, failure.Room));
    }
  }
  ~Bank() { Dispose(); }
  public void Dispose() {
    Native.ringdown_bank_release(Handle);
    Handle = IntPtr.Zero;
    GC.SuppressFinalize(this);
  }

  // In order of decreasing importance to the ear.
  public double[] FrequenciesHz() { return Numbers(Native.ringdown_bank_frequencies_hz(Handle)); }
  // Of the amplitude; T60 is 6.91 over it.
  public double[] DecaysPerSecond() { return Numbers(Native.ringdown_bank_decays_per_s(Handle)); }

  // The pieces of a pattern, by which the body can break (ringdown bake with [shatter]); for a level that loads.
  public Piece[] Pieces(uint pattern = 0) {
    Piece[] pieces = { PieceOf(pattern, 0) };
    Array.Resize(ref pieces, (int)pieces[0].Count);
    for (int i = 1; i < pieces.Length; ++i) pieces[i] = PieceOf(pattern, (uint)i);
    return pieces;
  }
  // The surface of a piece: three coordinates for each point, and three points for each triangle.
  public void PieceMesh(uint pattern, uint piece, out float[] points, out int[] triangles) {
    Piece known = PieceOf(pattern, piece);
    points = new float[3 * (int)known.Points];
    triangles = new int[3 * (int)known.Triangles];
    Marshal.Copy(known.PointsAt, points, 0, points.Length);
    Marshal.Copy(known.TrianglesAt, triangles, 0, triangles.Length);
  }

  Piece PieceOf(uint pattern, uint piece) {
    Piece known = Piece.Empty();
    using (var failure = new Failure()) {
      failure.Check(Native.ringdown_breakable_piece(Handle, pattern, piece, ref known, failure.Room));
    }
    return known;
  }
  double[] Numbers(IntPtr from) {
    var info = new Native.BankInfo { Size = (UIntPtr)Marshal.SizeOf(typeof(Native.BankInfo)) };
    Native.ringdown_bank_describe(Handle, ref info);
    var numbers = new double[(int)info.Modes];
    Marshal.Copy(from, numbers, 0, numbers.Length);
    return numbers;
  }
}

// What rings.
public sealed class Mixer : IDisposable {
  IntPtr handle_;
  readonly Failure failure_ = new Failure(), eventFailure_ = new Failure();  // of the worker, of control
  float[] left_ = new float[8192], right_ = new float[8192];
  Native.Block block_ = Native.Block.Empty();

  // limiterDb: the ceiling of left and right, -60 to 0, or null. ambisonicOrder: 1 to 3, for Render(left, right,
  // ambisonics). head: a SOFA file for binaural sound, or "" for the head that libmysofa brings.
  public Mixer(double sampleRateHz = 48000, double? limiterDb = -1, int ambisonicOrder = 0, string head = null) {
    const double noLimiter = 1;
    var settings = new Native.Settings();
    Native.ringdown_settings_init(ref settings, (UIntPtr)Marshal.SizeOf(typeof(Native.Settings)));
    settings.SampleRateHz = sampleRateHz;
    settings.Limiter = limiterDb ?? noLimiter;
    settings.AmbisonicOrder = ambisonicOrder;
    byte[] file = Failure.Utf8(head);
    GCHandle pinned = GCHandle.Alloc(file, GCHandleType.Pinned);
    try {
      if (file != null) settings.Head = pinned.AddrOfPinnedObject();
      failure_.Check(Native.ringdown_mixer_create(ref settings, out handle_, failure_.Room));
    } finally {
      pinned.Free();
    }
  }
  ~Mixer() { Dispose(); }
  public void Dispose() {
    if (handle_ == IntPtr.Zero) return;
    Native.ringdown_mixer_destroy(handle_);
    handle_ = IntPtr.Zero;
    failure_.Dispose();
    eventFailure_.Dispose();
    GC.SuppressFinalize(this);
  }

  // Frames rendered so far: an event at Now + k happens at offset k of the next block; one at 0 as soon as possible.
  public long Now { get { return Native.ringdown_now(handle_); } }
  public int Latency { get { return (int)Native.ringdown_latency(handle_); } }

  // [worker]
  public uint Add(string name, Bank bank) {
    uint number;
    failure_.Check(Native.ringdown_add(handle_, Failure.Utf8(name), bank.Handle, out number, failure_.Room));
    return number;
  }
  public void Remove(uint body) { failure_.Check(Native.ringdown_remove(handle_, body, failure_.Room)); }
  public void Hold(uint body, uint hand, Vector point, double damping, long frame = 0) {
    var anyway = new Vector();
    failure_.Check(Native.ringdown_hold(handle_, frame, body, hand, ref point, ref anyway, damping, failure_.Room));
  }
  // Loads the pieces that the body breaks into, of a pattern of its bank or of the finest one, and returns their number.
  public int Arm(uint body, int pattern = -1) {
    uint pieces;
    failure_.Check(Native.ringdown_arm(handle_, body, pattern, out pieces, failure_.Room));
    return (int)pieces;
  }
  public void Mend(uint body) { failure_.Check(Native.ringdown_mend(handle_, body, failure_.Room)); }
  public void Collect() { Native.ringdown_collect(handle_); }

  // [control]
  // Breaks an armed body at the peak of a blow. Its pieces go on with its motion, and with the first half of the blow.
  public Piece[] Break(uint body, Vector point, Vector impulse, double contactTime = 0.0002, long frame = 0) {
    uint count;
    eventFailure_.Check(Native.ringdown_break(handle_, frame, body, ref point, ref impulse, contactTime, out count,
                                              eventFailure_.Room));
    var pieces = new Piece[count];
    for (int i = 0; i < pieces.Length; ++i) {
      pieces[i] = Piece.Empty();
      eventFailure_.Check(Native.ringdown_piece(handle_, body, (uint)i, ref pieces[i], eventFailure_.Room));
    }
    return pieces;
  }
  // The largest tensile stress that a blow would cause in an armed body; 0 if its bank does not know.
  public double Stress(uint body, Vector point, Vector impulse, double contactTime = 0.0002, long frame = 0) {
    double stress;
    eventFailure_.Check(Native.ringdown_stress(handle_, frame, body, ref point, ref impulse, contactTime, out stress,
                                               eventFailure_.Room));
    return stress;
  }
  // <verbs> What follows is written by ringdown_write_verbs.
  // Strikes the object at the surface point nearest to x y z.
  public void Strike(uint body, Vector point, Vector impulse, double contactTime = 0.0002, long frame = 0) {
    eventFailure_.Check(Native.ringdown_strike(handle_, frame, body, ref point, ref impulse, contactTime,
                                               eventFailure_.Room));
  }
  // Strikes the object at a sample point of its bank.
  public void StrikeVertex(uint body, uint vertex, Vector impulse, double contactTime = 0.0002, long frame = 0) {
    eventFailure_.Check(Native.ringdown_strike_vertex(handle_, frame, body, vertex, ref impulse, contactTime,
                                                      eventFailure_.Room));
  }
  // Sets the object's loudness.
  public void Gain(uint body, double gain, double ramp = 0, long frame = 0) {
    eventFailure_.Check(Native.ringdown_gain(handle_, frame, body, gain, ramp, eventFailure_.Room));
  }
  // Pans the object at equal power.
  public void Pan(uint body, double pan, long frame = 0) {
    eventFailure_.Check(Native.ringdown_pan(handle_, frame, body, pan, eventFailure_.Room));
  }
  // Turns a fan in the mouth of the object's tube: a vibraphone's tremolo. Objects without a tube sound as before.
  public void Fan(uint body, double rate, double depth, long frame = 0) {
    eventFailure_.Check(Native.ringdown_fan(handle_, frame, body, rate, depth, eventFailure_.Room));
  }
  // Sends the motion of a point of the object to an output of its own, as a contact microphone or a laser vibrometer
  // measures it: port pickup_1 to pickup_8. Gain, pan, mute and listener do not change it. A pickup of this number on
  // another object moves here; a direction of 0 0 0 removes it.
  public void Pickup(uint body, Vector point, Vector direction, uint bus = 1, uint motion = 1, double gain = 1,
                     long frame = 0) {
    var args = new Native.PickupArgs();
    Native.ringdown_pickup_args_init(ref args, (UIntPtr)Marshal.SizeOf(typeof(Native.PickupArgs)));
    args.Point = point;
    args.Direction = direction;
    args.Bus = bus;
    args.Motion = motion;
    args.Gain = gain;
    eventFailure_.Check(Native.ringdown_pickup(handle_, frame, body, ref args, eventFailure_.Room));
  }
  // Starts modes without a strike, each as a sine from 0.
  public void Ring(uint body, uint first, uint count = 1, double amplitude = 0.1, long frame = 0) {
    eventFailure_.Check(Native.ringdown_ring(handle_, frame, body, first, count, amplitude, eventFailure_.Room));
  }
  // Starts one mode with a known motion, such as one of your own computation, or of a body that breaks.
  public void Impart(uint body, uint mode, double velocity, double phase = 0, long frame = 0) {
    eventFailure_.Check(Native.ringdown_impart(handle_, frame, body, mode, velocity, phase, eventFailure_.Room));
  }
  // Fades everything that rings in the object, and ends its contacts.
  public void Clear(uint body, double ramp = 0, long frame = 0) {
    eventFailure_.Check(Native.ringdown_clear(handle_, frame, body, ramp, eventFailure_.Room));
  }
  // Damps everything that rings in the object, like a hand on a cymbal. Bows and other contacts continue, and later
  // strikes ring.
  public void Choke(uint body, double within = 0.2, long frame = 0) {
    eventFailure_.Check(Native.ringdown_choke(handle_, frame, body, within, eventFailure_.Room));
  }
  // Slaps the mouth of the object, such as a bottle's, so that the air in it rings. The bank must have this air (bake
  // it with [cavity]).
  public void Slap(uint body, double impulse, double contactTime = 0.001, long frame = 0) {
    eventFailure_.Check(Native.ringdown_slap(handle_, frame, body, impulse, contactTime, eventFailure_.Room));
  }
  // Blows over the mouth of the object, so that the air in it sounds, until a pressure of 0 or /clear ends it. The
  // breath is noise that does not feel how the air moves: it colours, and does not lock into a tone. The bank must
  // have this air (bake it with [cavity]).
  public void Blow(uint body, double pressure, long frame = 0) {
    eventFailure_.Check(Native.ringdown_blow(handle_, frame, body, pressure, eventFailure_.Room));
  }
  // Lets something slide or roll on the object. Values are interpolated between messages: send 50 to 250 a second. A
  // force of 0 0 0, or 0.1 s without a message, ends the contact.
  public void Contact(uint body, Vector point, Vector force, double slip, double roll = 0, uint number = 0,
                      double roughness = 2e-6, double correlation = 5e-5, double slope = -2.4, long frame = 0) {
    var args = new Native.ContactArgs();
    Native.ringdown_contact_args_init(ref args, (UIntPtr)Marshal.SizeOf(typeof(Native.ContactArgs)));
    args.Point = point;
    args.Force = force;
    args.Slip = slip;
    args.Roll = roll;
    args.Number = number;
    args.Roughness = roughness;
    args.Correlation = correlation;
    args.Slope = slope;
    eventFailure_.Check(Native.ringdown_contact(handle_, frame, body, ref args, eventFailure_.Room));
  }
  // Bows the object: the hair sticks and slips, and reacts to the surface's motion. Send the message again to change
  // speed or force, which glide to their new values within the time since the last message, 2 to 50 ms. A force of 0
  // lifts the bow.
  public void Bow(uint body, Vector point, Vector direction, double speed, double force, double width = 0,
                  double rosin = 0.8, uint number = 0, long frame = 0) {
    var args = new Native.BowArgs();
    Native.ringdown_bow_args_init(ref args, (UIntPtr)Marshal.SizeOf(typeof(Native.BowArgs)));
    args.Point = point;
    args.Direction = direction;
    args.Speed = speed;
    args.Force = force;
    args.Width = width;
    args.Rosin = rosin;
    args.Number = number;
    eventFailure_.Check(Native.ringdown_bow(handle_, frame, body, ref args, eventFailure_.Room));
  }
  // Throws a mallet at the object. Mass, head, speed and the object's own motion decide how long the blow lasts and
  // how often the mallet hits.
  public void Mallet(uint body, Vector point, Vector velocity, double mass = 0.02, double head = 10000000,
                     double bounce = 0.9, long frame = 0) {
    var args = new Native.MalletArgs();
    Native.ringdown_mallet_args_init(ref args, (UIntPtr)Marshal.SizeOf(typeof(Native.MalletArgs)));
    args.Point = point;
    args.Velocity = velocity;
    args.Mass = mass;
    args.Head = head;
    args.Bounce = bounce;
    eventFailure_.Check(Native.ringdown_mallet(handle_, frame, body, ref args, eventFailure_.Room));
  }
  // Lets another object touch this one at a point of each, so that both rattle, buzz and ring together. The frames of
  // the two are assumed to be parallel. A stiffness of 0 separates them.
  public void Couple(uint body, Vector point, uint other, Vector otherPoint, Vector direction, double weight = 0,
                     double gap = 0, double stiffness = 100000000, double friction = 0.3, double bounce = 0.6,
                     double mass = 0, uint number = 0, long frame = 0) {
    var args = new Native.CoupleArgs();
    Native.ringdown_couple_args_init(ref args, (UIntPtr)Marshal.SizeOf(typeof(Native.CoupleArgs)));
    args.Point = point;
    args.Other = other;
    args.OtherPoint = otherPoint;
    args.Direction = direction;
    args.Weight = weight;
    args.Gap = gap;
    args.Stiffness = stiffness;
    args.Friction = friction;
    args.Bounce = bounce;
    args.Mass = mass;
    args.Number = number;
    eventFailure_.Check(Native.ringdown_couple(handle_, frame, body, ref args, eventFailure_.Room));
  }
  // Plays the click of a free object that a blow sets in motion as a whole. Strikes do not include it. Send one click
  // for all points that are struck at the same time.
  public void Click(uint body, Vector impulse, double contactTime = 0.0002, long frame = 0) {
    eventFailure_.Check(Native.ringdown_click(handle_, frame, body, ref impulse, contactTime, eventFailure_.Room));
  }
  // Sets the object's pose, from which a listener (/listener) hears it. Send 30 to 250 poses a second for a moving
  // object; the motion between poses is smooth. A pose sent one interval ahead of its time is reached exactly then,
  // any other pose one interval after it arrives.
  public void Pose(uint body, Vector position, Turn turn, long frame = 0) {
    eventFailure_.Check(Native.ringdown_pose(handle_, frame, body, ref position, ref turn, eventFailure_.Room));
  }
  // Sets the listener's pose. Objects with a pose are then heard from their places, with direction, distance and
  // Doppler shift. Objects without a pose sound as before.
  public void Listener(Vector position, Turn turn, long frame = 0) {
    eventFailure_.Check(Native.ringdown_listener(handle_, frame, ref position, ref turn, eventFailure_.Room));
  }
  // Removes the listener.
  public void ListenerOff(long frame = 0) {
    eventFailure_.Check(Native.ringdown_listener_off(handle_, frame, eventFailure_.Room));
  }
  // Sets the air between objects and listener, which absorbs high frequencies more strongly over longer distances.
  public void ListenerAir(double temperature, double humidity = 50, long frame = 0) {
    eventFailure_.Check(Native.ringdown_listener_air(handle_, frame, temperature, humidity, eventFailure_.Room));
  }
  // </verbs>

  // [audio] Left and right, which are as long as the block.
  public void Render(float[] left, float[] right) {
    if (left.Length != right.Length) throw new ArgumentException("left and right must be of one length");
    Native.ringdown_render(handle_, left, right, (UIntPtr)left.Length);
  }
  // [audio] Left and right, the first ambisonic channels (AmbiX, ACN order, SN3D), and the first pickups. All are as long
  // as the block.
  public void Render(float[] left, float[] right, float[][] ambisonics, params float[][] pickups) {
    if (ambisonics.Length > Native.kAmbisonicChannels) throw new ArgumentException("there are at most 16 ambisonic channels");
    if (pickups.Length > Native.kPickups) throw new ArgumentException("there are at most 8 pickups");
    var pinned = new GCHandle[2 + ambisonics.Length + pickups.Length];
    int used = 0;
    Action<float[][], IntPtr[]> pin = (channels, pointers) => {
      for (int c = 0; c < pointers.Length; ++c) {
        pointers[c] = IntPtr.Zero;
        if (c >= channels.Length) continue;
        if (channels[c].Length != left.Length) throw new ArgumentException("all channels must be of one length");
        pinned[used] = GCHandle.Alloc(channels[c], GCHandleType.Pinned);
        pointers[c] = pinned[used++].AddrOfPinnedObject();
      }
    };
    try {
      pin(new[] { left, right }, block_.Mix);
      pin(ambisonics, block_.Ambisonics);
      pin(pickups, block_.Pickups);
      block_.Frames = (UIntPtr)left.Length;
      Native.ringdown_render_all(handle_, ref block_);
    } finally {
      foreach (GCHandle channel in pinned) if (channel.IsAllocated) channel.Free();
    }
  }
  // [audio] Adds to interleaved samples, as Unity's OnAudioFilterRead has them; one channel gets the sum of both.
  public void Render(float[] data, int channels) {
    int frames = data.Length / channels;
    for (int begin = 0; begin < frames; begin += left_.Length) {
      int count = Math.Min(left_.Length, frames - begin);
      Native.ringdown_render(handle_, left_, right_, (UIntPtr)count);
      for (int i = 0; i < count; ++i) {
        int at = (begin + i) * channels;
        data[at] += left_[i];
        data[channels > 1 ? at + 1 : at] += right_[i];
      }
    }
  }
}

static class Native {
  const string kLibrary = "ringdown";

  [StructLayout(LayoutKind.Sequential)]
  internal struct BankInfo {
    public UIntPtr Size, Modes, Points, Triangles;
    public IntPtr Name, Material;
    public double YoungsModulus, PoissonRatio, Density, Mass, CenterX, CenterY, CenterZ;
    public int HasRadiation;
  }
  [StructLayout(LayoutKind.Sequential)]
  internal struct Settings {
    public UIntPtr Size;
    public double SampleRateHz, FullScale, Limiter, Floor;
    public int ExactContacts, AmbisonicOrder, Threads;
    public IntPtr Head;
  }
  internal const int kAmbisonicChannels = 16, kPickups = 8;
  [StructLayout(LayoutKind.Sequential)]
  internal struct Block {
    public UIntPtr Size, Frames;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 2)] public IntPtr[] Mix;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = kAmbisonicChannels)] public IntPtr[] Ambisonics;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public IntPtr[] Inputs;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = kPickups)] public IntPtr[] Pickups;

    internal static Block Empty() {
      return new Block { Size = (UIntPtr)Marshal.SizeOf(typeof(Block)), Mix = new IntPtr[2],
                         Ambisonics = new IntPtr[kAmbisonicChannels], Inputs = new IntPtr[4],
                         Pickups = new IntPtr[kPickups] };
    }
  }
  [DllImport(kLibrary)] internal static extern int ringdown_bank_open(byte[] path, out IntPtr bank, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_bank_parse(byte[] glb, UIntPtr bytes, byte[] name, out IntPtr bank, IntPtr error);
  [DllImport(kLibrary)] internal static extern void ringdown_bank_release(IntPtr bank);
  [DllImport(kLibrary)] internal static extern int ringdown_bank_describe(IntPtr bank, ref BankInfo info);
  [DllImport(kLibrary)] internal static extern IntPtr ringdown_bank_frequencies_hz(IntPtr bank);
  [DllImport(kLibrary)] internal static extern IntPtr ringdown_bank_decays_per_s(IntPtr bank);
  [DllImport(kLibrary)] internal static extern void ringdown_settings_init(ref Settings settings, UIntPtr size);
  [DllImport(kLibrary)] internal static extern int ringdown_mixer_create(ref Settings settings, out IntPtr mixer, IntPtr error);
  [DllImport(kLibrary)] internal static extern void ringdown_mixer_destroy(IntPtr mixer);
  [DllImport(kLibrary)] internal static extern int ringdown_add(IntPtr mixer, byte[] name, IntPtr bank, out uint body, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_remove(IntPtr mixer, uint body, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_hold(IntPtr mixer, long frame, uint body, uint hand, ref Vector point, ref Vector direction, double damping, IntPtr error);
  [DllImport(kLibrary)] internal static extern void ringdown_collect(IntPtr mixer);
  [DllImport(kLibrary)] internal static extern int ringdown_breakable_piece(IntPtr bank, uint pattern, uint piece, ref Piece info, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_arm(IntPtr mixer, uint body, int pattern, out uint pieces, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_break(IntPtr mixer, long frame, uint body, ref Vector point, ref Vector impulse, double contactTime, out uint pieces, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_piece(IntPtr mixer, uint body, uint piece, ref Piece info, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_stress(IntPtr mixer, long frame, uint body, ref Vector point, ref Vector impulse, double contactTime, out double stress, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_mend(IntPtr mixer, uint body, IntPtr error);
  // <verbs of the library> What follows is written by ringdown_write_verbs.
  [DllImport(kLibrary)] internal static extern int ringdown_strike(IntPtr mixer, long frame, uint body,
                                                                   ref Vector point, ref Vector impulse,
                                                                   double contactTime, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_strike_vertex(IntPtr mixer, long frame, uint body,
                                                                          uint vertex, ref Vector impulse,
                                                                          double contactTime, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_gain(IntPtr mixer, long frame, uint body, double gain,
                                                                 double ramp, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_pan(IntPtr mixer, long frame, uint body, double pan,
                                                                IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_fan(IntPtr mixer, long frame, uint body, double rate,
                                                                double depth, IntPtr error);
  [StructLayout(LayoutKind.Sequential)]
  internal struct PickupArgs {
    public UIntPtr Size;
    public Vector Point;
    public Vector Direction;
    public uint Bus;
    public uint Motion;
    public double Gain;
  }
  [DllImport(kLibrary)] internal static extern void ringdown_pickup_args_init(ref PickupArgs args, UIntPtr size);
  [DllImport(kLibrary)] internal static extern int ringdown_pickup(IntPtr mixer, long frame, uint body,
                                                                   ref PickupArgs args, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_ring(IntPtr mixer, long frame, uint body, uint first,
                                                                 uint count, double amplitude, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_impart(IntPtr mixer, long frame, uint body, uint mode,
                                                                   double velocity, double phase, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_clear(IntPtr mixer, long frame, uint body, double ramp,
                                                                  IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_choke(IntPtr mixer, long frame, uint body,
                                                                  double within, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_slap(IntPtr mixer, long frame, uint body,
                                                                 double impulse, double contactTime, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_blow(IntPtr mixer, long frame, uint body,
                                                                 double pressure, IntPtr error);
  [StructLayout(LayoutKind.Sequential)]
  internal struct ContactArgs {
    public UIntPtr Size;
    public Vector Point;
    public Vector Force;
    public double Slip;
    public double Roll;
    public uint Number;
    public double Roughness;
    public double Correlation;
    public double Slope;
  }
  [DllImport(kLibrary)] internal static extern void ringdown_contact_args_init(ref ContactArgs args, UIntPtr size);
  [DllImport(kLibrary)] internal static extern int ringdown_contact(IntPtr mixer, long frame, uint body,
                                                                    ref ContactArgs args, IntPtr error);
  [StructLayout(LayoutKind.Sequential)]
  internal struct BowArgs {
    public UIntPtr Size;
    public Vector Point;
    public Vector Direction;
    public double Speed;
    public double Force;
    public double Width;
    public double Rosin;
    public uint Number;
  }
  [DllImport(kLibrary)] internal static extern void ringdown_bow_args_init(ref BowArgs args, UIntPtr size);
  [DllImport(kLibrary)] internal static extern int ringdown_bow(IntPtr mixer, long frame, uint body,
                                                                ref BowArgs args, IntPtr error);
  [StructLayout(LayoutKind.Sequential)]
  internal struct MalletArgs {
    public UIntPtr Size;
    public Vector Point;
    public Vector Velocity;
    public double Mass;
    public double Head;
    public double Bounce;
  }
  [DllImport(kLibrary)] internal static extern void ringdown_mallet_args_init(ref MalletArgs args, UIntPtr size);
  [DllImport(kLibrary)] internal static extern int ringdown_mallet(IntPtr mixer, long frame, uint body,
                                                                   ref MalletArgs args, IntPtr error);
  [StructLayout(LayoutKind.Sequential)]
  internal struct CoupleArgs {
    public UIntPtr Size;
    public Vector Point;
    public uint Other;
    public Vector OtherPoint;
    public Vector Direction;
    public double Weight;
    public double Gap;
    public double Stiffness;
    public double Friction;
    public double Bounce;
    public double Mass;
    public uint Number;
  }
  [DllImport(kLibrary)] internal static extern void ringdown_couple_args_init(ref CoupleArgs args, UIntPtr size);
  [DllImport(kLibrary)] internal static extern int ringdown_couple(IntPtr mixer, long frame, uint body,
                                                                   ref CoupleArgs args, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_click(IntPtr mixer, long frame, uint body,
                                                                  ref Vector impulse, double contactTime,
                                                                  IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_pose(IntPtr mixer, long frame, uint body,
                                                                 ref Vector position, ref Turn turn, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_listener(IntPtr mixer, long frame, ref Vector position,
                                                                     ref Turn turn, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_listener_off(IntPtr mixer, long frame, IntPtr error);
  [DllImport(kLibrary)] internal static extern int ringdown_listener_air(IntPtr mixer, long frame,
                                                                         double temperature, double humidity,
                                                                         IntPtr error);
  // </verbs of the library>
  [DllImport(kLibrary)] internal static extern void ringdown_render(IntPtr mixer, [Out] float[] left, [Out] float[] right, UIntPtr frames);
  [DllImport(kLibrary)] internal static extern void ringdown_render_all(IntPtr mixer, ref Block block);
  [DllImport(kLibrary)] internal static extern long ringdown_now(IntPtr mixer);
  [DllImport(kLibrary)] internal static extern UIntPtr ringdown_latency(IntPtr mixer);
}

}  // namespace Ringdown
