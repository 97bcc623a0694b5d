/* libringdown-scene: rigid bodies that fall, collide, slide and roll, and sound by a mixer of libringdown.
 *
 *   ringdown_scene* scene;
 *   ringdown_scene_load(mixer, "dominoes.toml", 0, &scene, NULL);   // [worker] objects and bodies; scene time 0 is frame 0
 *   while (playing) {
 *     ringdown_scene_advance(scene, ringdown_now(mixer) + 1024);    // [worker] all events before that frame
 *     ringdown_render(mixer, left, right, 1024);                    // [audio]
 *   }
 *   ringdown_scene_destroy(scene);                                  // [worker] before the mixer
 *
 * Units, errors and versions are as in ringdown.h. The scene belongs to the mixer's worker thread, because bodies that
 * come to rest on an object damp it, which retunes it.
 *
 * It is a library of its own because of ODE, which computes the motion: ODE has global state, and ends the process on
 * input that it does not expect. So everything is checked before ODE sees it, and one lock for the whole process lets
 * one call of this library after the other use ODE: scenes of several mixers wait for each other. The library takes
 * mixers of the libringdown of its own version only, and refuses others. ODE is used under its BSD licence. */
#ifndef RINGDOWN_SCENE_H
#define RINGDOWN_SCENE_H

#include <ringdown.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ringdown_scene ringdown_scene;

/* Loads a scene file (docs/use/scenes.md) or a glTF scene (docs/use/gltf-scenes.md) and the objects that it names into
 * the mixer, and starts it at `frame`. A mixer has at most one scene: RINGDOWN_REFUSED until the one before it has been
 * destroyed. [worker] */
RINGDOWN_API ringdown_result ringdown_scene_load(ringdown_mixer* mixer, const char* path, int64_t frame,
                                                 ringdown_scene** scene, ringdown_error* error);
/* Ends the scene; sounds ring on, and the scene's objects stay. NULL is allowed. [worker, while no other function of
 * this scene runs] */
RINGDOWN_API void ringdown_scene_destroy(ringdown_scene* scene);

/* Steps the bodies until all events before `frame` have been sent to the mixer. Call it with a frame that lies a little
 * ahead, 10 to 50 ms. At most 4096 events may come between two blocks, so steps of a second are too long: events beyond
 * are lost. [worker] */
RINGDOWN_API void ringdown_scene_advance(ringdown_scene* scene, int64_t frame);

/* Pauses (1) or continues (0) the bodies; sounds ring on. [worker] */
RINGDOWN_API ringdown_result ringdown_scene_pause(ringdown_scene* scene, int paused, ringdown_error* error);
/* An impulse [N s] in the scene's axes at the body's centre of mass. RINGDOWN_REFUSED for a body that is fixed or has not
 * yet entered the scene. [worker] */
RINGDOWN_API ringdown_result ringdown_scene_push(ringdown_scene* scene, uint32_t body, const double impulse_ns[3],
                                                 ringdown_error* error);
/* Removes all bodies; no further body enters the scene. [worker] */
RINGDOWN_API ringdown_result ringdown_scene_clear(ringdown_scene* scene, ringdown_error* error);

RINGDOWN_API double ringdown_scene_duration_s(const ringdown_scene* scene); /* as its file says; 0: for ever. [any] */
RINGDOWN_API size_t ringdown_scene_bodies(const ringdown_scene* scene);     /* [any] */

/* The number of an object or of a body by the name that the scene file gives it. Names are unique among objects, and
 * among bodies; a body that has not yet entered the scene is found as well. A glTF scene names both after their nodes.
 * RINGDOWN_BAD_INPUT, and the number stays as it was, if there is none. [worker] */
RINGDOWN_API ringdown_result ringdown_scene_find_object(ringdown_scene* scene, const char* name, uint32_t* object,
                                                        ringdown_error* error);
RINGDOWN_API ringdown_result ringdown_scene_find_body(ringdown_scene* scene, const char* name, uint32_t* body,
                                                      ringdown_error* error);

/* Where the bodies are now: fills up to `room` places and returns how many bodies there are. [any but audio] */
typedef struct ringdown_body {
  uint32_t number;
  double position_m[3];
  double rotation_wxyz[4]; /* unit quaternion, real part first, as ringdown_pose() takes it */
} ringdown_body;
RINGDOWN_API size_t ringdown_scene_poses(const ringdown_scene* scene, ringdown_body* bodies, size_t room);

#ifdef __cplusplus
}
#endif
#endif
