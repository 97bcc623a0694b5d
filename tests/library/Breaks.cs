// Breaks a body through Ringdown.cs: Breaks.exe BANK writes the number of pieces, their mass by the bank and by the mixer,
// their momentum along z under a blow of -0.05 N s, and how many points their meshes have.
using System;
using System.Globalization;
using System.Linq;
using Ringdown;

static class Breaks {
  static int Main(string[] arguments) {
    try {
      using (var bank = new Bank(arguments[0]))
      using (var mixer = new Mixer()) {
        Piece[] known = bank.Pieces();
        int points = 0;
        for (uint i = 0; i < known.Length; ++i) {
          float[] mesh;
          int[] triangles;
          bank.PieceMesh(0, i, out mesh, out triangles);
          points += mesh.Length / 3;
        }
        uint pane = mixer.Add("pane", bank);
        if (mixer.Arm(pane) != known.Length) return 2;
        Piece[] pieces = mixer.Break(pane, new Vector(0.03, 0.02, 0.0015), new Vector(0, 0, -0.05), 1e-4, 480);
        mixer.Impart(pieces.First(piece => piece.Object != Piece.kNone).Object, 0, 0.01);
        Console.WriteLine(string.Format(CultureInfo.InvariantCulture, "{0} {1:R} {2:R} {3:R} {4}", pieces.Length,
                                        known.Sum(piece => piece.Mass), pieces.Sum(piece => piece.Mass),
                                        pieces.Sum(piece => piece.Mass * piece.Velocity.Z), points));
        mixer.Mend(pane);
      }
      return 0;
    } catch (RingdownException failure) {
      Console.Error.WriteLine("Breaks: " + failure.Message);
      return 1;
    }
  }
}
