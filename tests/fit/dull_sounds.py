#!/usr/bin/env python3
"""Dull, short, noisy, reverberant and clipped blows through `ringdown fit`, and how far from them its banks sound.

usage: dull_sounds.py FIT FOLDER [--table] [--without-burst]

FIT is ringdown-fit, FOLDER gets the sounds and banks. The sounds are made here, as what they are named after sounds: modes that
die within 5 to 500 ms, the click of the contact, noise, a room. The bank is played by the formula of docs/how/fit.md, by numpy
alone, and compared in cells of a third of an octave by 10 ms that lie 6 dB above the recording's noise, after one shift of the
level. Each limit is today's figure and a little more. Exit code 1 when a limit is missed, 77 without numpy.
"""
import math
import pathlib
import re
import subprocess
import sys
import wave

try:
    import numpy as np
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import bank_document  # noqa: E402

RATE = 48000
ONSET = 0.2


def ring(modes, seconds):
    """Modes as (Hz, T60 [s], amplitude), from the onset on."""
    t = np.arange(int(seconds * RATE)) / RATE
    return sum(a * np.exp(-6.91 * t / t60) * np.sin(2 * np.pi * f * t + 0.7 * i) for i, (f, t60, a) in enumerate(modes))


def scatter(random, count, low, high, t60, level):
    """Modes at random between two frequencies, the higher the shorter."""
    f = np.sort(low * (high / low) ** random.random(count))
    return [(x, t60 * (low / x) ** 0.5 * (0.7 + 0.6 * random.random()), level * random.normal()) for x in f]


def click(random, seconds, t60, slope, level):
    """Noise of the contact: so many dB per octave from 1 kHz, decaying."""
    count = int(seconds * RATE)
    f = np.fft.rfftfreq(count, 1 / RATE)
    tilt = (np.maximum(f, 50) / 1000) ** (slope / 6.02)
    noise = np.fft.irfft(np.fft.rfft(random.normal(size=count)) * tilt, count)
    t = np.arange(count) / RATE
    return level * noise / np.std(noise) * np.exp(-6.91 * t / t60)


def room(random, sound, t60, wet):
    """The sound in a room: direct, and a tail of decaying noise from 5 ms on."""
    t = np.arange(int(t60 * RATE)) / RATE
    tail = random.normal(size=t.size) * np.exp(-6.91 * t / t60) * (t > 0.005)
    tail *= wet / np.sqrt(np.sum(tail**2))
    size = 1 << (sound.size + tail.size).bit_length()
    wet_sound = np.fft.irfft(np.fft.rfft(sound, size) * np.fft.rfft(tail, size), size)[: sound.size]
    return sound + wet_sound


# Of each thing: seed, noise floor [dB below the peak], what the bank may be off [dB] and what it may be off at another strike
# point, length [s], where it is clipped (of the peak), a room (T60 [s], energy over that of the direct sound), named modes and
# scattered ones (count, from, to [Hz], T60 [s] of the lowest, level), and the click.
THINGS = {
    "wood-pad": dict(
        seed=1, floor_db=-55, limits=(2.2, 5.0), seconds=1.0,
        modes=[(310, 0.03, 1), (790, 0.02, 0.7), (1480, 0.014, 0.5), (2350, 0.01, 0.3)],
        click=dict(t60=0.012, slope=-6, level=0.35),
    ),
    "plastic-scoop": dict(
        seed=2, floor_db=-50, limits=(1.9, 4.9), seconds=1.0,
        modes=[(220, 0.045, 1), (540, 0.03, 0.6), (1150, 0.02, 0.4)], scattered=(8, 1500, 6000, 0.012, 0.15),
        click=dict(t60=0.02, slope=-4, level=0.3),
    ),
    "mortar": dict(
        seed=3, floor_db=-60, limits=(2.9, 4.2), seconds=1.0,
        scattered=(60, 900, 12000, 0.12, 0.3), click=dict(t60=0.02, slope=-2, level=0.4),
    ),
    "pitcher": dict(
        seed=4, floor_db=-45, limits=(1.7, 3.7), seconds=1.0,
        scattered=(25, 600, 9000, 0.3, 0.4), click=dict(t60=0.03, slope=-3, level=0.2),
    ),
    "bowl": dict(
        seed=5, floor_db=-60, limits=(2.5, 2.0), seconds=2.0,
        scattered=(14, 700, 12000, 1.2, 0.4), click=dict(t60=0.004, slope=0, level=0.1),
    ),
    "bowl-in-noise": dict(
        seed=6, floor_db=-22, limits=(1.7, 3.7), seconds=2.0,
        scattered=(14, 700, 12000, 0.9, 0.4), click=dict(t60=0.006, slope=-3, level=0.15),
    ),
    "pad-in-a-room": dict(
        seed=7, floor_db=-55, limits=(4.3, 5.6), seconds=1.0, room=(0.35, 0.35),
        modes=[(260, 0.04, 1), (690, 0.025, 0.7), (1700, 0.012, 0.4)], click=dict(t60=0.01, slope=-5, level=0.3),
    ),
    "skillet-clipped": dict(
        seed=8, floor_db=-50, limits=(2.1, 4.2), seconds=1.2, clip=0.5,
        scattered=(20, 300, 9000, 0.5, 0.4), click=dict(t60=0.02, slope=-4, level=0.3),
    ),
    "stand": dict(
        seed=9, floor_db=-40, limits=(2.0, 4.9), seconds=0.6,
        scattered=(12, 250, 5000, 0.05, 0.5), click=dict(t60=0.01, slope=-6, level=0.3),
    ),
}


def blow(thing, point):
    """The thing's sound from the onset on, peak 1: its modes, as loud as at this strike point, and another piece of noise."""
    own, here = np.random.default_rng(thing["seed"]), np.random.default_rng(thing["seed"] + 1000 * (1 + point))
    modes = list(thing.get("modes", []))
    if "scattered" in thing:
        modes += scatter(own, *thing["scattered"])
    there = [(f, t60, a * (0.3 + 1.4 * here.random()) * (1 if here.random() < 0.7 else -1)) for f, t60, a in modes]
    seconds = thing["seconds"]
    sound = ring(there, seconds) + click(here, seconds, **thing["click"])
    if "room" in thing:
        sound = room(here, sound, *thing["room"])
    return sound / np.max(np.abs(sound))


def recording(thing, point):
    """With silence and noise before, as a microphone hears it."""
    random, clip = np.random.default_rng(7 + point), 0.9 * thing.get("clip", 1)
    samples = np.concatenate([np.zeros(int(ONSET * RATE)), 0.9 * blow(thing, point)])
    floor = 10 ** (thing["floor_db"] / 20) * thing.get("clip", 1) * random.normal(size=samples.size)
    if "clip" not in thing:
        return samples + floor
    return np.clip(np.clip(samples, -clip, clip) + floor, -clip, clip)


def write(path, samples):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes((np.clip(samples, -1, 1) * 32767).astype("<i2").tobytes())


def read_bank(path):
    """Frequencies, decays and what an impulse of 1 N s along z moves each mode by."""
    model, numbers = bank_document.read_bank(path)

    def floats(key):
        return np.array(numbers(model[key]))

    return floats("frequencies"), floats("decayRates"), floats("shapes").reshape(-1, 3)[:, 2]


def play(bank, seconds):
    """One channel of the mixer, the object in the centre (docs/how/fit.md)."""
    t = np.arange(int(seconds * RATE)) / RATE
    out = np.zeros(t.size)
    for f, d, z in zip(*bank):
        out += 1e-4 / math.sqrt(2) * 2 * np.pi * f * z * np.exp(-d * t) * np.sin(2 * np.pi * f * t)
    return out


def cells(samples, onset):
    """Mean squares in thirds of an octave by 10 ms."""
    step, size = RATE // 100, 8192
    window = np.hanning(2 * step + 2)[1:-1]
    padded = np.concatenate([np.zeros(step), samples, np.zeros(2 * step)])
    count = (samples.size - onset) // step
    f = np.fft.rfftfreq(size, 1 / RATE)
    edges = 1000 * 10 ** ((np.arange(-11, 14) - 0.5) / 10)
    rows = []
    for c in range(count):
        at = onset + c * step - step // 2 + step
        power = np.abs(np.fft.rfft(padded[at : at + 2 * step] * window, size)) ** 2 / np.sum(window**2)
        sums = np.concatenate([[0], np.cumsum(power)])
        rows.append(np.diff(np.interp(edges, np.concatenate([f - f[1] / 2, [f[-1] + f[1] / 2]]), sums)))
    return np.array(rows).T


def noise_of(samples, onset):
    return np.mean(cells(samples[: onset - 960], 0), axis=1)[:, None]


def heard(recorded, noise):
    """Cells that stand 6 dB above the noise beside another one that does, or are the first."""
    stands = recorded > 4 * np.maximum(noise, 1e-8 * recorded.max())
    before, after = np.zeros_like(stands), np.zeros_like(stands)
    before[:, 1:], before[:, 0] = stands[:, :-1], True
    after[:, :-1] = stands[:, 1:]
    return stands & (before | after)


def distance(samples, model, onset):
    recorded, played = cells(samples, onset), model if model.ndim == 2 else cells(model, onset)
    noise = noise_of(samples, onset)
    good = heard(recorded, noise)
    level = lambda gain: 10 * np.log10(recorded[good]) - 10 * np.log10((gain * played + noise)[good])
    shift = np.mean(level(1))
    return math.sqrt(np.mean(level(10 ** (shift / 10)) ** 2)), shift


def predict(samples, bank, modes, onset):
    """Cells of the bank at another strike point, where all that is known of that is how loud each mode is: powers by the
    multiplicative updates of Itakura and Saito's divergence [Fevotte, Bertin & Durrieu, Neural Computation 21, 2009]. The
    burst, what comes after `modes` modes, has one level of its own."""
    recorded, noise = cells(samples, onset), noise_of(samples, onset)
    parts = []
    for i in range(modes + 1):
        chosen = [x[i : i + 1] if i < modes else x[modes:] for x in bank]
        sound = np.zeros(samples.size)
        played = play(chosen, (samples.size - onset) / RATE)
        sound[onset : onset + played.size] = played
        parts.append(cells(sound, onset))
    parts, good = np.array(parts), heard(recorded, noise)
    gain = np.ones(modes + 1)
    for _ in range(200):
        model = np.tensordot(gain, parts, 1) + noise
        up = np.sum(parts * (recorded / model**2)[None] * good, axis=(1, 2))
        down = np.sum(parts * (1 / model)[None] * good, axis=(1, 2))
        gain *= np.sqrt(up / np.maximum(down, 1e-300))
    return np.tensordot(gain, parts, 1)


def fit(program, path, bank, options):
    ran = subprocess.run([program, str(path), "-o", str(bank), *options], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        sys.exit(f"{path}: {ran.stderr}")
    return ran


def main():
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    if len(words) != 2:
        sys.exit(__doc__)
    program, folder = words[0], pathlib.Path(words[1])
    options = ["--no-burst"] if "--without-burst" in sys.argv else []
    folder.mkdir(parents=True, exist_ok=True)
    onset, faults, here = int(ONSET * RATE), 0, []
    table = "--table" in sys.argv
    if table:
        print("| sound | modes | explained | distance [dB] | level of the bank [dB] | another strike point [dB] |")
        print("|---|---|---|---|---|---|")
    for name, thing in THINGS.items():
        limits, seconds = thing["limits"], thing["seconds"]
        samples, other = recording(thing, 0), recording(thing, 1)[: int((ONSET + 0.8) * RATE)]
        path, bank = folder / f"{name}.wav", folder / f"{name}.glb"
        write(path, samples)
        ran = fit(program, path, bank, options)
        model = np.zeros(samples.size)
        played = play(read_bank(bank), seconds)
        model[onset : onset + played.size] = played[: samples.size - onset]
        off, shift = distance(samples, model, onset)
        words = ran.stdout.split(":", 1)[1].split()
        burst = re.search(r"as (\d+) short modes", ran.stdout)
        kept = read_bank(bank)
        modes = kept[0].size - (int(burst.group(1)) if burst else 0)
        predicted, _ = distance(other, predict(other, kept, modes, onset), onset)
        good = off <= limits[0] and predicted <= limits[1] and abs(shift) < 3
        faults += not good
        here.append(off)
        if table:
            print(f"| {name} | {words[0]} | {words[3]} % | {off:.1f} | {-shift:+.1f} | {predicted:.1f} |")
        else:
            said = ", warned" if "warning" in ran.stderr else ""
            fault = "" if good else "  ABOVE ITS LIMIT"
            print(f"{name:16} {words[0]:>3} modes explain {words[3]} %, distance {off:.2f} dB, bank {-shift:+.2f} dB, "
                  f"another strike point {predicted:.2f} dB{said}{fault}", flush=True)
    if not table:
        print(f"median {np.median(here):.2f} dB, worst {max(here):.2f} dB")
    faults += max(here) > 5 or np.median(here) > 2.5  # what is promised of such a set
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
