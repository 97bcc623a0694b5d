// Tells DPF what to build; the names of the file and of the macros are DPF's.
#pragma once

#define DISTRHO_PLUGIN_BRAND "Ringdown"
#define DISTRHO_PLUGIN_NAME "Ringdown"
#define DISTRHO_PLUGIN_URI "urn:ringdown:instrument"
#define DISTRHO_PLUGIN_CLAP_ID "ringdown.instrument"
#define DISTRHO_PLUGIN_CLAP_FEATURES "instrument", "synthesizer", "stereo"
#define DISTRHO_PLUGIN_LV2_CATEGORY "lv2:InstrumentPlugin"
#define DISTRHO_PLUGIN_VST3_CATEGORIES "Instrument|Synth|Stereo"

// DPF takes this back where it is compiled without OpenGL.
#define DISTRHO_PLUGIN_HAS_UI 1
#define DISTRHO_UI_USER_RESIZABLE 1
#define DISTRHO_UI_DEFAULT_WIDTH 1100
#define DISTRHO_UI_DEFAULT_HEIGHT 680
// Nothing uses direct access. But without it DPF makes a VST3's controller an object of its own and shifts the numbers
// of all parameters, which people's sessions hold.
#ifdef DISTRHO_PLUGIN_TARGET_VST3
#define DISTRHO_PLUGIN_WANT_DIRECT_ACCESS 1
#endif
#define DISTRHO_PLUGIN_IS_RT_SAFE 1
#define DISTRHO_PLUGIN_IS_SYNTH 1
#define DISTRHO_PLUGIN_NUM_INPUTS 0
#define DISTRHO_PLUGIN_NUM_OUTPUTS 2
#define DISTRHO_PLUGIN_WANT_MIDI_INPUT 1
#define DISTRHO_PLUGIN_WANT_STATE 1
#define DISTRHO_PLUGIN_WANT_FULL_STATE 1
