/* libringdown: solid objects as playable, physically exact sound, inside your own program.
 *
 *   ringdown_bank* bank;                                             // what a body's modes are: a file from `ringdown bake`
 *   ringdown_bank_open("bell.glb", &bank, NULL);
 *   ringdown_mixer* mixer;                                           // what rings
 *   ringdown_mixer_create(NULL, &mixer, NULL);                       // 48 kHz, stereo, limiter
 *   uint32_t bell;
 *   ringdown_add(mixer, "bell", bank, &bell, NULL);                  // worker thread
 *   const double point_m[3] = {0, 0, 0.1}, impulse_ns[3] = {0, 0, -0.02};
 *   ringdown_strike(mixer, 480, bell, point_m, impulse_ns, 2e-4, NULL);  // control thread: at frame 480
 *   ringdown_render(mixer, left, right, 256);                        // audio thread: frames 0 ... 255
 *
 * The library is the mixer of the daemon ringdownd and of `ringdown render`: what is sent to either gives the same
 * samples here. It opens no socket, starts no thread (unless settings.threads says so), prints nothing and has no
 * global state: any number of mixers live side by side. Scenes of rigid bodies are a library of their own,
 * ringdown_scene.h.
 *
 * UNITS are SI: metres, seconds, newtons, kilograms, Hz, pascals; angles do not occur. Points and impulses of an object
 * are in the object's own frame, the one of its mesh. Rotations are unit quaternions w x y z, real part first:
 * 1 0 0 0 is not turned, cos(a/2) 0 0 sin(a/2) is turned by the angle a about z, from x towards y. Frames are
 * right-handed. A left-handed world with y up (Unity:
 * x right, y up, z forward) is mapped to a right-handed one by negating one axis of every point, impulse and
 * direction, say z, and the x and y components of every quaternion; centimetres are divided by 100 (impulses in
 * kg cm/s as well).
 *
 * TIME is counted in sample frames, 64 bits, from 0, the first frame a mixer renders; ringdown_now() is the frame that
 * the next block begins with. An event happens at its own frame, whatever the block size, up to an hour ahead. An event
 * whose frame has passed happens at once and is counted as late. So "as soon as possible" is frame 0, and "at offset k
 * of the next block" is ringdown_now() + k.
 *
 * THREADS. Each function says which thread may call it, for one mixer:
 *   [worker]   one thread at a time. May allocate, read files and take milliseconds.
 *   [control]  one thread at a time. Allocates nothing, locks nothing, makes no system call while it succeeds, so it
 *              may be the audio thread.
 *   [audio]    one thread at a time: ringdown_render(). Allocates nothing, locks nothing, makes no system call, and
 *              takes time in proportion to what sounds.
 *   [any]      any number of threads.
 * The three may be one thread or three, and none waits for another, except where bodies break. Functions of different
 * mixers never meet. While ringdown_mixer_destroy() or ringdown_set_sample_rate() runs, no other function of that mixer
 * may.
 *
 * RANGES. A number outside of its range is refused, with a sentence that names the parameter. Unless stated otherwise,
 * each coordinate of a point or position lies within 1e4 m of 0, of an impulse within 1e4 N s, of a force within 1e6 N,
 * of a direction within 1e3. A point at which something acts on an object must not be farther from the object than the
 * object is large; otherwise the point is refused, because its units or coordinates must be wrong.
 *
 * OWNERSHIP. Whoever opens a bank releases it; mixers hold on to the banks of their objects by themselves, so a bank
 * may be released as soon as it has been added. Arrays that the library returns belong to it, and say how long they
 * live. Strings are UTF-8 and end with 0.
 *
 * ERRORS. A function that can fail returns 0 (RINGDOWN_OK) or the kind of failure, and writes one sentence for people
 * into `error` unless that is NULL: what, where, what to do. After a failure nothing has changed. Functions without a
 * result accept a NULL handle and then do nothing. Numbers that are not finite, and null pointers where something is
 * needed, are refused and never crash. No exception leaves the library.
 *
 * VERSIONS. A struct begins with its `size`: set it to sizeof the struct, as its _init function does. Later versions of
 * libringdown.so.1 add functions, and members at the end of structs; they change and remove none, so a program runs
 * with every later library of this number. Members beyond the end of a caller's shorter struct keep their defaults.
 * Members that an older library does not know are refused if they are not 0.
 *
 * The library is under the MIT licence and links nothing under the GPL (docs/how/dependencies.md lists what it links). */
#ifndef RINGDOWN_H
#define RINGDOWN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(RINGDOWN_BUILDING) && defined(__GNUC__)
#define RINGDOWN_API __attribute__((visibility("default")))
#else
#define RINGDOWN_API
#endif

/* ---- Errors and version ------------------------------------------------------------------------------------------ */

typedef enum ringdown_result {
  RINGDOWN_OK = 0,
  RINGDOWN_BAD_INPUT = 1,    /* a file cannot be opened or is not what it should be; an argument is NULL, out of range, or
                                not the number of an object */
  RINGDOWN_TOO_LARGE = 2,    /* it exceeds a limit: bytes, modes, objects */
  RINGDOWN_REFUSED = 3,      /* a good request, but impossible now: a queue is full, the body is fixed */
  RINGDOWN_NO_MEMORY = 4,    /* the computer has not enough memory */
  RINGDOWN_INPUT_OUTPUT = 5  /* the operating system could not read on or start a thread */
} ringdown_result;

typedef struct ringdown_error {
  ringdown_result result;
  char sentence[508]; /* ends with 0; cut off at a character if it is longer */
} ringdown_error;

/* The library's version, "1.0.0"; lives for ever. [any] */
RINGDOWN_API const char* ringdown_version(void);

/* ---- Banks: what a body's modes are ------------------------------------------------------------------------------ */

/* A bank is immutable and may be shared by any number of objects, mixers and threads. Open a file once and add it as
 * often as you like: objects of one bank share its memory, and much of their work. All functions of this part: [any]. */
typedef struct ringdown_bank ringdown_bank;

/* Reads a bank, a .glb of `ringdown bake` or of another program (KHR_audio_rigid_bodies). */
RINGDOWN_API ringdown_result ringdown_bank_open(const char* path, ringdown_bank** bank, ringdown_error* error);

/* Reads a bank from `bytes` bytes of memory, which are not needed afterwards. Error sentences contain `name` in place
 * of the path; NULL: "bank". */
RINGDOWN_API ringdown_result ringdown_bank_parse(const void* glb, size_t bytes, const char* name, ringdown_bank** bank,
                                                 ringdown_error* error);

/* Releases the bank; objects that play it continue. NULL is allowed. */
RINGDOWN_API void ringdown_bank_release(ringdown_bank* bank);

/* M modes, in order of decreasing importance to the ear; P points on the surface at which shapes are known; T triangles
 * between them. */
typedef struct ringdown_bank_info {
  size_t size;
  size_t modes, points, triangles; /* M, P, T */
  const char* name;                /* of the object, "" without one; lives as long as the bank */
  const char* material;            /* "" without one; lives as long as the bank */
  double youngs_modulus_pa, poisson_ratio, density_kg_m3; /* 0 without a material */
  double mass_kg;                                         /* 0: not known */
  double center_of_mass_m[3];
  int has_radiation; /* 1: modes have radiation maps */
  int held;          /* 1: supports hold the body; 0: it is free */
  int has_residual;  /* 1: ringdown_bank_read_residual() has read one */
  double inertia_kg_m2[3]; /* principal moments about the centre of mass */
  double axes_wxyz[4];     /* turns the principal axes into the object's frame */
  double level_m[2];       /* the bottom and the rim, between which ringdown_fill() may set the level; 0 0: it may not */
} ringdown_bank_info;

/* Fills as many members as info->size has room for. Set info->size before. */
RINGDOWN_API ringdown_result ringdown_bank_describe(const ringdown_bank* bank, ringdown_bank_info* info);

typedef enum ringdown_pitch {
  RINGDOWN_PITCH_NONE = 0,      /* no definite pitch, like most plates */
  RINGDOWN_PITCH_ESTIMATED = 1, /* estimated from its modes */
  RINGDOWN_PITCH_STATED = 2     /* stated in the bank */
} ringdown_pitch;

/* The pitch of the object in its own size and material [Hz]. Without a definite pitch, the frequency that comes closest
 * to one, which is always above 0. Takes milliseconds. */
RINGDOWN_API ringdown_result ringdown_bank_pitch(const ringdown_bank* bank, double* hz, ringdown_pitch* kind);

/* Arrays of the bank; they live as long as it does. */
RINGDOWN_API const double* ringdown_bank_frequencies_hz(const ringdown_bank* bank);  /* M, damped */
RINGDOWN_API const double* ringdown_bank_decays_per_s(const ringdown_bank* bank);    /* M, of the amplitude; T60 = 6.91/decay */
RINGDOWN_API const float* ringdown_bank_points_m(const ringdown_bank* bank);         /* P x 3 */
RINGDOWN_API const float* ringdown_bank_shapes(const ringdown_bank* bank);           /* M x P x 3, mass-normalised [kg^-1/2] */
RINGDOWN_API const uint32_t* ringdown_bank_triangles(const ringdown_bank* bank);     /* T x 3 point numbers */

/* Sound pressure at 1 m per modal velocity, rms over directions [Pa / (kg^1/2 m/s)], into `levels`, which has room for
 * M numbers. A strike of impulse J at a point gives mode m the modal velocity shapes[m][point] . J. */
RINGDOWN_API ringdown_result ringdown_bank_levels_pa(const ringdown_bank* bank, double* levels);

/* The far field F of a mode towards `count` directions (count x 3, any length but 0): count x 2 numbers, real and
 * imaginary part [m^2 kg^-1/2]. The pressure at distance r is i rho omega v F exp(ikr)/r for a modal velocity v, with
 * time as exp(-i omega t). `mode` < M. RINGDOWN_REFUSED without maps (has_radiation). */
RINGDOWN_API ringdown_result ringdown_bank_far_field(const ringdown_bank* bank, size_t mode, const double* directions,
                                                     size_t count, float* far_field, ringdown_error* error);

/* Numbers that not every bank has. */
typedef enum ringdown_bank_list {
  RINGDOWN_FREQUENCY_ERRORS = 0, /* M estimated relative errors of the frequencies */
  RINGDOWN_SHAPE_ERRORS = 1,     /* M estimated relative errors of amplitudes between sample points */
  RINGDOWN_LEVEL_ERRORS_DB = 2,  /* M estimated errors of what the modes radiate [dB] */
  RINGDOWN_LOSSES_PER_S = 3      /* M x 4 parts of the decays: to the material, heat, the air, supports [1/s] */
} ringdown_bank_list;

/* Writes a list into `numbers`, which has room for `*count` of them, and sets `*count` to its length: 0 if the bank does
 * not know it. With `numbers` NULL, only sets `*count`. */
RINGDOWN_API ringdown_result ringdown_bank_numbers(const ringdown_bank* bank, ringdown_bank_list list, double* numbers,
                                                   size_t* count, ringdown_error* error);

/* How the bank was made, as a JSON object (docs/reference/bank-format.md). Writes the text and a 0 into `text`, which has
 * room for `*bytes`, and sets `*bytes` to what they take. With `text` NULL, only sets `*bytes`. */
RINGDOWN_API ringdown_result ringdown_bank_provenance(const ringdown_bank* bank, char* text, size_t* bytes,
                                                      ringdown_error* error);

/* The bank as the bytes of a bank file, which ringdown_bank_parse() reads. `glb` and `*bytes` as above. */
RINGDOWN_API ringdown_result ringdown_bank_write(const ringdown_bank* bank, void* glb, size_t* bytes,
                                                 ringdown_error* error);

/* Reads the response of the modes that are not in the bank, those above its band foremost, from a file that `ringdown bake
 * --export-residual` wrote with the bank (.npy). ringdown_bank_frf() then includes it. Call before other threads use the
 * bank. */
RINGDOWN_API ringdown_result ringdown_bank_read_residual(ringdown_bank* bank, const char* path, ringdown_error* error);

typedef enum ringdown_motion {
  RINGDOWN_DISPLACEMENT = 0, /* receptance [m/N] */
  RINGDOWN_VELOCITY = 1,     /* mobility [m/(N s)] */
  RINGDOWN_ACCELERATION = 2  /* accelerance [1/kg] */
} ringdown_motion;

/* The motion at one place of the surface per newton at another, for `count` frequencies above 0: count x 2 numbers, real
 * and imaginary part, with time as exp(+i omega t). Places are the nearest of the surface; directions have any length but
 * 0. Includes the rigid motion of a free body, and the modes that are not in the bank if it has_residual. */
RINGDOWN_API ringdown_result ringdown_bank_frf(const ringdown_bank* bank, ringdown_motion motion, const double at_m[3],
                                               const double direction[3], const double to_m[3],
                                               const double to_direction[3], const double* frequencies_hz, size_t count,
                                               double* frf, ringdown_error* error);

/* The sound pressure at a point in the air, in the object's frame, per newton at a place of the surface [Pa/N]: count x 2
 * numbers. A sum of far fields; RINGDOWN_REFUSED without radiation maps. */
RINGDOWN_API ringdown_result ringdown_bank_pressure_frf(const ringdown_bank* bank, const double at_m[3],
                                                        const double direction[3], const double to_m[3],
                                                        const double* frequencies_hz, size_t count, double* frf,
                                                        ringdown_error* error);

/* The energy that the object radiates per hertz after an impulse of 1 N s at a place of the surface, at `count`
 * frequencies [J/Hz/(N s)^2]. RINGDOWN_REFUSED without radiation maps. */
RINGDOWN_API ringdown_result ringdown_bank_energy_spectrum(const ringdown_bank* bank, const double at_m[3],
                                                           const double direction[3], const double* frequencies_hz,
                                                           size_t count, double* energies, ringdown_error* error);

/* ---- A mixer ----------------------------------------------------------------------------------------------------- */

typedef struct ringdown_mixer ringdown_mixer;

typedef struct ringdown_settings {
  size_t size;
  double sample_rate_hz; /* 8000 ... 384000; default 48000 */
  double full_scale_pa;  /* the sound pressure at 1 m that becomes a sample of 1, 1e-6 ... 1e6; default 20, 117 dB SPL. That
                            is the sample of one channel that has the whole sound: the left one of an object panned to the
                            left, or ambisonic channel 0. Left and right share the power of an object in the middle, so
                            that each has 1/sqrt(2) of it, -3.01 dB: full_scale_pa becomes 0.707 on either side. */
  double limiter_db;     /* ceiling of left and right, -60 ... 0 dB of full scale, or 1: no limiter; default -1. The limiter
                            delays left and right by ringdown_latency() frames. */
  double floor_db;       /* modes this many dB below full scale rest until the next strike; 20 ... 300, default 120 */
  int exact_contacts;    /* 1: a strike's pulse drives the modes sample by sample while it lasts; default 0 */
  int ambisonic_order;   /* 1 ... 3: ringdown_render_all() writes (order + 1)^2 channels; default 0: none */
  int threads;           /* threads that render large scenes, including the audio thread, 1 ... 64; default 1 */
  const char* head;      /* binaural left and right: a SOFA file, or "" for libmysofa's own head; default NULL:
                            stereo */
  int travel_time;       /* 1: each event is delayed by the travel time of its sound to the listener; default 0 */
} ringdown_settings;

/* Fills in the defaults: ringdown_settings settings; ringdown_settings_init(&settings, sizeof settings); [any] */
RINGDOWN_API void ringdown_settings_init(ringdown_settings* settings, size_t size);

/* Makes a mixer; settings NULL: the defaults. [any] */
RINGDOWN_API ringdown_result ringdown_mixer_create(const ringdown_settings* settings, ringdown_mixer** mixer,
                                                   ringdown_error* error);
/* Destroys the mixer and its sound. NULL is allowed. [any, while no other function of this mixer runs] */
RINGDOWN_API void ringdown_mixer_destroy(ringdown_mixer* mixer);

/* Changes the sample rate; ringing sounds keep their pitch. [any, while no other function of this mixer runs] */
RINGDOWN_API ringdown_result ringdown_set_sample_rate(ringdown_mixer* mixer, double sample_rate_hz,
                                                      ringdown_error* error);

/* ---- Objects [worker] -------------------------------------------------------------------------------------------- */

enum { RINGDOWN_MAX_OBJECTS = 2048, RINGDOWN_MAX_DAMPERS = 8, RINGDOWN_MAX_INPUTS = 4, RINGDOWN_MAX_PICKUPS = 8 };

/* Adds an object that plays the bank and writes its number, which all other functions take, to `object`. An existing
 * object of this name gets the new bank and keeps its number; ringing sounds continue with the old bank. A name has 1
 * to 64 letters, digits, '_', '-' or '.', not all of them digits; NULL: "object" and a number that makes it unused.
 * RINGDOWN_TOO_LARGE beyond RINGDOWN_MAX_OBJECTS, which counts removed objects until they have faded out. */
RINGDOWN_API ringdown_result ringdown_add(ringdown_mixer* mixer, const char* name, const ringdown_bank* bank,
                                          uint32_t* object, ringdown_error* error);

/* Removes the object; its sound fades out within some milliseconds. */
RINGDOWN_API ringdown_result ringdown_remove(ringdown_mixer* mixer, uint32_t object, ringdown_error* error);

/* Factors on the bank's own material and size; all 1 is the bank as baked. Ringing sounds are retuned. The result is
 * exact, without a new bake. stiffness scales Young's modulus, size all lengths; alpha, beta, heat and air scale the
 * losses to supports, to the material, to heat that flows in the body, and to the air. Points of later calls lie on the
 * object in its new size. Stiffness and density are 0.001 ... 1000, size 0.01 ... 100, alpha and beta 0 ... 1000, heat
 * and air as well. */
typedef struct ringdown_material {
  size_t size_of_struct; /* sizeof(ringdown_material) */
  double stiffness, density, size, alpha, beta;
  double heat, air; /* a shorter struct leaves them at 1 */
} ringdown_material;
RINGDOWN_API void ringdown_material_init(ringdown_material* material, size_t size_of_struct); /* [any] */
RINGDOWN_API ringdown_result ringdown_set_material(ringdown_mixer* mixer, uint32_t object,
                                                   const ringdown_material* material, ringdown_error* error);

/* Lets the liquid in the object stand at `level_m` in the object's frame and size, from frame `frame` on; what rings is
 * retuned. The bank must know its levels (ringdown bake with [fill] and levels = 16). From the bottom, where it is
 * empty, to the rim. For a glide, send steps of about 1 mm. */
RINGDOWN_API ringdown_result ringdown_fill(ringdown_mixer* mixer, int64_t frame, uint32_t object, double level_m,
                                           ringdown_error* error);

/* Tunes the tubes under the object by `detune_cents` from their tuning as baked, -1200 to 1200, with a share `opening` of
 * their mouths open, 0 to 1, from frame `frame` on; what rings is retuned. The bank must have a tube (ringdown bake with
 * [[resonator]]). For a glide, send steps of about 2 cents. */
RINGDOWN_API ringdown_result ringdown_resonator(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                                double detune_cents, double opening, ringdown_error* error);

/* Lays a hand or a table on the object: damper `number` < RINGDOWN_MAX_DAMPERS at the point of the surface nearest to
 * point_m resists motion along `direction` (0 0 0: any motion) with damping_ns_m newtons per m/s, 0 ... 1e6, from frame
 * `frame` on. Damping 0 removes the damper. A light touch of a finger is about 0.1, a hand 10. */
RINGDOWN_API ringdown_result ringdown_hold(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t number,
                                           const double point_m[3], const double direction[3], double damping_ns_m,
                                           ringdown_error* error);

/* While any object is soloed, only soloed objects are heard; a muted object is never heard. Fades within 20 ms. */
RINGDOWN_API ringdown_result ringdown_mute(ringdown_mixer* mixer, uint32_t object, int on, ringdown_error* error);
RINGDOWN_API ringdown_result ringdown_solo(ringdown_mixer* mixer, uint32_t object, int on, ringdown_error* error);

/* From the next block on, input `input` < RINGDOWN_MAX_INPUTS of ringdown_render_all() pushes the object: a sample of 1
 * is force_n newtons at the point of its surface nearest to point_m. An input pushes one object at a time. A force of 0
 * 0 0 disconnects the input, whatever the point. RINGDOWN_TOO_LARGE for an object of more than 4096 modes. */
RINGDOWN_API ringdown_result ringdown_excite(ringdown_mixer* mixer, uint32_t input, uint32_t object,
                                             const double point_m[3], const double force_n[3], ringdown_error* error);

/* Frees what no longer sounds: banks, and the numbers of objects that were removed. Several times a second. */
RINGDOWN_API void ringdown_collect(ringdown_mixer* mixer);

/* ---- Bodies that break ------------------------------------------------------------------------------------------- */

/* A bank that was baked with [shatter] has patterns of pieces, each for a place of the blow. While a level loads,
 * ringdown_breakable() and ringdown_breakable_piece() say what the pieces are, so that a game makes bodies and meshes of
 * them, and ringdown_arm() makes them objects of the mixer. ringdown_break() breaks an armed object: it falls silent, the
 * pieces go on with the motion that they had as parts of it, and ringdown_piece() says how each of them flies. Pieces are
 * objects like any other: strike and place them by their numbers. All that concerns a piece is in the frame of the object
 * that it is from.
 *
 * While an object is armed, the blows that it gets are followed, so that it breaks as it rings then. What ringdown_ring(),
 * bows, contacts and inputs excite is missing in the pieces. Call ringdown_collect() at least once in 4096 events then:
 * [control] functions would wait for a lock otherwise, and do so after a break, to refuse blows on what is broken. */

#define RINGDOWN_NO_OBJECT 0xffffffffu

typedef struct ringdown_pattern_info {
  size_t size;
  uint32_t patterns;     /* of the bank */
  uint32_t pieces;       /* of this pattern */
  double at_m[3];        /* the place of the blow; patterns of one place come with ascending numbers of pieces */
  double crack_energy_j; /* what the crack takes from the object's vibration; 0: the bank does not know */
} ringdown_pattern_info;

/* Fills as many members as info->size has room for. Set info->size before. RINGDOWN_BAD_INPUT for a bank without pieces,
 * and for a pattern that it does not have; they count from 0. [any] */
RINGDOWN_API ringdown_result ringdown_breakable(const ringdown_bank* bank, uint32_t pattern, ringdown_pattern_info* info,
                                                ringdown_error* error);

typedef struct ringdown_piece_info {
  size_t size;
  uint32_t object;            /* its number in the mixer; RINGDOWN_NO_OBJECT: it never rings, or this is of a bank */
  uint32_t pieces;            /* how many there are */
  double mass_kg;
  double center_of_mass_m[3];
  double inertia_kg_m2[3];    /* principal moments */
  double axes_wxyz[4];        /* turns the principal axes into the object's frame */
  double velocity_m_s[3];     /* of its centre of mass, and its spin, both beyond the motion that the object had before */
  double spin_rad_s[3];       /* the blow; 0 until it breaks */
  size_t modes, points, triangles; /* of its own bank: M, P, T; 0 from ringdown_piece() */
  const float* points_m;           /* P x 3; lives as long as the bank; NULL from ringdown_piece() */
  const uint32_t* triangle_points; /* T x 3 point numbers; lives as long as the bank; NULL from ringdown_piece() */
} ringdown_piece_info;

/* A piece of a pattern in the bank's own size and material; pieces count from 0. [any] */
RINGDOWN_API ringdown_result ringdown_breakable_piece(const ringdown_bank* bank, uint32_t pattern, uint32_t piece,
                                                      ringdown_piece_info* info, ringdown_error* error);

/* Makes the pieces of a pattern (-1: the finest at the place of the first one) objects of the mixer, NAME.0, NAME.1 ...,
 * unless they are already, and writes how many pieces there are to `pieces`, which may be NULL. Takes some 20 ms for ten
 * pieces. A new bank or material disarms the object. [worker] */
RINGDOWN_API ringdown_result ringdown_arm(ringdown_mixer* mixer, uint32_t object, int32_t pattern, uint32_t* pieces,
                                          ringdown_error* error);

/* Breaks an armed object at the peak of a blow, which is frame `frame`, and writes how many pieces there are to `pieces`,
 * which may be NULL. The velocities of the pieces have the first half of the blow; the piece under it sounds as the second
 * half strikes it, too. RINGDOWN_REFUSED for an object that is broken, or not armed. Modes of pieces that found no room
 * among the waiting events are counted as dropped. Takes some tenths of a millisecond and allocates, so it must not run on
 * the audio thread. Strikes on the object itself are refused from now on. [control] */
RINGDOWN_API ringdown_result ringdown_break(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                            const double point_m[3], const double impulse_ns[3], double contact_time_s,
                                            uint32_t* pieces, ringdown_error* error);

/* A piece of an armed or broken object, in the object's size and material. [any, but not on the audio thread] */
RINGDOWN_API ringdown_result ringdown_piece(ringdown_mixer* mixer, uint32_t object, uint32_t piece,
                                            ringdown_piece_info* info, ringdown_error* error);

/* The largest tensile stress that a blow would cause on the skin of an armed object, away from the blow: a game that lets
 * blows decide compares it with a strength, glass 4e7 to 7e7 Pa. 0 if the bank does not know. Takes milliseconds and
 * allocates. [control] */
RINGDOWN_API ringdown_result ringdown_stress(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                             const double point_m[3], const double impulse_ns[3], double contact_time_s,
                                             double* stress_pa, ringdown_error* error);

/* Removes the pieces; the object can be struck again, and is no longer armed. [worker] */
RINGDOWN_API ringdown_result ringdown_mend(ringdown_mixer* mixer, uint32_t object, ringdown_error* error);

/* ---- Events [control] -------------------------------------------------------------------------------------------- */

/* At most 4096 events may come between two blocks; one more is refused and counted as dropped. At most 1024 events happen
 * in 128 frames: those beyond happen in the 128 frames that follow, in order, and are not counted as late. So a flood
 * of 4096 events for one frame takes 512 frames. */

/* Bows, mallets and couplings feel how the surface moves under them, sample by sample; at most 16 such contacts act at
 * a time. Beyond this limit a mallet becomes a strike, and a bow or a coupling is refused and counted in `refused` of
 * the status.
 *
 * Functions with many parameters take a struct, whose _init function fills in the defaults. */

/* <verbs> What follows is written by ringdown_write_verbs. */
/* Strikes the object at the surface point nearest to x y z. point_m: The struck point. impulse_ns: The impulse on the
 * object. contact_time_s: The duration of the blow; a longer blow is duller. 0 ... 0.1, default 0.0002. */
RINGDOWN_API ringdown_result ringdown_strike(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                             const double point_m[3], const double impulse_ns[3],
                                             double contact_time_s, ringdown_error* error);

/* Strikes the object at a sample point of its bank. vertex: The point's number, from 0. 0 ... 16777215. impulse_ns:
 * The impulse on the object. contact_time_s: The duration of the blow; a longer blow is duller. 0 ... 0.1, default
 * 0.0002. */
RINGDOWN_API ringdown_result ringdown_strike_vertex(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                                    uint32_t vertex, const double impulse_ns[3],
                                                    double contact_time_s, ringdown_error* error);

/* Sets the object's loudness. gain: The factor on the object's signal; 1 is the computed level. 0 ... 100. ramp_s:
 * The duration of the change. 0 ... 60, default 0. */
RINGDOWN_API ringdown_result ringdown_gain(ringdown_mixer* mixer, int64_t frame, uint32_t object, double gain,
                                           double ramp_s, ringdown_error* error);

/* Pans the object at equal power. pan: -1 is left, 0 the middle, 1 right. -1 ... 1. */
RINGDOWN_API ringdown_result ringdown_pan(ringdown_mixer* mixer, int64_t frame, uint32_t object, double pan,
                                          ringdown_error* error);

/* Turns a fan in the mouth of the object's tube: a vibraphone's tremolo. Objects without a tube sound as before.
 * rate_hz: Closings of the mouth per second. 0 ... 20. depth: 1 closes the mouth; 0 stops the fan. 0 ... 1. */
RINGDOWN_API ringdown_result ringdown_fan(ringdown_mixer* mixer, int64_t frame, uint32_t object, double rate_hz,
                                          double depth, ringdown_error* error);

/* Sends the motion of a point of the object to an output of its own, as a contact microphone or a laser vibrometer
 * measures it: port pickup_1 to pickup_8. Gain, pan, mute and listener do not change it. A pickup of this number on
 * another object moves here; a direction of 0 0 0 removes it. */
typedef struct ringdown_pickup_args {
  size_t size; /* sizeof the struct, as _init sets it */
  /* The point; the surface point nearest to it counts. */
  double point_m[3];
  /* The direction of the motion; any length. */
  double direction[3];
  /* The pickup's number, and that of its output. 1 ... 8, default 1. */
  uint32_t bus;
  /* 0 is displacement, 1 velocity, 2 acceleration. 0 ... 2, default 1. */
  uint32_t motion;
  /* The sample for a motion of 1 m, 1 m/s or 1 m/s2. -1e12 ... 1e12, default 1. */
  double gain;
} ringdown_pickup_args;
RINGDOWN_API void ringdown_pickup_args_init(ringdown_pickup_args* args, size_t size); /* [any] */
RINGDOWN_API ringdown_result ringdown_pickup(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                             const ringdown_pickup_args* args, ringdown_error* error);

/* Starts modes without a strike, each as a sine from 0. first: The lowest of these modes; mode 0 has the lowest
 * frequency. 0 ... 16777215. count: The number of modes, counted upwards. 0 ... 2147483647, default 1. amplitude: The
 * amplitude of each mode, at gain 1, before the pan; 1 is full scale. 0 ... 1, default 0.1. */
RINGDOWN_API ringdown_result ringdown_ring(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t first,
                                           uint32_t count, double amplitude, ringdown_error* error);

/* Starts one mode with a known motion, such as one of your own computation, or of a body that breaks. mode: The
 * mode's number; mode 0 has the lowest frequency. 0 ... 16777215. velocity: The mode's largest velocity, for a shape
 * whose modal mass is 1 kg. -1000000 ... 1000000. phase_rad: 0 starts the mode as a blow does, pi/2 from rest at its
 * largest displacement. -1000 ... 1000, default 0. */
RINGDOWN_API ringdown_result ringdown_impart(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t mode,
                                             double velocity, double phase_rad, ringdown_error* error);

/* Fades everything that rings in the object, and ends its contacts. ramp_s: The duration of the fade, at least about
 * 10 ms. 0 ... 60, default 0. */
RINGDOWN_API ringdown_result ringdown_clear(ringdown_mixer* mixer, int64_t frame, uint32_t object, double ramp_s,
                                            ringdown_error* error);

/* Damps everything that rings in the object, like a hand on a cymbal. Bows and other contacts continue, and later
 * strikes ring. within_s: The time in which the amplitude falls by 60 dB. Less than 5 ms causes a click. 0 ... 60,
 * default 0.2. */
RINGDOWN_API ringdown_result ringdown_choke(ringdown_mixer* mixer, int64_t frame, uint32_t object, double within_s,
                                            ringdown_error* error);

/* Slaps the mouth of the object, such as a bottle's, so that the air in it rings. The bank must have this air (bake
 * it with [cavity]). impulse_ns: The impulse on the air in the mouth. -10000 ... 10000. contact_time_s: The duration
 * of the blow; a longer blow is duller. 0 ... 0.1, default 0.001. */
RINGDOWN_API ringdown_result ringdown_slap(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                           double impulse_ns, double contact_time_s, ringdown_error* error);

/* Blows over the mouth of the object, so that the air in it sounds, until a pressure of 0 or /clear ends it. The
 * breath is noise that does not feel how the air moves: it colours, and does not lock into a tone. The bank must have
 * this air (bake it with [cavity]). pressure_pa: The noise in the mouth from 20 Hz to 10 kHz, root mean square; 0
 * ends it. 0 ... 100000. */
RINGDOWN_API ringdown_result ringdown_blow(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                           double pressure_pa, ringdown_error* error);

/* Lets something slide or roll on the object. Values are interpolated between messages: send 50 to 250 a second. A
 * force of 0 0 0, or 0.1 s without a message, ends the contact. */
typedef struct ringdown_contact_args {
  size_t size; /* sizeof the struct, as _init sets it */
  /* The point of contact. */
  double point_m[3];
  /* The force on the object, friction included. */
  double force_n[3];
  /* The speed at which the surfaces slide past each other. 0 ... 1000. */
  double slip_m_s;
  /* The speed at which the point of contact travels. 0 ... 1000, default 0. */
  double roll_m_s;
  /* The contact's number; an object can have four contacts at once. 0 ... 16777215, default 0. */
  uint32_t number;
  /* The root mean square of the heights of both surfaces together. 0 ... 0.1, default 2e-6. */
  double roughness_m;
  /* The longest wavelength of the roughness. 1e-7 ... 10, default 5e-5. */
  double correlation_m;
  /* The exponent of the power spectrum of the heights over spatial frequency. -10 ... 0, default -2.4. */
  double slope;
} ringdown_contact_args;
RINGDOWN_API void ringdown_contact_args_init(ringdown_contact_args* args, size_t size); /* [any] */
RINGDOWN_API ringdown_result ringdown_contact(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                              const ringdown_contact_args* args, ringdown_error* error);

/* Bows the object: the hair sticks and slips, and reacts to the surface's motion. Send the message again to change
 * speed or force, which glide to their new values within the time since the last message, 2 to 50 ms. A force of 0
 * lifts the bow. */
typedef struct ringdown_bow_args {
  size_t size; /* sizeof the struct, as _init sets it */
  /* The point on which the bow lies. */
  double point_m[3];
  /* The direction in which the hair moves along the surface; any length but 0. */
  double direction[3];
  /* The hair's speed; a negative speed reverses the direction. -100 ... 100. */
  double speed_m_s;
  /* The force that presses the bow on the surface. 0 ... 100000. */
  double force_n;
  /* The width of the hair; modes with shorter wavelengths feel less of the bow. 0 ... 1, default 0. */
  double width_m;
  /* The coefficient of static friction; that of sliding is three eighths of it. 0 ... 5, default 0.8. */
  double rosin;
  /* The bow's number on this object. 0 ... 16777215, default 0. */
  uint32_t number;
} ringdown_bow_args;
RINGDOWN_API void ringdown_bow_args_init(ringdown_bow_args* args, size_t size); /* [any] */
RINGDOWN_API ringdown_result ringdown_bow(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                          const ringdown_bow_args* args, ringdown_error* error);

/* Throws a mallet at the object. Mass, head, speed and the object's own motion decide how long the blow lasts and how
 * often the mallet hits. */
typedef struct ringdown_mallet_args {
  size_t size; /* sizeof the struct, as _init sets it */
  /* The point that the mallet hits. */
  double point_m[3];
  /* The mallet's velocity; not 0. */
  double velocity_m_s[3];
  /* The mallet's mass, shaft and hand included. 1e-5 ... 100, default 0.02. */
  double mass_kg;
  /* The stiffness of the head: about 1e5 for yarn, 1e7 for rubber, 1e9 for wood, 1e10 for steel. 1 ... 1e14, default
   * 10000000. */
  double head;
  /* The mallet's speed after a blow on a rigid wall, divided by its speed before. 0.01 ... 1, default 0.9. */
  double bounce;
} ringdown_mallet_args;
RINGDOWN_API void ringdown_mallet_args_init(ringdown_mallet_args* args, size_t size); /* [any] */
RINGDOWN_API ringdown_result ringdown_mallet(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                             const ringdown_mallet_args* args, ringdown_error* error);

/* Lets another object touch this one at a point of each, so that both rattle, buzz and ring together. The frames of
 * the two are assumed to be parallel. A stiffness of 0 separates them. */
typedef struct ringdown_couple_args {
  size_t size; /* sizeof the struct, as _init sets it */
  /* The touched point of this object. */
  double point_m[3];
  /* The other object. */
  uint32_t other;
  /* The touched point of the other object, in its own frame. */
  double other_point_m[3];
  /* The direction in which the other object pushes this one; any length but 0. */
  double direction[3];
  /* The weight with which the other object rests on this one; 0: both are held in place. 0 ... 100000, default 0. */
  double weight_n;
  /* The distance between the two at rest; a negative gap presses them together. -0.01 ... 0.1, default 0. */
  double gap_m;
  /* The stiffness of the contact, by Hertz's law. 0 ... 1e14, default 100000000. */
  double stiffness;
  /* Coefficient of static friction. 0 ... 5, default 0.3. */
  double friction;
  /* The speed after an impact, divided by the speed before. 0.01 ... 1, default 0.6. */
  double bounce;
  /* The other object's mass, if it rests by its weight; 0 derives the mass from the weight. 0 ... 100000, default 0. */
  double mass_kg;
  /* The coupling's number on this object. 0 ... 16777215, default 0. */
  uint32_t number;
} ringdown_couple_args;
RINGDOWN_API void ringdown_couple_args_init(ringdown_couple_args* args, size_t size); /* [any] */
RINGDOWN_API ringdown_result ringdown_couple(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                             const ringdown_couple_args* args, ringdown_error* error);

/* Plays the click of a free object that a blow sets in motion as a whole. Strikes do not include it. Send one click
 * for all points that are struck at the same time. impulse_ns: The impulse on the object. contact_time_s: The
 * duration of the blow; a longer blow is duller. 0 ... 0.1, default 0.0002. */
RINGDOWN_API ringdown_result ringdown_click(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                            const double impulse_ns[3], double contact_time_s, ringdown_error* error);

/* Sets the object's pose, from which a listener (/listener) hears it. Send 30 to 250 poses a second for a moving
 * object; the motion between poses is smooth. A pose sent one interval ahead of its time is reached exactly then, any
 * other pose one interval after it arrives. position_m: The position of the object's origin in the scene.
 * rotation_wxyz: How it is turned, as a unit quaternion. */
RINGDOWN_API ringdown_result ringdown_pose(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                           const double position_m[3], const double rotation_wxyz[4],
                                           ringdown_error* error);

/* Sets the listener's pose. Objects with a pose are then heard from their places, with direction, distance and
 * Doppler shift. Objects without a pose sound as before. position_m: The position of the listener's head in the
 * scene. Without a rotation it faces along x, with the left ear towards y. rotation_wxyz: How it is turned, as a unit
 * quaternion. */
RINGDOWN_API ringdown_result ringdown_listener(ringdown_mixer* mixer, int64_t frame, const double position_m[3],
                                               const double rotation_wxyz[4], ringdown_error* error);

/* Removes the listener. */
RINGDOWN_API ringdown_result ringdown_listener_off(ringdown_mixer* mixer, int64_t frame, ringdown_error* error);

/* Sets the air between objects and listener, which absorbs high frequencies more strongly over longer distances.
 * temperature_c: The temperature of the air. -50 ... 60. humidity_percent: The relative humidity of the air. 0 ...
 * 100, default 50. */
RINGDOWN_API ringdown_result ringdown_listener_air(ringdown_mixer* mixer, int64_t frame, double temperature_c,
                                                   double humidity_percent, ringdown_error* error);

/* </verbs> */

/* ---- Sound [audio] ----------------------------------------------------------------------------------------------- */

/* Writes the next `frames` frames of left and right, any number, which need not be the same each time. */
RINGDOWN_API void ringdown_render(ringdown_mixer* mixer, float* left, float* right, size_t frames);

/* Renders the next frames with ambisonic channels, inputs and pickups. A NULL pointer is a channel that is not needed, which
 * costs nothing, or an input that is silent. */
typedef struct ringdown_block {
  size_t size;                              /* sizeof the struct; smaller blocks render nothing */
  size_t frames;
  float* mix[2];                            /* left, right */
  float* ambisonics[16];                    /* AmbiX: ACN order, SN3D; without limiter, not delayed */
  const float* inputs[RINGDOWN_MAX_INPUTS]; /* ringdown_excite() */
  float* pickups[RINGDOWN_MAX_PICKUPS];     /* ringdown_pickup(): number 1 is the first */
} ringdown_block;
RINGDOWN_API void ringdown_render_all(ringdown_mixer* mixer, const ringdown_block* block);

/* ---- State [any] ------------------------------------------------------------------------------------------------- */

RINGDOWN_API int64_t ringdown_now(const ringdown_mixer* mixer);      /* frames rendered so far */
RINGDOWN_API size_t ringdown_latency(const ringdown_mixer* mixer);   /* frames by which the limiter delays left and right */

typedef struct ringdown_status {
  size_t size;
  uint64_t strikes;        /* played so far */
  uint64_t late;           /* events that arrived after their frame */
  uint64_t dropped;        /* events refused because too many waited */
  uint64_t refused;        /* events whose object had been removed when their frame came, and contacts without room */
  uint64_t not_finite;     /* voices silenced because a state was not a sensible number */
  uint32_t objects;        /* existing objects */
  uint32_t sounding;       /* voices that rang in the last block */
  uint32_t ringing_modes;  /* modes that rang in the last block */
  float peak;              /* largest |sample| of the last block */
} ringdown_status;
/* Fills as many members as status->size has room for. Set status->size before. */
RINGDOWN_API ringdown_result ringdown_get_status(const ringdown_mixer* mixer, ringdown_status* status);

#ifdef __cplusplus
}
#endif
#endif
