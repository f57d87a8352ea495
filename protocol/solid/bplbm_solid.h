/* SPDX-License-Identifier: MIT */
/* The solid's side of a coupled job for a program in C, or in any language that can call C.
 *
 *   bplbm_solid* solid;
 *   bplbm_setup setup;
 *   uint32_t asked = 0;
 *   bplbm_connect(&solid, "my_engine", "1.0");         finds the fluid
 *   bplbm_scene(solid, &setup);                        what the fluid's scene says; bplbm_number
 *   …                                                  setup.step, setup.gravity … as you compute
 *   bplbm_agree(solid, &setup);                        both sides compare all of it
 *   while (bplbm_exchange(solid, n, states, shapes, loads, &asked) == BPLBM_OK &&
 *          !(asked & BPLBM_LAST)) {
 *     …                                                setup.steps steps, with the loads in each
 *     if (asked & BPLBM_CHECKPOINT) bplbm_checkpoint(solid, bytes, size);
 *   }
 *   return bplbm_close(solid);                         says farewell, ends MPI; the exit code
 *
 * All quantities are in SI units. Vectors have three components, in two dimensions as well.
 *
 * Every rank of the program calls the same functions in the same order, with its own particles. A
 * particle belongs to one rank at a time, and may belong to another one in the next interval.
 *
 * Every function that can fail returns BPLBM_OK or an exit code, never ends the process, and
 * leaves a sentence for bplbm_error. After a failure all later calls return the same code, so it is
 * enough to look at the last one; bplbm_close tells the fluid why. The library keeps no state
 * outside of the handle but what belongs to the process: MPI, the handlers of SIGTERM and SIGINT
 * (where there were none) and the watch, which ends a process whose wait for its own ranks exceeds
 * the scene's time-out (BPLBM_WATCH=0 in the environment leaves it out), and a handler of exit that
 * complains of handles that bplbm_close has not had. */
#ifndef BPLBM_SOLID_H
#define BPLBM_SOLID_H

#include <mpi.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Exit codes of every program of a job. */
enum { BPLBM_OK = 0, BPLBM_FAULT = 1, BPLBM_BAD_INPUT = 2, BPLBM_NUMERICS = 3 };

/* What the fluid asks for with its loads. */
enum {
  BPLBM_LAST = 1,       /* no loads came: these states were the last; call bplbm_close */
  BPLBM_STOP = 2,       /* the next states will be the last */
  BPLBM_CHECKPOINT = 4, /* before the next states, call bplbm_checkpoint */
  BPLBM_WANT_BONDS = 8, /* list the bonds in bplbm_report before the next states */
  BPLBM_SETTLE = 16     /* before the next states, do to your particles what a restart would */
};

/* Who adds the force of buoyancy to a particle. */
enum { BPLBM_BUOYANCY_BY_FLUID = 0, BPLBM_BUOYANCY_BY_SOLID = 1, BPLBM_BUOYANCY_NONE = 2 };

/* Serial: one side after the other. Overlapped: both at once, see bplbm_send. */
enum { BPLBM_SERIAL = 0, BPLBM_OVERLAPPED = 1 };

/* What both sides must agree on. */
typedef struct {
  int32_t dimension;              /* 2 or 3 */
  int32_t periodic[3];            /* 0 or 1 an axis; z does not count in two dimensions */
  double box_low[3], box_high[3]; /* [m]; in two dimensions z spans the depth */
  double depth;                 /* [m], two dimensions only: forces and masses are of this depth */
  double gravity[3];            /* [m/s^2] */
  int32_t buoyancy, schedule;   /* see above */
  double step;                  /* the solid's own time step [s] */
  int32_t steps;                /* of them a coupling interval */
  int32_t checkpoints;          /* 1: the fluid needs them; the solid can write them */
  int64_t first_interval;       /* 0, or that of the checkpoint from which the run goes on */
  int64_t particles;            /* of all ranks; -1: not said */
  double radius[2], density[2]; /* smallest and largest [m], [kg/m^3]; 0, 0: not said */
  int32_t sides[6];             /* x low, x high, y low … z high: 0 no wall, 1 a wall, 2 a wall
                                   with openings; -1: not said */
} bplbm_setup;

/* Motion of a particle at the beginning of a coupling interval. Velocities are those of that time,
 * not of half a step before, as a leapfrog scheme keeps them. */
typedef struct {
  int64_t id;                  /* unique among all ranks; the fluid knows a particle by it alone */
  double x[3], v[3], omega[3]; /* [m], [m/s], [rad/s] */
} bplbm_state;

/* What rarely changes. Given with every state; the library sends it only where it has changed.
 *
 * A clump, a rigid body of spheres that may overlap, is a carrier (mass, inertia, volume of the
 * union, radius of the ball about its centre that holds all spheres) and spheres that name it and
 * have mass, inertia and volume 0. One rank gives them all; the load is the carrier's. */
typedef struct {
  int64_t id;
  double radius;   /* [m] */
  double mass;     /* [kg], in two dimensions of the agreed depth */
  double inertia;  /* about the centre [kg m^2] */
  int64_t type;    /* any number; 1 where there is one kind */
  int64_t epoch;   /* another one where the id has passed to another particle; else 0 */
  int64_t carrier; /* BPLBM_ITSELF, or the clump that it is a sphere of */
  double volume;   /* 0: that of its ball, or disc times depth [m^3] */
} bplbm_shape;
#define BPLBM_ITSELF (-1)

/* Mean load of the fluid on a particle over an interval, about its centre, for the agreed depth. It
 * holds everything that the fluid does: add it, as it is, to the forces of each step. */
typedef struct {
  int64_t id;
  double force[3], torque[3]; /* [N], [N m] */
} bplbm_load;

/* A bond between two particles, for pictures. */
typedef struct {
  int64_t first, second; /* ids */
  int64_t state;         /* 0 intact, 1 broken by tension, 2 by shear */
} bplbm_bond;

typedef struct bplbm_solid bplbm_solid;

/* Finds the fluid among the programs of this mpirun, and hears what its scene says. Initialises MPI
 * where that has not been done. *solid is made also after a failure, for bplbm_error and
 * bplbm_close. `program` and `version` appear in messages. One connection a process. */
int bplbm_connect(bplbm_solid** solid, const char* program, const char* version);

/* The sentence that belongs to the first failure; "" where there was none. Valid until
 * bplbm_close. */
const char* bplbm_error(const bplbm_solid* solid);

/* What the fluid's scene says, with the step and the number of steps that it has for the solid. Set
 * what you compute with yourself, where you know it from elsewhere: an agreement of the scene with
 * itself finds no mistake. */
int bplbm_scene(bplbm_solid* solid, bplbm_setup* setup);

/* A variable that the scene offers, e.g. "particle1_x", as text; null where there is none. (`lbm
 * check --liggghts-vars scene.toml` shows all.) Valid until bplbm_close. */
const char* bplbm_variable(const bplbm_solid* solid, const char* name);

/* The same as a number. A variable that is missing is a failure. */
int bplbm_number(bplbm_solid* solid, const char* name, double* value);

/* What a clump's carrier is: radius, mass, inertia and volume of the union of its spheres (discs in
 * two dimensions), which may overlap. The id is 0: set it.
 * n        spheres
 * places   [n][3], centres about any point [m]; z does not count in two dimensions
 * radii    [n] [m]
 * density  [kg/m^3]
 * centre   null, or set to the centre of mass, about the same point: subtract it from the places
 * inertia  null, or set to the tensor about the centre: xx, yy, zz, yz, zx, xy [kg m^2] */
int bplbm_clump(bplbm_solid* solid, int64_t n, const double* places, const double* radii,
                double density, bplbm_shape* carrier, double centre[3], double inertia[6]);

/* Tells the fluid what this program computes with. Both compare everything, and fail with every
 * disagreement in the sentence. */
int bplbm_agree(bplbm_solid* solid, const bplbm_setup* setup);

/* Sends the states of the next interval, waits for its loads.
 * n        particles of this rank; may change from call to call
 * states, shapes   n each, in the same order
 * loads    n, set in the order of the states
 * asked    set to what the fluid asks for */
int bplbm_exchange(bplbm_solid* solid, int64_t n, const bplbm_state* states,
                   const bplbm_shape* shapes, bplbm_load* loads, uint32_t* asked);

/* The two halves of an exchange. In the overlapped schedule the steps of interval k, with the loads
 * of k-1, lie between them; only the first interval is serial. bplbm_receive gives the loads in the
 * order of the states sent last. */
int bplbm_send(bplbm_solid* solid, int64_t n, const bplbm_state* states, const bplbm_shape* shapes);
int bplbm_receive(bplbm_solid* solid, bplbm_load* loads, uint32_t* asked);

/* Writes this program's part of a checkpoint, where the last loads asked for it: the pieces of all
 * ranks one after the other, in the order of ranks, whole or not at all. It is of the beginning of
 * the next interval: what that brings has come. On a restart setup.first_interval is above 0, and
 * the variable "restart_file" names the file. */
int bplbm_checkpoint(bplbm_solid* solid, const void* bytes, int64_t size);

/* What there is to say of this rank, with the next states: particles that have left through a side
 * since the beginning; intact bonds, those broken by tension and by shear, left with a particle and
 * lost with one (null: there never were any); `n` bonds for the picture, where they were asked
 * for. */
int bplbm_report(bplbm_solid* solid, int64_t left, const int64_t counts[5], int64_t n,
                 const bplbm_bond* bonds);

/* Leaves in good order in place of the next states: the way to end before the fluid does. Call
 * bplbm_close next. (Without a goodbye the fluid ends with exit code 1, naming this program.) */
int bplbm_goodbye(bplbm_solid* solid, const char* reason);

/* Says that this program cannot go on, and why; the fluid prints it. Returns `code`, from 1 to
 * 255; any other counts as BPLBM_FAULT. Call bplbm_close next. */
int bplbm_fail(bplbm_solid* solid, int code, const char* reason);

/* The ranks of this program. MPI_COMM_WORLD contains those of the fluid as well: never use it for a
 * collective call. MPI_COMM_NULL where bplbm_connect failed. The second is for Fortran. */
MPI_Comm bplbm_communicator(const bplbm_solid* solid);
MPI_Fint bplbm_communicator_f(const bplbm_solid* solid);

/* Ends the program's part in the job, and frees the handle: prints the failure if there was one and
 * tells it to the fluid; else says farewell and waits until the fluid has finished. Then, unless it
 * failed of a fault, MPI has been finalised. A fluid that hangs ends the job here.
 * Returns the exit code: return it from main, without another call of MPI. */
int bplbm_close(bplbm_solid* solid);

#ifdef __cplusplus
}
#endif

#endif
