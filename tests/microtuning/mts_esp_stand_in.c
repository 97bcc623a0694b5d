// Has the functions of MTS-ESP's library that clients look for, and others by which a test plays the master.
#include <stdbool.h>

static double table_hz[128];
static bool unmapped[128];
static bool has_master;
static int clients;

void MTS_RegisterClient(void) { ++clients; }
void MTS_DeregisterClient(void) { --clients; }
bool MTS_HasMaster(void) { return has_master; }
const double* MTS_GetTuningTable(void) { return table_hz; }
bool MTS_ShouldFilterNote(char key, char channel) { return channel == (char)-1 && unmapped[(int)key]; }

void stand_in_set_master(bool on) { has_master = on; }
void stand_in_tune(int key, double frequency_hz, bool is_unmapped) {
  table_hz[key] = frequency_hz;
  unmapped[key] = is_unmapped;
}
int stand_in_clients(void) { return clients; }
