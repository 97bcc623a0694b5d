// A game loop in C#: what clients/library/examples/game_engine.c does, in a left-handed world with y up as Unity's.
//
//   mcs Bounce.cs Ringdown.cs && mono Bounce.exe bell.glb bounces.f32
using System;
using System.IO;
using Ringdown;

static class Bounce {
  const int kRate = 48000, kStep = kRate / 60, kSteps = 180;

  static int Main(string[] arguments) {
    if (arguments.Length != 2) {
      Console.Error.WriteLine("usage: Bounce.exe BANK.glb OUT.f32");
      return 2;
    }
    try {
      using (var bank = new Bank(arguments[0]))
      using (var mixer = new Mixer(kRate))
      using (var file = new BinaryWriter(File.Create(arguments[1]))) {
        Play(mixer, mixer.Add("bell", bank), file);
      }
      return 0;
    } catch (RingdownException failure) {
      Console.Error.WriteLine("Bounce: " + failure.Message);
      return 1;
    }
  }

  static void Play(Mixer mixer, uint bell, BinaryWriter file) {
    const double massKg = 0.02, restitution = 0.6, gravity = 9.81;
    double height = 0.2, speed = 0;
    var left = new float[kStep];
    var right = new float[kStep];
    for (int step = 0; step < kSteps; ++step) {
      const double seconds = (double)kStep / kRate;
      speed -= gravity * seconds;
      height += speed * seconds;
      if (height < 0 && speed < 0) {
        // This world's depth is the bank's -z: a push along +z in Unity.
        double impulse = -massKg * speed * (1 + restitution);
        long frame = mixer.Now + kStep - (long)(height / speed * kRate);
        mixer.Strike(bell, Vector.FromUnity(0, 0, 0), Vector.FromUnity(0, 0, impulse), 0.0005, frame);
        height *= -restitution;
        speed *= -restitution;
      }
      mixer.Render(left, right);
      mixer.Collect();
      for (int i = 0; i < kStep; ++i) {
        file.Write(left[i]);
        file.Write(right[i]);
      }
    }
  }
}
