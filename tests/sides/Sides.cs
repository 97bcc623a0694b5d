// A table of directions through Ringdown.cs: Sides.exe TABLE BANK OUT writes the samples of eight channels, one after
// the other: left and right, ambisonic channels 0 to 3, and the left and right ear of libmysofa's head. A case whose
// name begins with that of an engine is in this engine's world.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Linq;
using Ringdown;

static class Sides {
  const int kSlot = 12288, kStrike = 4096;  // frames of a case, and when its object is struck

  static void Play(List<string[]> cases, Bank bank, int ambisonicOrder, string head, BinaryWriter file) {
    using (var mixer = new Mixer(48000, null, ambisonicOrder, head)) {
      for (int k = 0; k < cases.Count; ++k) {
        string[] row = cases[k];
        Func<int, double> number = at => double.Parse(row[1 + at], CultureInfo.InvariantCulture);
        Func<double, double, double, Vector> place = (x, y, z) => new Vector(x, y, z);
        Func<double, double, double, double, Turn> turn = (w, x, y, z) => new Turn(w, x, y, z), ears = turn;
        if (row[0].StartsWith("unity")) { place = Vector.FromUnity; turn = Turn.FromUnity; ears = Turn.ListenerFromUnity; }
        if (row[0].StartsWith("unreal")) { place = Vector.FromUnreal; turn = Turn.FromUnreal; ears = Turn.ListenerFromUnreal; }
        if (row[0].StartsWith("godot")) { place = Vector.FromGodot; turn = Turn.FromGodot; ears = Turn.ListenerFromGodot; }
        uint thing = mixer.Add(row[0], bank);
        mixer.Listener(place(number(0), number(1), number(2)), ears(number(3), number(4), number(5), number(6)), k * kSlot);
        mixer.Pose(thing, place(number(7), number(8), number(9)), turn(number(10), number(11), number(12), number(13)), k * kSlot);
        mixer.Strike(thing, new Vector(0.5, 0.5, 0.5), new Vector(0, 0, 0.02), 0, k * kSlot + kStrike);
      }
      int frames = cases.Count * kSlot;
      var channels = new float[2 + (ambisonicOrder > 0 ? 4 : 0)][];
      for (int c = 0; c < channels.Length; ++c) channels[c] = new float[frames];
      mixer.Render(channels[0], channels[1], channels.Skip(2).ToArray());
      foreach (float[] channel in channels) {
        var bytes = new byte[4 * frames];
        Buffer.BlockCopy(channel, 0, bytes, 0, bytes.Length);
        file.Write(bytes);
      }
    }
  }

  static int Main(string[] arguments) {
    var cases = File.ReadLines(arguments[0]).Where(line => line.Trim() != "" && !line.StartsWith("#"))
                    .Select(line => line.Split(new[] { ' ' }, StringSplitOptions.RemoveEmptyEntries)).ToList();
    try {
      using (var bank = new Bank(arguments[1]))
      using (var file = new BinaryWriter(File.Create(arguments[2]))) {
        Play(cases, bank, 1, null, file);
        Play(cases, bank, 0, "", file);
      }
      return 0;
    } catch (RingdownException failure) {
      Console.Error.WriteLine("Sides: " + failure.Message);
      return 1;
    }
  }
}
