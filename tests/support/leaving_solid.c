/* SPDX-License-Identifier: MIT */
/* leaving_solid STAGE HOW: a solid in C that leaves at a stage (connected, agreed, states, running,
 * last, goodbye, refused) by MPI_Finalize only (finalize), by exit, with bplbm_close (farewell), or
 * after bplbm_fail (fail). leaving_solid misuse CALL: one wrong call once both agree. leaving_solid
 * slow SECONDS: one whose rank r looks for the fluid only r times as long after MPI_Init, and
 * stays. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bplbm_solid.h"

static bplbm_solid* wire;
static const char *stage, *how;

/* Leaves where this is the stage at which it is to leave. */
static void leave_at(const char* here) {
  if (strcmp(stage, here)) return;
  if (!strcmp(how, "exit")) exit(0);
  if (!strcmp(how, "finalize")) {
    PMPI_Finalize();
    exit(0);
  }
  if (!strcmp(how, "fail")) bplbm_fail(wire, 42, "has had enough");
  exit(bplbm_close(wire));
}

/* Makes one call that the library must refuse. */
static void misuse(const bplbm_setup* setup, const bplbm_state* state, const bplbm_shape* shape) {
  bplbm_solid* second = NULL;
  bplbm_load load;
  bplbm_shape clump;
  const double places[6] = {0.0}, radii[2] = {1e-3, -1.0};
  double number = 0.0;
  if (!strcmp(how, "scene")) bplbm_scene(wire, NULL);
  if (!strcmp(how, "number")) bplbm_number(wire, NULL, &number);
  if (!strcmp(how, "place")) bplbm_number(wire, "depth", NULL);
  if (!strcmp(how, "agree")) bplbm_agree(wire, setup);
  if (!strcmp(how, "receive")) bplbm_receive(wire, &load, NULL);
  if (!strcmp(how, "send")) {
    bplbm_send(wire, 1, state, shape);
    bplbm_send(wire, 1, state, shape);
  }
  if (!strcmp(how, "goodbye")) {
    bplbm_goodbye(wire, "has seen enough");
    bplbm_exchange(wire, 1, state, shape, &load, NULL);
  }
  if (!strcmp(how, "checkpoint")) bplbm_checkpoint(wire, "state", 5);
  if (!strcmp(how, "clump")) bplbm_clump(wire, 2, places, radii, 1000.0, &clump, NULL, NULL);
  if (!strcmp(how, "no_clump")) bplbm_clump(wire, 0, places, radii, 1000.0, &clump, NULL, NULL);
  if (!strcmp(how, "code")) bplbm_fail(wire, 300, "has had enough");
  if (!strcmp(how, "connect")) {
    bplbm_connect(&second, "second", "test");
    bplbm_fail(wire, BPLBM_BAD_INPUT, bplbm_error(second));
  }
}

int main(int argc, char** argv) {
  bplbm_setup setup;
  bplbm_state state = {.id = 4, .x = {0.01, 0.04, 0.0}};
  bplbm_shape shape = {.id = 4, .radius = 0.00125, .type = 1, .carrier = BPLBM_ITSELF};
  bplbm_load load;
  uint32_t asked = 0;
  int rank = 0;
  stage = argc > 1 ? argv[1] : "";
  how = argc > 2 ? argv[2] : "";
  if (!strcmp(stage, "slow")) {
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    sleep((unsigned)(rank * atoi(how)));
  }
  if (bplbm_connect(&wire, "leaving_solid", "test") != BPLBM_OK) return bplbm_close(wire);
  MPI_Comm_rank(bplbm_communicator(wire), &rank);
  leave_at("connected");
  shape.mass = 1250.0 * acos(-1.0) * shape.radius * shape.radius;
  shape.inertia = 0.5 * shape.mass * shape.radius * shape.radius;
  bplbm_scene(wire, &setup);
  setup.particles = 1;
  setup.radius[1] = setup.density[1] = 0.0;
  if (!strcmp(stage, "refused")) setup.gravity[1] *= 2.0;
  bplbm_agree(wire, &setup);
  leave_at("refused");
  leave_at("agreed");
  if (!strcmp(stage, "misuse")) {
    misuse(&setup, &state, &shape);
    return bplbm_close(wire);
  }
  for (int k = 0;; ++k) {
    if (k == 3) leave_at("running");
    if (k == 3 && !strcmp(stage, "goodbye")) {
      bplbm_goodbye(wire, "has seen enough");
      leave_at("goodbye");
    }
    bplbm_send(wire, rank == 0 ? 1 : 0, &state, &shape);
    if (k == 0) leave_at("states");
    if (bplbm_receive(wire, &load, &asked) != BPLBM_OK) return bplbm_close(wire);
    if (asked & BPLBM_LAST) break;
  }
  leave_at("last");
  return bplbm_close(wire);
}
